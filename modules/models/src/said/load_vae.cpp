#include "mien/models/model_file.h"
#include "mien/models/runtime_parameters.h"
#include "mien/models/said/vae.h"

namespace mien::said {

Result<Vae<Tensor>> load_vae(const std::filesystem::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  const std::string name = "loading codec '" + path.string() + "'";
  const auto description = read_model_file(file.metadata());
  if (!description) return within(description.error(), name);
  if (description->architecture != Architecture::said_vae)
    return Error{Errc::incompatible, name,
                 "is a '" + std::string(architecture_name(description->architecture)) + "'",
                 "Expected is SAiD's motion codec: mien import vae.pth -o said_vae.safetensors"};
  const auto sizes = vae_sizes_of(file);
  if (!sizes) return within(sizes.error(), name);
  if (sizes->channels != description->output.channels)
    return Error{Errc::incompatible, name,
                 "its description has " + std::to_string(description->output.channels) +
                     " channels, its weights " + std::to_string(sizes->channels),
                 ""};
  Vae<Tensor> vae(*sizes);
  LoadRuntime load(file);
  vae.visit(load);
  if (const Status loaded = load.finish(); !loaded) return within(loaded.error(), name);
  return vae;
}

}  // namespace mien::said

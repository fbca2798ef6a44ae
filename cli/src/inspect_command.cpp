// mien inspect: what a file is and holds.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "inspect.h"
#include "mien/audio/load_audio.h"
#include "options.h"
#include "printing.h"

namespace mien {

Result<Facts> inspect_audio(const std::filesystem::path& path) {
  MIEN_TRY(AudioReader reader, AudioReader::open(path));
  std::array<float, 16384> block;
  double energy = 0, peak = 0;
  std::int64_t count = 0;
  for (;;) {
    MIEN_TRY(const std::size_t n, reader.read(block));
    for (std::size_t i = 0; i < n; ++i) {
      energy += static_cast<double>(block[i]) * block[i];
      peak = std::max(peak, std::abs(static_cast<double>(block[i])));
    }
    count += static_cast<std::int64_t>(n);
    if (n < block.size()) break;
  }
  const auto& info = reader.info();
  Facts facts;
  facts.add("kind", "audio");
  facts.add("file", path.string());
  facts.add("format", info.format);
  facts.add("sample_rate_hz", static_cast<std::int64_t>(info.sample_rate_hz));
  facts.add("channels", static_cast<std::int64_t>(info.num_channels));
  facts.add("declared_seconds", info.seconds.value_or(std::nan("")), 3, "s");
  facts.add("seconds", static_cast<double>(count) / kModelSampleRateHz, 3, "s");
  facts.add("peak", peak, 4);
  facts.add("rms_db", energy > 0 ? 10 * std::log10(energy / static_cast<double>(count)) : std::nan(""), 1,
            "dB");
  Result<Facts> result = std::move(facts);
  result.warnings = reader.warnings();
  return result;
}

namespace {

struct InspectArguments {
  std::string file;
};

Result<Facts> inspect(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".safetensors") {
    MIEN_TRY(const auto file, SafetensorsFile::open(path));
    if (file.find("neutral") != nullptr && file.find("triangles") != nullptr) return inspect_character(path);
    return inspect_model(path, file);
  }
  if (extension == ".glb" || extension == ".gltf" || extension == ".vrm") return inspect_character(path);
  if (extension == ".csv" || extension == ".json" || extension == ".npy") return inspect_motion(path);
  return inspect_audio(path);
}

Status run_inspect(const InspectArguments& a, bool json, ConsoleProgress& progress) {
  const auto facts = inspect(a.file);
  if (!facts) return facts.error();
  for (const auto& warning : facts.warnings) progress.warn(warning);
  return print(json ? facts->to_json() : facts->to_text());
}

}  // namespace

void add_inspect_command(CLI::App& program, Chosen& chosen) {
  auto* command =
      program.add_subcommand("inspect", "Tell what a file of sound, motion, character or model holds");
  auto a = std::make_shared<InspectArguments>();
  command
      ->add_option(
          "FILE", a->file,
          "Sound; motion (.csv .json .npy); character (.glb .gltf .vrm .safetensors); model (.safetensors)")
      ->required();
  command->add_flag("--quiet", chosen.quiet, "Print no warnings");
  command->add_flag("--json", chosen.json,
                    "Print one JSON object on standard output, warnings as JSON lines");
  add_footer(*command,
             "  mien inspect hello.wav\n"
             "  mien inspect model.safetensors --json\n");
  command->callback([a, &chosen] {
    chosen.work = [a, json = chosen.json](ConsoleProgress& progress) {
      return run_inspect(*a, json, progress);
    };
  });
}

}  // namespace mien

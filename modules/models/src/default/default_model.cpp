#include "mien/models/default/default_model.h"

namespace mien {

Result<DefaultModel> DefaultModel::load(const std::filesystem::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  auto model = from_file(file);
  if (!model) return within(model.error(), "loading model '" + path.string() + "'");
  return model;
}

Result<DefaultModel> DefaultModel::from_file(const SafetensorsFile& file) {
  MIEN_TRY(auto metadata, default_model::from_metadata(file.metadata()));
  auto network = std::make_shared<default_model::Network<Tensor>>(metadata.sizes);
  LoadRuntime load(file);
  network->visit(load);
  MIEN_TRY([[maybe_unused]] const auto loaded, load.finish());
  for (const float sd : network->statistics.face_sd.values())
    if (!(sd > 0)) return Error{Errc::incompatible, "weights", "a standard deviation is not positive", ""};
  return DefaultModel(std::move(metadata), std::move(network));
}

std::int64_t DefaultModel::num_parameters() const {
  default_model::Network<Tensor> sizes_only(metadata_.sizes);
  CountParameters count;
  sizes_only.visit(count);
  return count.total;
}

}  // namespace mien

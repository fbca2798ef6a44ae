#pragma once
#include <filesystem>
#include <memory>

#include "mien/base/result.h"
#include "mien/models/default/model_metadata.h"
#include "mien/models/runtime_parameters.h"

namespace mien {

/// The default model, loaded and packed. Immutable; may be shared by threads.
class DefaultModel {
 public:
  /// Errors: unreadable file (input); not a default model, wrong or broken weights (incompatible).
  static Result<DefaultModel> load(const std::filesystem::path& path);
  static Result<DefaultModel> from_file(const SafetensorsFile& file);

  [[nodiscard]] const default_model::ModelMetadata& metadata() const { return metadata_; }
  [[nodiscard]] const default_model::Network<Tensor>& network() const { return *network_; }
  [[nodiscard]] std::int64_t num_parameters() const;

 private:
  DefaultModel(default_model::ModelMetadata metadata,
               std::shared_ptr<const default_model::Network<Tensor>> network)
      : metadata_(std::move(metadata)), network_(std::move(network)) {}
  default_model::ModelMetadata metadata_;
  std::shared_ptr<const default_model::Network<Tensor>> network_;  // shared: copies of the model are cheap
};

}  // namespace mien

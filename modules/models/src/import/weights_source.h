#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/pickle.h"
#include "mien/io/safetensors.h"
#include "mien/nn/parameters.h"

namespace mien {

/// Named tensors from whatever file holds them. One thread at a time.
class WeightsSource {
 public:
  virtual ~WeightsSource() = default;
  [[nodiscard]] virtual const std::vector<StoredTensor>& tensors() const = 0;
  /// As float32. Errors: damaged (input), not a floating-point tensor (incompatible). @pre one of tensors()
  [[nodiscard]] virtual Result<std::vector<float>> read(std::string_view name) const = 0;

  /// The options that the trainer saved with the weights ("hyper_parameters" of Lightning), or nothing.
  [[nodiscard]] virtual std::optional<PickleValue> training_options() const { return std::nullopt; }

  [[nodiscard]] std::map<std::string, StoredTensor> by_name() const;
};

/// A .safetensors file, a file of torch.save, or a folder of the Hugging Face layout: model.safetensors, else
/// model.safetensors.index.json and its parts, else pytorch_model.bin. The kind of a file is told from its
/// content. Errors as SafetensorsFile::open() and TorchCheckpoint::open(), and (Errc::input) a folder without
/// any of these.
Result<std::unique_ptr<WeightsSource>> open_weights(const std::filesystem::path& path);

}  // namespace mien

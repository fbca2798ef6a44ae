#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fixture.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien::parity {

/// Stages of one pass, by the names that the recorded files use: "conv.0", "projection", "layer.2" ...
template <class T>
struct RecordStages : EvaluationHooks<T> {
  void stage(const char* name, std::int64_t index, const T& x) const {
    const bool counted = std::string_view(name) == "conv" || std::string_view(name) == "layer";
    stages->emplace_back(counted ? std::string(name) + "." + std::to_string(index) : name, x);
  }
  std::vector<std::pair<std::string, T>>* stages = nullptr;
};

/// A folder of encoders/ with a config.json and weights, and the recorded passes in it.
struct EncoderModel {
  std::string folder;  ///< below fixture_root()
  EncoderConfig config;
  std::string prefix;                       ///< of the tensor names in model.safetensors
  std::vector<std::string> files;           ///< recorded passes
  std::vector<std::string> gradient_files;  ///< <pass>_gradients: what a loss on that pass gives
};
/// All of them. Throws when a configuration is refused.
std::vector<EncoderModel> encoder_models();

/// What a recorded pass was given.
struct EncoderCase {
  EncoderCase(const EncoderModel& model, const std::string& file);

  Fixture recorded;
  Tensor waveform;  ///< [S, 1] as the network reads it
  /// Points into this object. The runtime reads one clip, so batch entries are single.
  [[nodiscard]] EncoderCall call() const;

 private:
  std::int64_t num_frames_ = 0;
  std::vector<std::int64_t> valid_;
  std::vector<std::uint8_t> masked_;
};

/// The value `name` has under the recipe of the full-size case: no weights are stored for it.
std::vector<float> recipe_values(const std::string& name, const Shape& shape, std::uint64_t salt);

/// Fills a runtime network, or one over PlainWeights, by the recipe.
class FillByRecipe : public ParameterVisitor<FillByRecipe> {
 public:
  explicit FillByRecipe(std::uint64_t salt = 0) : salt_(salt) {}
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init) {
    slot = PackedMatrix(values(name, {out, in}), out, in);
  }
  void matrix(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in, Init init) {
    tensor(name, slot, {out, in}, init);
  }
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    slot = PackedMatrix(tap_major(Tensor({out, in, kernel}, values(name, {out, in, kernel}))));
  }
  void convolution(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init init) {
    tensor(name, slot, {out, in, kernel}, init);
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init) {
    slot = Tensor(shape, values(name, shape));
  }
  std::int64_t num_tensors = 0, num_values = 0;

 private:
  std::vector<float> values(std::string_view name, const Shape& shape) {
    ++num_tensors;
    auto v = recipe_values(full_name(name), shape, salt_);
    num_values += static_cast<std::int64_t>(v.size());
    return v;
  }
  std::uint64_t salt_;
};

}  // namespace mien::parity

#pragma once
#include <torch/torch.h>

#include <map>
#include <string>
#include <vector>

#include "mien/base/random.h"
#include "mien/base/result.h"
#include "mien/io/safetensors.h"
#include "mien/nn/parameters.h"

namespace mien::train {

/// Creates every parameter of a network with its initial values, the same for a seed on every machine.
class Initialise : public ParameterVisitor<Initialise> {
 public:
  explicit Initialise(std::uint64_t seed) : seed_(seed) {}
  void matrix(std::string_view name, torch::Tensor& slot, std::int64_t out, std::int64_t in, Init init);
  void convolution(std::string_view name, torch::Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init init);
  void tensor(std::string_view name, torch::Tensor& slot, const Shape& shape, Init init);
  void buffer(std::string_view name, torch::Tensor& slot, const Shape& shape);

 private:
  std::uint64_t seed_;
};

/// Lists the parameters of a network under their full names. Assigning to the slots replaces them in the
/// network.
class Collect : public ParameterVisitor<Collect> {
 public:
  struct Entry {
    std::string name;
    torch::Tensor* slot;
    bool trained;
  };
  void matrix(std::string_view name, torch::Tensor& slot, std::int64_t, std::int64_t, Init) {
    entries.push_back({full_name(name), &slot, true});
  }
  void convolution(std::string_view name, torch::Tensor& slot, std::int64_t, std::int64_t, std::int64_t,
                   Init) {
    entries.push_back({full_name(name), &slot, true});
  }
  void tensor(std::string_view name, torch::Tensor& slot, const Shape&, Init) {
    entries.push_back({full_name(name), &slot, true});
  }
  void buffer(std::string_view name, torch::Tensor& slot, const Shape&) {
    entries.push_back({full_name(name), &slot, false});
  }
  std::vector<Entry> entries;
};

template <class Network>
std::vector<Collect::Entry> parameters(Network& network) {
  Collect collect;
  network.visit(collect);
  return std::move(collect.entries);
}

/// Uniform in [-bound, bound).
void fill_uniform(torch::Tensor& slot, double bound, Rng random);

/// As PyTorch begins: weights of linear maps and convolutions, and the biases behind them, uniform in
/// +-1 / sqrt(inputs). Norms, what begins at zero, and parameters of other names stay as they are.
void draw_as_pytorch(const std::vector<Collect::Entry>& entries, std::uint64_t seed);

/// Freezes the parameters whose names begin with one of `frozen` ("audio_encoder.encoder.layers.0", or all of
/// "audio_encoder"), and returns the others, which learn. Error (Errc::usage): nothing is called so, nothing
/// is left to learn.
Result<std::vector<Collect::Entry>> freeze(std::vector<Collect::Entry> all,
                                           const std::vector<std::string>& frozen);

/// Copies the values of `file` into the network. Strict: missing tensors, wrong shapes and extra tensors
/// whose names begin with `prefix` are all listed.
Status load_parameters(const std::vector<Collect::Entry>& entries, const SafetensorsFile& file,
                       std::string_view prefix = "");

/// Writes parameters as float32, or trained ones as float16 when `half`.
Status save_parameters(const std::vector<Collect::Entry>& entries, const std::filesystem::path& path,
                       bool half, const std::map<std::string, std::string>& metadata);

}  // namespace mien::train

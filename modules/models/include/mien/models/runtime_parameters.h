#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "mien/io/safetensors.h"
#include "mien/nn/parameters.h"
#include "mien/nn/runtime_operations.h"

namespace mien {

/// Fills a runtime network from a model file and packs its matrices: network.visit(visitor), then finish().
class LoadRuntime : public ParameterVisitor<LoadRuntime> {
 public:
  /// @param prefix  stands before every name in the file; tensors without it are none of this network's
  /// business
  explicit LoadRuntime(const SafetensorsFile& file, std::string prefix = {})
      : file_(file), prefix_(std::move(prefix)) {}
  void matrix(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in, Init);
  void convolution(std::string_view name, PackedMatrix& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init);
  /// A matrix of a network over PlainWeights.
  void matrix(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in, Init init) {
    tensor(name, slot, {out, in}, init);
  }
  void convolution(std::string_view name, Tensor& slot, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init init) {
    tensor(name, slot, {out, in, kernel}, init);
  }
  void optional(std::string_view name, Tensor& slot, const Shape& shape, Init init) {
    if (file_.find(prefix_ + full_name(name)) != nullptr) tensor(name, slot, shape, init);
  }
  void tensor(std::string_view name, Tensor& slot, const Shape& shape, Init);
  void buffer(std::string_view name, Tensor& slot, const Shape& shape) {
    tensor(name, slot, shape, Init::zero);
  }
  /// Tensors whose names begin so belong to somebody else: finish() does not ask for them.
  void leave_out(std::string prefix) { left_out_.push_back(std::move(prefix)); }
  /// Errors (Errc::incompatible): every missing tensor, wrong shape, unknown tensor and value that is not
  /// finite.
  Status finish() const;

 private:
  std::vector<float> read(std::string_view name, const Shape& shape);
  const SafetensorsFile& file_;
  std::string prefix_;
  std::set<std::string> used_;
  std::vector<std::string> left_out_;
  std::string problems_;
};

/// Counts the parameters of a network from its sizes alone.
class CountParameters : public ParameterVisitor<CountParameters> {
 public:
  template <class M>
  void matrix(std::string_view, M&, std::int64_t out, std::int64_t in, Init) {
    total += out * in;
  }
  template <class M>
  void convolution(std::string_view, M&, std::int64_t out, std::int64_t in, std::int64_t kernel, Init) {
    total += out * in * kernel;
  }
  template <class T>
  void tensor(std::string_view, T&, const Shape& shape, Init) {
    std::int64_t count = 1;
    for (const auto size : shape) count *= size;
    total += count;
  }
  template <class T>
  void buffer(std::string_view, T&, const Shape&) {}
  std::int64_t total = 0;
};

}  // namespace mien

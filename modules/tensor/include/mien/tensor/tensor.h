#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mien/tensor/aligned_floats.h"

namespace mien {

using Shape = std::vector<std::int64_t>;

/// "[3, 64]"
std::string shape_text(const Shape& shape);

/// Rows of floats somewhere in memory, not owned: `rows` rows of `columns` values, `stride` floats from row
/// to row.
struct View {
  const float* data = nullptr;
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  std::int64_t stride = 0;
};

/// Float32 values in row-major order, owned, at a 64-byte address. Sizes of 0 are allowed; the shape [] is
/// one value. Operations see a tensor as rows: the last axis is the width of a row, all other axes together
/// count the rows.
class Tensor {
 public:
  Tensor() = default;  ///< shape [0]
  /// Zeros. @pre no negative size
  explicit Tensor(Shape shape);
  /// @pre values.size() is the product of the shape
  Tensor(Shape shape, std::span<const float> values);
  /// Values are whatever memory held: for results that are written completely.
  static Tensor uninitialized(Shape shape);

  Tensor(const Tensor& other);
  Tensor& operator=(const Tensor& other);
  Tensor(Tensor&& other) noexcept;
  Tensor& operator=(Tensor&& other) noexcept;
  ~Tensor() = default;

  [[nodiscard]] const Shape& shape() const;
  [[nodiscard]] std::int64_t rank() const { return static_cast<std::int64_t>(shape().size()); }
  /// Size of an axis; -1 is the last. @pre -rank <= axis < rank
  [[nodiscard]] std::int64_t size(std::int64_t axis) const;
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// Length of the last axis; 1 for the shape [].
  [[nodiscard]] std::int64_t width() const { return shape_.empty() ? count_ : shape_.back(); }
  /// Product of all axes but the last, also when the width is 0.
  [[nodiscard]] std::int64_t num_rows() const;

  [[nodiscard]] float* data() { return data_.get(); }
  [[nodiscard]] const float* data() const { return data_.get(); }
  [[nodiscard]] std::span<float> values() { return {data(), static_cast<std::size_t>(count_)}; }
  [[nodiscard]] std::span<const float> values() const { return {data(), static_cast<std::size_t>(count_)}; }
  /// @pre 0 <= index < num_rows()
  [[nodiscard]] std::span<float> row(std::int64_t index);
  [[nodiscard]] std::span<const float> row(std::int64_t index) const;
  [[nodiscard]] View view() const { return {data(), num_rows(), width(), width()}; }

  /// The same values under another shape. @pre equal count
  [[nodiscard]] Tensor reshaped(Shape shape) const&;
  [[nodiscard]] Tensor reshaped(Shape shape) &&;

 private:
  Shape shape_;  ///< empty also for the tensor without values, so that making and moving one is free
  std::int64_t count_ = 0;
  AlignedFloats data_;
};

}  // namespace mien

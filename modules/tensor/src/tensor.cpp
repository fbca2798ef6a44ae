#include "mien/tensor/tensor.h"

#include <algorithm>
#include <utility>

#include "mien/base/contract.h"
#include "require.h"

namespace mien {
namespace {

std::int64_t product(const Shape& shape) {
  std::int64_t count = 1;
  bool fits = true;
  for (const auto size : shape) {
    contract(size >= 0, "Tensor: negative size in the shape");
    fits = fits && !__builtin_mul_overflow(count, size, &count);
  }
  contract(fits && count < (std::int64_t{1} << 60), "Tensor: the shape is too large to exist");
  return count;
}

}  // namespace

std::string shape_text(const Shape& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + "]";
}

Tensor Tensor::uninitialized(Shape shape) {
  Tensor t;
  t.count_ = product(shape);
  t.data_ = AlignedFloats(t.count_);
  t.shape_ = std::move(shape);
  return t;
}

Tensor::Tensor(Shape shape) : Tensor(uninitialized(std::move(shape))) { std::fill_n(data(), count_, 0.0f); }

Tensor::Tensor(Shape shape, std::span<const float> values) : Tensor(uninitialized(std::move(shape))) {
  require(static_cast<std::int64_t>(values.size()) == count_,
          [&] { return "Tensor: values do not fill the shape " + shape_text(shape_); });
  std::ranges::copy(values, data());
}

Tensor::Tensor(const Tensor& other) : Tensor(other.shape(), other.values()) {}

Tensor& Tensor::operator=(const Tensor& other) {
  if (this != &other) *this = Tensor(other);
  return *this;
}

Tensor::Tensor(Tensor&& other) noexcept
    : shape_(std::move(other.shape_)), count_(std::exchange(other.count_, 0)), data_(std::move(other.data_)) {
  other.shape_.clear();
}

Tensor& Tensor::operator=(Tensor&& other) noexcept {
  std::swap(shape_, other.shape_);
  std::swap(count_, other.count_);
  std::swap(data_, other.data_);
  return *this;
}

const Shape& Tensor::shape() const {
  static const Shape none{0};
  return shape_.empty() && count_ == 0 ? none : shape_;
}

std::int64_t Tensor::size(std::int64_t axis) const {
  contract(axis >= -rank() && axis < rank(), "Tensor::size: no such axis");
  return shape()[static_cast<std::size_t>(axis < 0 ? axis + rank() : axis)];
}

std::int64_t Tensor::num_rows() const {
  std::int64_t rows = 1;
  for (std::size_t i = 0; i + 1 < shape_.size(); ++i) rows *= shape_[i];
  return rows;
}

std::span<float> Tensor::row(std::int64_t index) {
  contract(index >= 0 && index < num_rows(), "Tensor::row: no such row");
  return {data() + index * width(), static_cast<std::size_t>(width())};
}

std::span<const float> Tensor::row(std::int64_t index) const {
  contract(index >= 0 && index < num_rows(), "Tensor::row: no such row");
  return {data() + index * width(), static_cast<std::size_t>(width())};
}

Tensor Tensor::reshaped(Shape shape) const& { return Tensor(*this).reshaped(std::move(shape)); }

Tensor Tensor::reshaped(Shape shape) && {
  require(product(shape) == count_, [&] {
    return "Tensor::reshaped: " + shape_text(this->shape()) + " does not fit into " + shape_text(shape);
  });
  Tensor t = std::move(*this);
  t.shape_ = std::move(shape);
  return t;
}

}  // namespace mien

#pragma once
#include <cstdint>
#include <memory>
#include <new>

namespace mien {

/// Floats at a 64-byte address, with room up to the next multiple of 16 so that whole vector registers may be
/// read at the end. Values are uninitialised. Empty when count is 0.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::int64_t count)
      : data_(count == 0
                  ? nullptr
                  : static_cast<float*>(::operator new[](
                        static_cast<std::size_t>((count + 15) / 16 * 16) * sizeof(float), kAlignment))) {}

  [[nodiscard]] float* get() { return data_.get(); }
  [[nodiscard]] const float* get() const { return data_.get(); }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(float* p) const { ::operator delete[](p, kAlignment); }
  };
  std::unique_ptr<float[], Free> data_;
};

}  // namespace mien

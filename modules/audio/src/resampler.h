#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mien {

/// Band-limited, linear-phase change of the sample rate to 16 kHz, in a stream. Sample n of the output lies
/// at the same time as position n * input_rate / 16000 of the input.
class Resampler {
 public:
  /// Whether this build can change the rate; one without soxr takes 16 kHz alone.
  static bool takes(int input_rate_hz);
  /// @param input_rate_hz  1000 ... 768000 (checked by the readers) @pre takes(input_rate_hz)
  explicit Resampler(int input_rate_hz);
  Resampler(Resampler&&) noexcept;
  Resampler& operator=(Resampler&&) noexcept;
  ~Resampler();

  /// Appends to `out` what became known.
  void push(std::span<const float> in, std::vector<float>& out);
  /// Appends the rest: ceil(16000 N / rate) samples in all for N pushed ones.
  void finish(std::vector<float>& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mien

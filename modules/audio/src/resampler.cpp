#include "resampler.h"

#include <soxr.h>

#include <algorithm>
#include <string>

#include "mien/base/contract.h"
#include "mien/core/audio_clip.h"

namespace mien {

struct Resampler::State {
  explicit State(int rate) : input_rate_hz(rate) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { soxr_delete(soxr); }

  void process(const float* in, std::size_t count, std::vector<float>& out) {
    // in == nullptr: the end of the input.
    bool is_done = false;
    while (!is_done) {
      std::size_t used = 0, made = 0;
      const soxr_error_t error = soxr_process(soxr, in, count, &used, block.data(), block.size(), &made);
      contract(error == nullptr, std::string("Resampler: ") + (error != nullptr ? error : ""));
      num_out += static_cast<std::int64_t>(made);
      out.insert(out.end(), block.begin(), block.begin() + static_cast<std::ptrdiff_t>(made));
      if (in != nullptr) in += used;
      count -= used;
      is_done = count == 0 && made < block.size();
    }
  }

  int input_rate_hz;
  soxr_t soxr = nullptr;  // null when the rate is right already
  std::vector<float> block = std::vector<float>(4096);
  std::int64_t num_in = 0;
  std::int64_t num_out = 0;
};

bool Resampler::takes(int) { return true; }

Resampler::Resampler(int input_rate_hz) : state_(std::make_unique<State>(input_rate_hz)) {
  contract(input_rate_hz > 0, "Resampler: rate must be positive");
  if (input_rate_hz == kModelSampleRateHz) return;
  const auto io = soxr_io_spec(SOXR_FLOAT32_I, SOXR_FLOAT32_I);
  const auto quality = soxr_quality_spec(SOXR_HQ, 0);  // 20-bit precision, linear phase
  const auto runtime = soxr_runtime_spec(1);
  soxr_error_t error = nullptr;
  state_->soxr = soxr_create(input_rate_hz, kModelSampleRateHz, 1, &error, &io, &quality, &runtime);
  contract(error == nullptr && state_->soxr != nullptr, "Resampler: soxr_create failed");
}
Resampler::Resampler(Resampler&&) noexcept = default;
Resampler& Resampler::operator=(Resampler&&) noexcept = default;
Resampler::~Resampler() = default;

void Resampler::push(std::span<const float> in, std::vector<float>& out) {
  if (in.empty()) return;
  state_->num_in += static_cast<std::int64_t>(in.size());
  if (state_->soxr == nullptr) {
    out.insert(out.end(), in.begin(), in.end());
    return;
  }
  state_->process(in.data(), in.size(), out);
}

void Resampler::finish(std::vector<float>& out) {
  State& s = *state_;
  if (s.soxr == nullptr) return;
  const std::int64_t want = (s.num_in * kModelSampleRateHz + s.input_rate_hz - 1) / s.input_rate_hz;
  const std::int64_t before = s.num_out;
  const std::size_t start = out.size();
  if (s.num_in > 0) s.process(nullptr, 0, out);
  // soxr rounds the length its own way: by one sample more or less.
  out.resize(start + static_cast<std::size_t>(std::max<std::int64_t>(0, want - before)), 0.0f);
}

}  // namespace mien

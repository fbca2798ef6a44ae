#include "known_frames.h"

#include <algorithm>
#include <map>

#include "gaussian_factor.h"
#include "mien/base/contract.h"

namespace mien::facediffuser {
namespace {

// The row with each value times its weight.
Tensor weighted(std::span<const float> values, std::span<const float> weights) {
  Tensor row = Tensor::uninitialized({1, static_cast<std::int64_t>(values.size())});
  for (std::size_t c = 0; c < values.size(); ++c) row.data()[c] = weights[c] * values[c];
  return row;
}

}  // namespace

KnownFrames::KnownFrames(std::shared_ptr<const FoldedDenoiser> denoiser, const KeptValues& kept,
                         std::span<const Tensor> neutrals, int num_threads)
    : denoiser_(std::move(denoiser)), kept_(kept) {
  contract(kept.num_channels() == denoiser_->output_width, "KnownFrames: what is kept has another width");
  if (!denoiser_->is_latent()) return;
  std::map<std::vector<float>, std::int64_t> found;
  const auto width = static_cast<std::size_t>(kept.num_channels());
  std::vector<float> weights(width), values(width);
  for (std::int64_t n = 0; n < kept.num_frames(); ++n) {
    mask_.push_back(-1);
    known_.emplace_back();
    if (kept.frees_frame(n)) continue;
    for (std::size_t c = 0; c < width; ++c) {
      weights[c] = kept.weight(n, static_cast<std::int64_t>(c));
      values[c] = kept.value(n, static_cast<std::int64_t>(c));
    }
    const auto [at, is_new] = found.insert({weights, static_cast<std::int64_t>(masks_.size())});
    if (is_new) masks_.push_back(make_mask(weights, neutrals, num_threads));
    mask_.back() = at->second;
    known_.back() = denoiser_->to_state(weighted(values, weights));
  }
}

KnownFrames::Mask KnownFrames::make_mask(std::span<const float> weights, std::span<const Tensor> neutrals,
                                         int num_threads) const {
  Mask mask;
  mask.is_whole = std::all_of(weights.begin(), weights.end(), [](float w) { return w == 1; });
  if (mask.is_whole) return mask;
  const FoldedDenoiser& f = *denoiser_;
  // The columns of W_out as rows, some at a time: a mesh is wide.
  constexpr std::int64_t kRows = 64;
  Tensor transposed_map = Tensor::uninitialized({f.hidden, f.state_width});
  for (std::int64_t first = 0; first < f.hidden; first += kRows) {
    const std::int64_t count = std::min(kRows, f.hidden - first);
    Tensor unit({count, f.hidden});
    for (std::int64_t i = 0; i < count; ++i) unit.row(i)[static_cast<std::size_t>(first + i)] = 1;
    Tensor columns = linear(unit, f.output, {}, num_threads);
    for (std::int64_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < weights.size(); ++c) columns.row(i)[c] *= weights[c];
    const Tensor mapped = f.to_state(columns);
    std::copy(mapped.values().begin(), mapped.values().end(), transposed_map.row(first).begin());
  }
  mask.removed = PackedMatrix(transposed(transposed_map));
  for (const Tensor& neutral : neutrals) {
    const Tensor constant = add(neutral, f.output_bias);
    mask.constants.push_back(f.to_state(weighted(constant.values(), weights)));
  }
  return mask;
}

void KnownFrames::start(std::int64_t n, float alpha, std::span<float> y) const {
  if (n >= kept_.num_frames()) return;
  if (!denoiser_->is_latent()) {
    for (std::size_t c = 0; c < y.size(); ++c) {
      const auto channel = static_cast<std::int64_t>(c);
      y[c] += alpha * kept_.weight(n, channel) * kept_.value(n, channel);
    }
    return;
  }
  const Tensor& known = known_[static_cast<std::size_t>(n)];
  for (std::int64_t i = 0; i < known.count(); ++i) y[static_cast<std::size_t>(i)] += alpha * known.data()[i];
}

void KnownFrames::replace(std::size_t lane, std::int64_t n, std::span<const float> g,
                          std::span<float> y0) const {
  if (n >= kept_.num_frames()) return;
  if (!denoiser_->is_latent()) {
    kept_.paste(n, y0);
    return;
  }
  const auto at = static_cast<std::size_t>(n);
  if (mask_[at] < 0) return;
  const Mask& mask = masks_[static_cast<std::size_t>(mask_[at])];
  const float* known = known_[at].data();
  if (mask.is_whole) {
    std::copy_n(known, y0.size(), y0.begin());
    return;
  }
  const Tensor removed = linear(Tensor({1, static_cast<std::int64_t>(g.size())}, g), mask.removed);
  const float* constant = mask.constants[lane].data();
  for (std::size_t i = 0; i < y0.size(); ++i) y0[i] += known[i] - removed.data()[i] - constant[i];
}

}  // namespace mien::facediffuser

#include "mien/models/said/fast_denoiser.h"

#include <algorithm>
#include <numeric>

#include "fast_blocks.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"

namespace mien::said {
namespace {

// Embeddings of all steps behind their SiLU, [T, time].
Tensor step_embeddings(const Denoiser<PlainWeights>& from, std::int64_t num_steps) {
  std::vector<std::int64_t> steps(static_cast<std::size_t>(num_steps));
  std::iota(steps.begin(), steps.end(), std::int64_t{0});
  const Tensor sinusoids({num_steps, from.sizes.width}, step_sinusoids(steps, from.sizes.width));
  const Tensor hidden = silu(linear(sinusoids, PackedMatrix(from.time_in.weight), from.time_in.bias));
  return silu(linear(hidden, PackedMatrix(from.time_out.weight), from.time_out.bias));
}

Product packed_conv(const Conv<PlainWeights>& from) {
  return {PackedMatrix(tap_major(from.weight)), from.bias};
}

Tensor beside(const Tensor& a, const Tensor& b) {
  const Tensor parts[] = {a, b};
  return concat_last(parts);
}

// What both branches of guidance share.
struct Prefix {
  Tensor h0, res, begun;
};

}  // namespace

struct FastDenoiser::Packed {
  Packed(const Network<PlainWeights>& from, std::int64_t steps, Backend backend, const Tensor& embeddings)
      : sizes(from.sizes),
        num_steps(steps),
        input(packed_conv(from.denoiser.input)),
        out(packed_conv(from.denoiser.out)),
        out_norm{from.denoiser.out_norm.gamma, from.denoiser.out_norm.beta, from.denoiser.out_norm.eps},
        encoder_res(from.denoiser.encoder_res, embeddings, backend),
        middle_res(from.denoiser.middle_res, embeddings, backend),
        middle_res2(from.denoiser.middle_res2, embeddings, backend),
        decoder_res(from.denoiser.decoder_res, embeddings, backend),
        decoder_res2(from.denoiser.decoder_res2, embeddings, backend),
        encoder_mix(from.denoiser.encoder_mix, from.null_condition.values(), backend),
        middle_mix(from.denoiser.middle_mix, from.null_condition.values(), backend),
        decoder_mix(from.denoiser.decoder_mix, from.null_condition.values(), backend),
        decoder_mix2(from.denoiser.decoder_mix2, from.null_condition.values(), backend) {
    if (sizes.has_projection) projection = {PackedMatrix(from.projection.weight), from.projection.bias};
  }

  [[nodiscard]] Prefix prefix(const Tensor& x_t, std::int64_t step) const {
    Tensor h0 = convolved(padded(x_t), input, input.bias.values());
    Tensor res = encoder_res.run(h0, step);
    Tensor begun = encoder_mix.begin(res);
    return {std::move(h0), std::move(res), std::move(begun)};
  }
  /// One branch: with `speech`, or without (null). -> noise [N, K]
  [[nodiscard]] Tensor finish(const Prefix& shared, std::int64_t step, const Speech* speech) const {
    std::size_t block = 0;
    const auto end = [&](const FastTransformerBlock& mix, const Tensor& x, Tensor begun) {
      const std::size_t own = block++;
      return speech == nullptr ? mix.end(x, std::move(begun), nullptr, {})
                               : mix.end(x, std::move(begun), &speech->keys_and_values[own], speech->ranges);
    };
    const Tensor h1 = end(encoder_mix, shared.res, shared.begun);
    Tensor m = middle_res.run(h1, step);
    m = end(middle_mix, m, middle_mix.begin(m));
    m = middle_res2.run(m, step);
    Tensor u = decoder_res.run(beside(m, h1), step);
    u = end(decoder_mix, u, decoder_mix.begin(u));
    Tensor w = decoder_res2.run(beside(u, shared.h0), step);
    w = end(decoder_mix2, w, decoder_mix2.begin(w));
    return convolved(normed_and_padded(w, out_norm), out, out.bias.values());
  }

  Sizes sizes;
  std::int64_t num_steps;
  Product input, out, projection;
  PackedGroupNorm out_norm;
  FastResBlock encoder_res, middle_res, middle_res2, decoder_res, decoder_res2;
  FastTransformerBlock encoder_mix, middle_mix, decoder_mix, decoder_mix2;
};

FastDenoiser::FastDenoiser(const Network<PlainWeights>& weights, std::int64_t num_steps, Backend backend)
    : packed_(std::make_unique<Packed>(weights, num_steps, backend,
                                       step_embeddings(weights.denoiser, num_steps))) {}
FastDenoiser::~FastDenoiser() = default;
FastDenoiser::FastDenoiser(FastDenoiser&&) noexcept = default;
FastDenoiser& FastDenoiser::operator=(FastDenoiser&&) noexcept = default;

const Sizes& FastDenoiser::sizes() const { return packed_->sizes; }

Tensor FastDenoiser::context(const Tensor& features) const {
  const Product& projection = packed_->projection;
  return packed_->sizes.has_projection ? linear(features, projection.weight, projection.bias) : features;
}

FastDenoiser::Speech FastDenoiser::listen(const Tensor& context, std::int64_t num_frames) const {
  const Packed& p = *packed_;
  Speech speech{{}, p.sizes.seen_keys(num_frames, context.num_rows())};
  for (const auto* block : {&p.encoder_mix, &p.middle_mix, &p.decoder_mix, &p.decoder_mix2})
    speech.keys_and_values.push_back(linear(context, block->key_value));
  return speech;
}

NoiseNetwork FastDenoiser::network(const std::vector<Speech>& speech, int num_threads) const {
  contract(!speech.empty(), "FastDenoiser::network: the speech of a clip is needed");
  return [this, &speech, num_threads](std::int64_t step, std::span<const float> x_t, std::span<float> with,
                                      std::span<float> without) {
    const Packed& p = *packed_;
    contract(step >= 0 && step < p.num_steps, "FastDenoiser: there is no such step");
    const auto num_frames = static_cast<std::int64_t>(speech[0].ranges.size());
    const auto take_size = static_cast<std::size_t>(num_frames * p.sizes.num_channels);
    const auto num_takes = static_cast<std::int64_t>(x_t.size() / take_size);
    const auto prefix_of = [&](std::int64_t take) {
      const auto own = x_t.subspan(static_cast<std::size_t>(take) * take_size, take_size);
      return p.prefix(Tensor({num_frames, p.sizes.num_channels}, own), step);
    };
    const auto branch = [&](const Prefix& shared, std::int64_t take, bool is_null) {
      const auto& heard = speech[speech.size() == 1 ? 0 : static_cast<std::size_t>(take)];
      const Tensor noise = p.finish(shared, step, is_null ? nullptr : &heard);
      std::ranges::copy(noise.values(),
                        (is_null ? without : with).begin() + take * static_cast<std::ptrdiff_t>(take_size));
    };
    const bool is_guided = !without.empty();
    if (is_guided && num_takes < num_threads) {
      // A thread for each branch saves more than what they would share.
      parallel_for(num_threads, 2 * num_takes,
                   [&](std::int64_t i) { branch(prefix_of(i / 2), i / 2, i % 2 == 1); });
      return;
    }
    parallel_for(num_threads, num_takes, [&](std::int64_t take) {
      const Prefix shared = prefix_of(take);
      branch(shared, take, false);
      if (is_guided) branch(shared, take, true);
    });
  };
}

}  // namespace mien::said

#include "mien/models/facediffuser/folded_denoiser.h"

#include <algorithm>

#include "gaussian_factor.h"

namespace mien::facediffuser {
namespace {

// Columns `first` ... of w [N, K], each times its gamma (1 when there is none).
PackedMatrix scaled_columns(const Tensor& w, std::int64_t first, std::int64_t count, const Tensor& gamma) {
  Tensor part = columns(w, first, count);
  if (gamma.count() > 0) part = mul(std::move(part), columns(gamma, first, count));
  return PackedMatrix(part);
}

// The parts of the GRU's input in its order: where each begins and how wide it is.
struct Part {
  std::int64_t first, width;
};

template <class Network>
FoldedDenoiser fold_recurrence(const std::shared_ptr<const Network>& network, const LayerNorm<Tensor>* norm,
                               Part speech, Part noise, Part time) {
  const GruLayer<Tensor>& first = network->decoder.gru().layers.front();
  const Tensor w = first.w_ih.unpacked();
  const Tensor gamma = norm != nullptr ? norm->gamma : Tensor();
  FoldedDenoiser f;
  f.output_width = network->sizes.num_channels;
  f.hidden = network->sizes.hidden;
  f.token_width = first.in;
  f.is_normalised = norm != nullptr;
  f.layers = network->decoder.gru().layers;
  f.speech_gates = scaled_columns(w, speech.first, speech.width, gamma);
  f.noise_gates = scaled_columns(w, noise.first, noise.width, gamma);
  f.time_gates = scaled_columns(w, time.first, time.width, gamma);
  if (norm != nullptr) {
    f.mean_gates = linear(norm->gamma, first.w_ih);
    f.constant_gates = linear(norm->beta, first.w_ih, first.b_ih);
  } else {
    f.mean_gates = Tensor({3 * f.hidden});
    f.constant_gates = first.b_ih;
  }
  f.output = network->out.weight;
  f.output_bias = network->out.bias;
  f.speech_tokens = [network](const Tensor& aligned) { return network->speech_tokens(aligned); };
  f.time_token = [network](std::int64_t step) { return network->time_token(Tensor({1, 1}), step); };
  return f;
}

// B carries x_t itself.
FoldedDenoiser with_plain_state(FoldedDenoiser f) {
  f.state_width = f.noise_width = f.output_width;
  f.estimate = f.output;
  f.to_state = [](const Tensor& rows) { return rows; };
  return f;
}

}  // namespace

FoldedDenoiser fold(std::shared_ptr<const VertexDenoiser<Tensor>> network, int num_threads) {
  const Sizes& s = network->sizes;
  FoldedDenoiser f =
      fold_recurrence(network, &network->norm, {0, s.latent}, {s.latent, s.latent}, {2 * s.latent, s.latent});
  f.state_width = 2 * s.latent;
  f.styles_speech = s.styles_speech;
  f.style_width = s.styles_speech ? s.latent : s.hidden;
  f.to_state = [network, num_threads](const Tensor& rows) {
    return convolve_columns(linear(rows, network->noise.map.weight, {}, num_threads),
                            network->noise.filter.taps, Tensor({1}));
  };
  f.state_bias =
      network->noise.filter(network->noise.map(Tensor({1, s.num_channels}))).reshaped({f.state_width});
  // M = A W_out, from the columns of W_out as rows, some at a time: a mesh is wide.
  constexpr std::int64_t kRows = 64;
  Tensor m_transposed = Tensor::uninitialized({s.hidden, f.state_width});
  for (std::int64_t first = 0; first < s.hidden; first += kRows) {
    const std::int64_t count = std::min(kRows, s.hidden - first);
    const Tensor part = f.to_state(transposed(network->out.weight.unpacked(first, count)));
    std::copy(part.values().begin(), part.values().end(), m_transposed.row(first).begin());
  }
  f.estimate = PackedMatrix(transposed(m_transposed));
  if (s.num_channels <= f.state_width) {  // fewer channels than numbers carried: draw the channels
    Tensor unit({s.num_channels, s.num_channels});
    for (std::int64_t i = 0; i < s.num_channels; ++i) unit.row(i)[static_cast<std::size_t>(i)] = 1;
    f.noise_map = PackedMatrix(transposed(f.to_state(unit)));
  } else {
    f.noise_map =
        PackedMatrix(gaussian_factor(network->noise.map.weight, network->noise.filter.taps, num_threads));
  }
  f.noise_width = f.noise_map.num_inputs();
  return f;
}

FoldedDenoiser fold(std::shared_ptr<const BeatDenoiser<Tensor>> network) {
  const Sizes& s = network->sizes;
  return with_plain_state(fold_recurrence(network, &network->norm, {0, s.condition},
                                          {s.condition, s.num_channels},
                                          {s.condition + s.num_channels, s.latent}));
}

FoldedDenoiser fold(std::shared_ptr<const DammDenoiser<Tensor>> network) {
  const Sizes& s = network->sizes;
  return with_plain_state(fold_recurrence(network, nullptr, {0, s.condition},
                                          {s.condition + s.latent, s.num_channels}, {s.condition, s.latent}));
}

}  // namespace mien::facediffuser

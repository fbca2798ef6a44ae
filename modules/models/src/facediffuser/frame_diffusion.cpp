#include "mien/models/facediffuser/frame_diffusion.h"

#include <algorithm>
#include <cmath>

#include "known_frames.h"
#include "mien/base/contract.h"
#include "mien/base/parallel.h"

namespace mien::facediffuser {
namespace {

constexpr double kNormEpsilon = 1e-5;  // of LayerNorm

View part(const Tensor& x, std::int64_t first, std::int64_t count) {
  return {x.data() + first * x.width(), count, x.width(), x.width()};
}

Tensor product(const View& x, const PackedMatrix& w, const Tensor& bias) {
  Tensor y = Tensor::uninitialized({x.rows, w.num_outputs()});
  matmul(x, w, bias.count() > 0 ? bias.data() : nullptr, y.data());
  return y;
}

struct Sums {
  double sum = 0, squares = 0;
};

// Four chains: one alone would wait for every addition.
Sums sums_of(std::span<const float> row) {
  double sum[4] = {}, squares[4] = {};
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto v = static_cast<double>(row[i]);
    sum[i % 4] += v;
    squares[i % 4] += v * v;
  }
  return {(sum[0] + sum[1]) + (sum[2] + sum[3]), (squares[0] + squares[1]) + (squares[2] + squares[3])};
}

}  // namespace

// F frames on their way through the steps. Rows: frame * lanes + lane.
struct FrameDiffusion::Block {
  std::int64_t num_frames = 0;
  Tensor speech_gates;  // [F * lanes, 3 G]
  std::vector<Sums> speech_sums;
  Tensor y;         // [F * lanes, state_width]
  Tensor estimate;  // the last one, where a sampler looks back
  Tensor last;      // [F * lanes, G]: scaled GRU states of the last step
};

FrameDiffusion::FrameDiffusion(std::shared_ptr<const FoldedDenoiser> denoiser,
                               const DiffusionProcess& process, const Walk& walk, std::vector<Lane> lanes,
                               int num_threads)
    : denoiser_(std::move(denoiser)),
      steps_(plan_sampling(walk.sampler, process.sampling_levels(walk.skip))),
      sampler_(walk.sampler),
      lanes_(std::move(lanes)),
      num_threads_(num_threads) {
  const FoldedDenoiser& f = *denoiser_;
  contract(!lanes_.empty(), "FrameDiffusion: at least one lane is needed");
  contract(!(f.is_latent() && sampler_.clip_x0), "FrameDiffusion: a latent estimate cannot be clipped");
  if (walk.skip > 0) start_scale_ = static_cast<float>(steps_.front().level.sigma);
  const auto num_steps = static_cast<std::int64_t>(steps_.size());
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  for (std::size_t i = 0; i < f.layers.size(); ++i)
    states_.emplace_back(Shape{num_steps * num_lanes, f.hidden});
  step_gates_ = Tensor::uninitialized({num_steps, 3 * f.hidden});
  for (std::int64_t row = 0; row < num_steps; ++row) {  // row 0 is the last step, which has process index 0
    const Tensor token = f.time_token(process.network_step(row));
    const Sums sums = sums_of(token.values());
    step_sum_.push_back(sums.sum);
    step_squares_.push_back(sums.squares);
    const Tensor gates = linear(token, f.time_gates);
    std::copy(gates.values().begin(), gates.values().end(), step_gates_.row(row).begin());
  }
  for (const Lane& lane : lanes_) {
    contract(lane.noise != nullptr, "FrameDiffusion: a lane has no noise");
    contract(
        lane.style.count() == f.style_width && lane.neutral.count() == (f.is_latent() ? f.output_width : 0),
        "FrameDiffusion: style and neutral face do not fit the denoiser");
    state_neutral_.push_back(f.is_latent() ? f.to_state(add(lane.neutral, f.output_bias))
                                           : f.output_bias.reshaped({1, f.output_width}));
  }
  if (walk.kept == nullptr) return;
  std::vector<Tensor> neutrals;
  for (const Lane& lane : lanes_) neutrals.push_back(lane.neutral);
  known_ = std::make_shared<KnownFrames>(denoiser_, *walk.kept, neutrals, num_threads);
}

void FrameDiffusion::read_speech(std::span<const Tensor> speech, Block& block) const {
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  contract(speech.size() == lanes_.size(), "FrameDiffusion: speech for every lane is needed");
  block.num_frames = speech.front().num_rows();
  const std::int64_t num_rows = block.num_frames * num_lanes;
  block.speech_gates = Tensor::uninitialized({num_rows, 3 * denoiser_->hidden});
  block.speech_sums.resize(static_cast<std::size_t>(num_rows));
  for (std::int64_t lane = 0; lane < num_lanes; ++lane) {
    const Tensor& own = speech[static_cast<std::size_t>(lane)];
    contract(own.num_rows() == block.num_frames, "FrameDiffusion: lanes have unequal numbers of frames");
    Tensor tokens = denoiser_->speech_tokens(own);
    if (denoiser_->styles_speech)
      tokens = Operations<Tensor>::mul(std::move(tokens), lanes_[static_cast<std::size_t>(lane)].style);
    const Tensor gates = linear(tokens, denoiser_->speech_gates, {}, num_threads_);
    for (std::int64_t n = 0; n < block.num_frames; ++n) {
      const std::int64_t row = n * num_lanes + lane;
      std::copy(gates.row(n).begin(), gates.row(n).end(), block.speech_gates.row(row).begin());
      block.speech_sums[static_cast<std::size_t>(row)] = sums_of(tokens.row(n));
    }
  }
}

void FrameDiffusion::start(Block& block) const {
  const FoldedDenoiser& f = *denoiser_;
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  const std::int64_t num_rows = block.num_frames * num_lanes;
  block.y = Tensor::uninitialized({num_rows, f.state_width});
  parallel_for(num_threads_, num_rows, [&](std::int64_t row) {
    const Lane& lane = lanes_[static_cast<std::size_t>(row % num_lanes)];
    Tensor z = Tensor::uninitialized({1, lane.noise_is_data ? f.output_width : f.noise_width});
    lane.noise->start(num_frames_ + row / num_lanes, z.values());
    if (lane.noise_is_data)
      z = f.to_state(z);
    else if (f.is_latent())
      z = linear(z, f.noise_map);
    for (std::int64_t i = 0; i < f.state_width; ++i)
      block.y.row(row)[static_cast<std::size_t>(i)] = start_scale_ * z.data()[i];
    if (known_)
      known_->start(num_frames_ + row / num_lanes, static_cast<float>(steps_.front().level.alpha),
                    block.y.row(row));
  });
  if (sampler_.kind == SamplerKind::dpmpp_2m) block.estimate = block.y;
  block.last = Tensor::uninitialized({num_rows, f.hidden});
}

// W_ih LayerNorm(token) + b_ih for `count` rows: the parts that are known, and the product with the token of
// y.
Tensor FrameDiffusion::first_gates(const Block& block, std::int64_t first_item, std::int64_t first_state,
                                   std::int64_t count) const {
  const FoldedDenoiser& f = *denoiser_;
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  const std::int64_t token = f.noise_gates.num_inputs(), width = 3 * f.hidden;
  Tensor tokens = Tensor::uninitialized({count, token});
  for (std::int64_t i = 0; i < count; ++i) {
    const float* y = block.y.row(first_item + i).data();
    float* out = tokens.row(i).data();
    if (!f.is_latent()) {
      std::copy_n(y, token, out);
      continue;
    }
    const float* bias = f.state_bias.data();
    for (std::int64_t k = 0; k < token; ++k)
      out[k] = std::max(std::max(y[2 * k] + bias[2 * k], y[2 * k + 1] + bias[2 * k + 1]), 0.0f);
  }
  Tensor gates = product(part(tokens, 0, count), f.noise_gates, {});
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t row = first_item + i, step = (first_state + i) / num_lanes;
    float scale = 1, mean = 0;
    if (f.is_normalised) {
      const Sums own = sums_of(tokens.row(i));
      const Sums& speech = block.speech_sums[static_cast<std::size_t>(row)];
      const auto at = static_cast<std::size_t>(step);
      const auto n = static_cast<double>(f.token_width);
      const double average = (speech.sum + own.sum + step_sum_[at]) / n;
      const double variance = (speech.squares + own.squares + step_squares_[at]) / n - average * average;
      scale = static_cast<float>(1 / std::sqrt(std::max(variance, 0.0) + kNormEpsilon));
      mean = static_cast<float>(average);
    }
    const float *speech = block.speech_gates.row(row).data(), *time = step_gates_.row(step).data();
    const float *of_mean = f.mean_gates.data(), *constant = f.constant_gates.data();
    float* out = gates.row(i).data();
    for (std::int64_t k = 0; k < width; ++k)
      out[k] = (speech[k] + time[k] + out[k] - mean * of_mean[k]) * scale + constant[k];
  }
  return gates;
}

void FrameDiffusion::advance_rows(Block& block, std::int64_t diagonal, std::int64_t first,
                                  std::int64_t count) {
  const FoldedDenoiser& f = *denoiser_;
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  const auto num_steps = static_cast<std::int64_t>(steps_.size());
  // Frame n is at step diagonal - n: row n * lanes + lane of the block meets row (S - 1 - step) * lanes +
  // lane.
  const std::int64_t first_state = first + (num_steps - 1 - diagonal) * num_lanes;
  Tensor gates = first_gates(block, first, first_state, count);
  for (std::size_t i = 0; i < f.layers.size(); ++i) {
    const GruLayer<Tensor>& layer = f.layers[i];
    if (i > 0) gates = product(part(states_[i - 1], first_state, count), layer.w_ih, layer.b_ih);
    const Tensor before(Shape{count, f.hidden}, std::span(states_[i].row(first_state).data(),
                                                          static_cast<std::size_t>(count * f.hidden)));
    const Tensor after = gru_step_projected(gates, before, layer.w_hh, layer.b_hh);
    std::copy(after.values().begin(), after.values().end(), states_[i].row(first_state).begin());
  }
  Tensor g(Shape{count, f.hidden},
           std::span(states_.back().row(first_state).data(), static_cast<std::size_t>(count * f.hidden)));
  for (std::int64_t i = 0; i < count; ++i) {
    const Tensor& style = lanes_[static_cast<std::size_t>((first + i) % num_lanes)].style;
    if (style.count() > 0 && !f.styles_speech)
      for (std::int64_t k = 0; k < f.hidden; ++k) g.row(i)[static_cast<std::size_t>(k)] *= style.data()[k];
  }
  Tensor estimate = product(g.view(), f.estimate, {});
  Tensor z = Tensor::uninitialized({count, f.state_width});
  draw_noise(diagonal, first, count, z);
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t row = first + i;
    const SampleStep& step = steps_[static_cast<std::size_t>(diagonal - row / num_lanes)];
    const std::span<float> x0 = estimate.row(i);
    const Tensor& constant = state_neutral_[static_cast<std::size_t>(row % num_lanes)];
    for (std::size_t k = 0; k < x0.size(); ++k) x0[k] += constant.data()[k];
    const bool is_last = diagonal - row / num_lanes == num_steps - 1;
    if (known_ && !is_last)
      known_->replace(static_cast<std::size_t>(row % num_lanes), num_frames_ + row / num_lanes, g.row(i), x0);
    if (sampler_.clip_x0)
      for (float& v : x0) v = std::clamp(v, sampler_.clip_x0->low, sampler_.clip_x0->high);
    step.apply(block.y.row(row), x0, block.estimate.count() > 0 ? block.estimate.row(row) : x0, z.row(i));
    if (block.estimate.count() > 0) std::copy(x0.begin(), x0.end(), block.estimate.row(row).begin());
    if (is_last) std::copy(g.row(i).begin(), g.row(i).end(), block.last.row(row).begin());
  }
}

// Fresh noise of every row whose step wants some, as y.
void FrameDiffusion::draw_noise(std::int64_t diagonal, std::int64_t first, std::int64_t count,
                                Tensor& z) const {
  const FoldedDenoiser& f = *denoiser_;
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  Tensor drawn = f.is_latent() ? Tensor({count, f.noise_width}) : Tensor();
  bool any = false;
  std::vector<std::int64_t> recorded;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t n = (first + i) / num_lanes, step = diagonal - n;
    const Lane& lane = lanes_[static_cast<std::size_t>((first + i) % num_lanes)];
    if (steps_[static_cast<std::size_t>(step)].noise <= 0) continue;
    any = true;
    if (lane.noise_is_data && f.is_latent()) {
      recorded.push_back(i);
      continue;
    }
    lane.noise->step(static_cast<int>(step), num_frames_ + n, f.is_latent() ? drawn.row(i) : z.row(i));
  }
  if (!any) return;
  if (f.is_latent()) z = product(drawn.view(), f.noise_map, {});
  for (const std::int64_t i : recorded) {
    const std::int64_t n = (first + i) / num_lanes;
    Tensor whole = Tensor::uninitialized({1, f.output_width});
    lanes_[static_cast<std::size_t>((first + i) % num_lanes)].noise->step(static_cast<int>(diagonal - n),
                                                                          num_frames_ + n, whole.values());
    const Tensor mapped = f.to_state(whole);
    std::copy(mapped.values().begin(), mapped.values().end(), z.row(i).begin());
  }
}

void FrameDiffusion::advance(Block& block, std::int64_t diagonal) {
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  const auto num_steps = static_cast<std::int64_t>(steps_.size());
  const std::int64_t first = std::max<std::int64_t>(0, diagonal - num_steps + 1) * num_lanes;
  const std::int64_t end = std::min(block.num_frames, diagonal + 1) * num_lanes;
  // Rows are independent: a share for each thread, unless there is less to do than a thread costs.
  constexpr std::int64_t kRowsWorthAThread = 8;
  const std::int64_t num_parts = std::clamp<std::int64_t>((end - first) / kRowsWorthAThread, 1, num_threads_);
  const std::int64_t share = (end - first + num_parts - 1) / num_parts;
  parallel_for(num_threads_, num_parts, [&](std::int64_t p) {
    const std::int64_t from = first + p * share;
    if (from < end) advance_rows(block, diagonal, from, std::min(share, end - from));
  });
}

std::vector<Tensor> FrameDiffusion::next(std::span<const Tensor> speech) {
  const FoldedDenoiser& f = *denoiser_;
  const auto num_lanes = static_cast<std::int64_t>(lanes_.size());
  Block block;
  read_speech(speech, block);
  start(block);
  const std::int64_t num_diagonals =
      block.num_frames == 0 ? 0 : block.num_frames + static_cast<std::int64_t>(steps_.size()) - 1;
  for (std::int64_t d = 0; d < num_diagonals; ++d) advance(block, d);
  std::vector<Tensor> out;
  for (std::int64_t lane = 0; lane < num_lanes; ++lane) {
    if (!f.is_latent()) {
      Tensor own = Tensor::uninitialized({block.num_frames, f.output_width});
      for (std::int64_t n = 0; n < block.num_frames; ++n)
        std::copy_n(block.y.row(n * num_lanes + lane).begin(), own.width(), own.row(n).begin());
      out.push_back(std::move(own));
      continue;
    }
    const View own{block.last.data() + lane * f.hidden, block.num_frames, f.hidden, num_lanes * f.hidden};
    const Tensor bias = add(lanes_[static_cast<std::size_t>(lane)].neutral, f.output_bias);
    Tensor vertices = Tensor::uninitialized({block.num_frames, f.output_width});
    matmul(own, f.output, bias.data(), vertices.data(), num_threads_);
    out.push_back(std::move(vertices));
  }
  num_frames_ += block.num_frames;
  return out;
}

}  // namespace mien::facediffuser

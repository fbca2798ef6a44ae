#include "face_weights.h"

#include <algorithm>

#include "mien/models/alignment.h"

namespace mien::parity {
namespace {

AnyDenoiser load_network(const Fixture& weights) {
  const auto sizes = facediffuser::sizes_of(weights.file());
  if (!sizes) throw std::runtime_error(sizes.error().message());
  switch (sizes->variant) {
    case facediffuser::Variant::vertices:
      return loaded(weights, facediffuser::VertexDenoiser<Tensor>(*sizes));
    case facediffuser::Variant::beat:
      return loaded(weights, facediffuser::BeatDenoiser<Tensor>(*sizes));
    case facediffuser::Variant::damm:
      break;
  }
  return loaded(weights, facediffuser::DammDenoiser<Tensor>(*sizes));
}

// The encoder's last layer is its output.
Tensor speech_features(const Fixture& forward) {
  std::string last;
  for (int layer = 0; forward.has("hub.layer" + std::to_string(layer)); ++layer)
    last = "hub.layer" + std::to_string(layer);
  return forward.tensor(last);
}

Tensor as_row(const Tensor& x) { return x.reshaped({1, x.count()}); }

}  // namespace

DiffuserCase::DiffuserCase(const std::string& case_name)
    : name(case_name), network(load_network(open("weights"))), forward(open("forward")) {
  const auto config = forward.config();
  num_steps = config.at("steps").get<std::int64_t>();
  const Tensor features = speech_features(forward);
  const std::int64_t num_frames = forward.tensor("x_t").num_rows();
  aligned_speech =
      aligned(features, align_features(features.num_rows(), num_frames, config.at("fps").get<double>()));
  std::visit([&](const auto& n) { given.speech = n.speech_tokens(aligned_speech); }, network);
  if (const auto* v = std::get_if<facediffuser::VertexDenoiser<Tensor>>(&network)) {
    const Fixture inputs = open("inputs");
    given.style = v->style(as_row(inputs.tensor("one_hot")));
    given.neutral = as_row(inputs.tensor("template"));
  }
}

bool DiffuserCase::is_latent() const {
  return std::holds_alternative<facediffuser::VertexDenoiser<Tensor>>(network);
}

std::shared_ptr<const facediffuser::FoldedDenoiser> DiffuserCase::folded() const {
  return std::visit(
      [](const auto& n) {
        using Network = std::decay_t<decltype(n)>;
        return std::make_shared<const facediffuser::FoldedDenoiser>(
            facediffuser::fold(std::make_shared<const Network>(n)));
      },
      network);
}

Tensor DiffuserCase::predict_x0(const Tensor& x_t, std::int64_t step) const {
  return std::visit([&](const auto& n) { return n.predict_x0(x_t, given, step); }, network);
}

RecordedNoise::RecordedNoise(const Fixture& fixture, const std::string& initial, const std::string& steps)
    : initial_(fixture.tensor(initial)) {
  if (!fixture.has(steps)) return;
  const std::int64_t count = fixture.file().find(steps)->shape.at(0);
  for (std::int64_t i = 0; i < count; ++i) steps_.push_back(fixture.slice(steps, i));
}

void RecordedNoise::start(std::int64_t frame, std::span<float> out) const {
  std::copy_n(initial_.row(frame).begin(), out.size(), out.begin());
}

void RecordedNoise::step(int step, std::int64_t frame, std::span<float> out) const {
  std::copy_n(steps_.at(static_cast<std::size_t>(step)).row(frame).begin(), out.size(), out.begin());
}

}  // namespace mien::parity

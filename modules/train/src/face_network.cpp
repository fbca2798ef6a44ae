#include "mien/train/face_network.h"

#include <cmath>

#include "mien/base/hash.h"

namespace mien::train {
namespace {

void fill_uniform(torch::Tensor& slot, double bound, Rng rng) {
  float* p = slot.data_ptr<float>();
  for (std::int64_t i = 0; i < slot.numel(); ++i) p[i] = static_cast<float>(rng.uniform(-bound, bound));
}

void fill_normal(torch::Tensor& slot, Rng rng) {
  float* p = slot.data_ptr<float>();
  for (std::int64_t i = 0; i < slot.numel(); ++i) p[i] = static_cast<float>(rng.normal());
}

// [entries, 1, L]: sine in even, cosine in odd columns (specification of FaceDiffuser, section 6).
void fill_sinusoids(torch::Tensor& table) {
  const std::int64_t width = table.size(2);
  for (std::int64_t t = 0; t < table.size(0); ++t)
    for (std::int64_t c = 0; c < width; ++c) {
      const double omega =
          std::exp(-static_cast<double>(c - c % 2) * std::log(10000.0) / static_cast<double>(width));
      const double angle = static_cast<double>(t) * omega;
      table.data_ptr<float>()[t * width + c] =
          static_cast<float>(c % 2 == 0 ? std::sin(angle) : std::cos(angle));
    }
}

bool is_below(const std::string& name, const std::string& prefix) {
  return name == prefix || name.starts_with(prefix + ".");
}

}  // namespace

void initialise_as_published(FaceNetwork& network, std::uint64_t seed) {
  Initialise start(seed);
  network.visit(start);
  Collect head;
  std::visit([&](auto& h) { h.visit(head); }, network.head);
  const auto hidden =
      static_cast<double>(std::visit([](const auto& h) { return h.sizes.hidden; }, network.head));
  const torch::NoGradGuard no_grad;
  const torch::Tensor* weight = nullptr;  // the entry before a bias is the weight that it belongs to
  for (const auto& e : head.entries) {
    const Rng rng(hash64(e.name, mix64(seed)));
    const bool is_vector = e.name == "obj_vector.weight" || e.name == "emo_vector.weight";
    if (e.name.starts_with("gru.") || e.name.starts_with("rnn."))
      fill_uniform(*e.slot, 1 / std::sqrt(hidden), rng);
    else if (is_vector)
      fill_uniform(*e.slot, 1 / std::sqrt(static_cast<double>(e.slot->size(1))), rng);
    else if (e.name == "out.weight" || e.name == "out.bias")
      fill_normal(*e.slot, rng);
    else if (e.name.ends_with(".bias") && weight->dim() > 1 &&
             e.slot->count_nonzero().item<std::int64_t>() > 0)
      fill_uniform(*e.slot,
                   std::sqrt(static_cast<double>(weight->size(0)) / static_cast<double>(weight->numel())),
                   rng);
    weight = e.slot;
  }
  if (auto* damm = std::get_if<facediffuser::DammDenoiser<torch::Tensor>>(&network.head)) {
    fill_sinusoids(damm->sinusoids);
    damm->sinusoids_again.copy_(damm->sinusoids);
  }
}

std::vector<std::string> published_frozen() {
  return {"audio_encoder.feature_extractor", "audio_encoder.feature_projection",
          "audio_encoder.encoder.layers.0", "audio_encoder.encoder.layers.1"};
}

Result<std::vector<Collect::Entry>> freeze(FaceNetwork& network, const std::vector<std::string>& frozen) {
  std::vector<Collect::Entry> all = parameters(network), learning;
  for (const auto& prefix : frozen)
    if (std::none_of(all.begin(), all.end(), [&](const auto& e) { return is_below(e.name, prefix); }))
      return Error{Errc::usage, "frozen '" + prefix + "'", "no parameter of the model is called so",
                   "Names are those that mien inspect lists"};
  for (auto& e : all) {
    const bool keeps = std::any_of(frozen.begin(), frozen.end(),
                                   [&](const std::string& prefix) { return is_below(e.name, prefix); });
    *e.slot = e.slot->detach().requires_grad_(e.trained && !keeps);
    if (e.trained && !keeps) learning.push_back(e);
  }
  if (learning.empty()) return Error{Errc::usage, "frozen", "nothing is left to learn", ""};
  return learning;
}

}  // namespace mien::train

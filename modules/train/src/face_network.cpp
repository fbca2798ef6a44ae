#include "mien/train/face_network.h"

#include <cmath>

#include "mien/base/hash.h"

namespace mien::train {
namespace {

void fill_normal(torch::Tensor& slot, Rng rng) {
  float* p = slot.data_ptr<float>();
  for (std::int64_t i = 0; i < slot.numel(); ++i) p[i] = static_cast<float>(rng.normal());
}

// PyTorch's start of nn.MultiheadAttention: Xavier's bound for queries, keys and values as one matrix
// [3 d, d], that of a linear map for the output, no biases.
bool is_of_attention(const std::string& name) { return name.find("_attn.") != std::string::npos; }
void fill_attention(torch::Tensor& slot, const std::string& name, Rng rng) {
  if (name.ends_with(".bias")) {
    slot.zero_();
    return;
  }
  const auto width = static_cast<double>(slot.size(1));
  fill_uniform(slot, name.ends_with("out_proj.weight") ? 1 / std::sqrt(width) : std::sqrt(6 / (4 * width)),
               rng);
}

// [entries, 1, L] (specification of FaceDiffuser, section 6).
void fill_sinusoids(torch::Tensor& table) {
  for (std::int64_t t = 0; t < table.size(0); ++t) {
    const std::vector<float> row = sinusoid_row(t, table.size(2));
    std::copy(row.begin(), row.end(), table.data_ptr<float>() + t * table.size(2));
  }
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
    if (e.name.starts_with("gru.") || e.name.starts_with("rnn.") || e.name.starts_with("lstm."))
      fill_uniform(*e.slot, 1 / std::sqrt(hidden), rng);
    else if (is_of_attention(e.name))
      fill_attention(*e.slot, e.name, rng);
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
  auto* damm = std::get_if<facediffuser::DammDenoiser<torch::Tensor>>(&network.head);
  if (damm != nullptr && damm->sizes.is_diffusion()) {
    fill_sinusoids(damm->sinusoids);
    damm->sinusoids_again.copy_(damm->sinusoids);
  }
}

std::vector<std::string> published_frozen() {
  return {"audio_encoder.feature_extractor", "audio_encoder.feature_projection",
          "audio_encoder.encoder.layers.0", "audio_encoder.encoder.layers.1"};
}

}  // namespace mien::train

#include "mien/train/torch_parameters.h"

#include <cmath>

#include "mien/base/hash.h"

namespace mien::train {
namespace {

torch::Tensor initial(const std::string& name, const Shape& shape, Init init, std::int64_t fan_in,
                      std::uint64_t seed) {
  switch (init) {
    case Init::zero:
      return torch::zeros(shape);
    case Init::one:
      return torch::ones(shape);
    case Init::fan_in:
    case Init::normal:
    case Init::unit_normal:
      break;
  }
  torch::Tensor values = torch::empty(shape);
  Rng rng(hash64(name, seed));
  const double bound = 1.0 / std::sqrt(static_cast<double>(fan_in));
  float* p = values.data_ptr<float>();
  for (std::int64_t i = 0; i < values.numel(); ++i)
    p[i] = static_cast<float>(init == Init::normal        ? rng.normal(0, 0.02)
                              : init == Init::unit_normal ? rng.normal()
                                                          : rng.uniform(-bound, bound));
  return values;
}

}  // namespace

void Initialise::matrix(std::string_view name, torch::Tensor& slot, std::int64_t out, std::int64_t in,
                        Init init) {
  slot = initial(full_name(name), {out, in}, init, in, seed_).requires_grad_(true);
}

void Initialise::convolution(std::string_view name, torch::Tensor& slot, std::int64_t out, std::int64_t in,
                             std::int64_t kernel, Init init) {
  slot = initial(full_name(name), {out, in, kernel}, init, in * kernel, seed_).requires_grad_(true);
}

void Initialise::tensor(std::string_view name, torch::Tensor& slot, const Shape& shape, Init init) {
  slot = initial(full_name(name), shape, init, shape.back(), seed_).requires_grad_(true);
}

void Initialise::buffer(std::string_view, torch::Tensor& slot, const Shape& shape) {
  slot = torch::zeros(shape);
}

void fill_uniform(torch::Tensor& slot, double bound, Rng random) {
  float* p = slot.data_ptr<float>();
  for (std::int64_t i = 0; i < slot.numel(); ++i) p[i] = static_cast<float>(random.uniform(-bound, bound));
}

void draw_as_pytorch(const std::vector<Collect::Entry>& entries, std::uint64_t seed) {
  const torch::NoGradGuard no_grad;
  double bound = 0;  // of the last weight: its bias has the same; 0: neither is drawn
  for (const auto& e : entries) {
    const bool is_weight = e.name.ends_with(".weight");
    // Also of transposed convolutions [in, out, kernel], whose inputs PyTorch counts so.
    if (is_weight)
      bound = e.slot->dim() > 1 && e.slot->count_nonzero().item<std::int64_t>() > 0
                  ? std::sqrt(static_cast<double>(e.slot->size(0)) / static_cast<double>(e.slot->numel()))
                  : 0;
    if (bound > 0 && (is_weight || e.name.ends_with(".bias")))
      fill_uniform(*e.slot, bound, Rng(hash64(e.name, mix64(seed))));
  }
}

Result<std::vector<Collect::Entry>> freeze(std::vector<Collect::Entry> all,
                                           const std::vector<std::string>& frozen) {
  const auto is_below = [](const std::string& name, const std::string& prefix) {
    return name == prefix || name.starts_with(prefix + ".");
  };
  for (const auto& prefix : frozen)
    if (std::none_of(all.begin(), all.end(), [&](const auto& e) { return is_below(e.name, prefix); }))
      return Error{Errc::usage, "frozen '" + prefix + "'", "no parameter of the model is called so",
                   "Names are those that mien inspect lists"};
  std::vector<Collect::Entry> learning;
  for (auto& e : all) {
    const bool keeps = std::any_of(frozen.begin(), frozen.end(),
                                   [&](const std::string& prefix) { return is_below(e.name, prefix); });
    *e.slot = e.slot->detach().requires_grad_(e.trained && !keeps);
    if (e.trained && !keeps) learning.push_back(e);
  }
  if (learning.empty()) return Error{Errc::usage, "frozen", "nothing is left to learn", ""};
  return learning;
}

Status load_parameters(const std::vector<Collect::Entry>& entries, const SafetensorsFile& file,
                       std::string_view prefix) {
  std::string problems;
  for (const auto& entry : entries) {
    const auto shape = entry.slot->sizes().vec();
    const auto found = file.expect(entry.name, shape);
    if (!found) problems += (problems.empty() ? "" : "; ") + found.error().message();
  }
  for (const auto& stored : file.tensors()) {
    if (!stored.name.starts_with(prefix)) continue;
    const bool known =
        std::any_of(entries.begin(), entries.end(), [&](const auto& e) { return e.name == stored.name; });
    if (!known) problems += (problems.empty() ? "" : "; ") + ("unknown tensor '" + stored.name + "'");
  }
  if (!problems.empty())
    return Error{Errc::incompatible, "weights", problems, "Was it trained with other sizes?"};
  const torch::NoGradGuard no_grad;
  for (const auto& entry : entries) {
    MIEN_TRY(auto values, file.read_float(entry.name));
    entry.slot->copy_(torch::from_blob(values.data(), entry.slot->sizes()));
  }
  return Done{};
}

Status save_parameters(const std::vector<Collect::Entry>& entries, const std::filesystem::path& path,
                       bool half, const std::map<std::string, std::string>& metadata) {
  std::vector<StoredTensor> stored;
  for (const auto& e : entries)
    stored.push_back({e.name, half && e.trained ? Dtype::f16 : Dtype::f32, e.slot->sizes().vec()});
  MIEN_TRY(auto writer, SafetensorsWriter::create(path, stored, metadata));
  for (const auto& e : entries) {
    const torch::Tensor values = e.slot->detach().to(torch::kCPU).contiguous();
    const std::span<const float> span(values.data_ptr<float>(), static_cast<std::size_t>(values.numel()));
    MIEN_TRY([[maybe_unused]] const auto written, writer.write_float(e.name, span));
  }
  return writer.finish();
}

}  // namespace mien::train

#include "mien/train/optimiser.h"

#include <cmath>
#include <numbers>
#include <system_error>

#include "mien/base/number_text.h"

namespace mien::train {
namespace {

struct Moments {
  torch::Tensor first, second, average;
};

double learning_rate_at(const StageOptions& o, std::int64_t step) {
  if (step < o.warm_up_steps)
    return o.learning_rate * static_cast<double>(step + 1) / static_cast<double>(o.warm_up_steps);
  const double done = static_cast<double>(step - o.warm_up_steps) /
                      static_cast<double>(std::max<std::int64_t>(1, o.num_steps - o.warm_up_steps));
  return o.learning_rate * (0.01 + 0.99 * 0.5 * (1 + std::cos(std::numbers::pi * done)));
}

double clip_gradients(const std::vector<Collect::Entry>& entries, double limit) {
  double square = 0;
  for (const auto& e : entries)
    if (e.slot->grad().defined()) square += e.slot->grad().square().sum().item<double>();
  const double norm = std::sqrt(square);
  if (norm > limit)
    for (const auto& e : entries)
      if (e.slot->grad().defined()) e.slot->mutable_grad().mul_(limit / norm);
  return norm;
}

void adamw_step(const StageOptions& o, std::int64_t step, double rate,
                const std::vector<Collect::Entry>& entries, std::vector<Moments>& moments) {
  constexpr double kEpsilon = 1e-8;
  const double correction1 = 1 - std::pow(o.beta1, static_cast<double>(step + 1));
  const double correction2 = 1 - std::pow(o.beta2, static_cast<double>(step + 1));
  // A short run would otherwise keep its random start in the average.
  const double decay =
      std::min(o.average_decay, (1.0 + static_cast<double>(step)) / (10.0 + static_cast<double>(step)));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    torch::Tensor& p = *entries[i].slot;
    if (p.grad().defined()) {
      const torch::Tensor g = p.grad();
      auto& [m, v, average] = moments[i];
      m.mul_(o.beta1).add_(g, 1 - o.beta1);
      v.mul_(o.beta2).addcmul_(g, g, 1 - o.beta2);
      if (p.dim() > 1) p.mul_(1 - rate * o.weight_decay);
      p.addcdiv_(m, (v / correction2).sqrt_().add_(kEpsilon), -rate / correction1);
      p.mutable_grad().zero_();
    }
    moments[i].average.lerp_(p, 1 - decay);
  }
}

std::vector<Collect::Entry> state_entries(const std::vector<Collect::Entry>& entries,
                                          std::vector<Moments>& moments) {
  std::vector<Collect::Entry> all = entries;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    all.push_back({"first." + entries[i].name, &moments[i].first, false});
    all.push_back({"second." + entries[i].name, &moments[i].second, false});
    all.push_back({"average." + entries[i].name, &moments[i].average, false});
  }
  return all;
}

// Fills the state and returns its step.
Result<std::int64_t> load_checkpoint(const std::vector<Collect::Entry>& state,
                                     const std::filesystem::path& checkpoint) {
  MIEN_TRY(const auto file, SafetensorsFile::open(checkpoint));
  MIEN_TRY([[maybe_unused]] const auto loaded, load_parameters(state, file));
  const auto found = file.metadata().find("step");
  const auto step = found == file.metadata().end() ? std::nullopt : parse_int(found->second);
  if (!step) return Error{Errc::incompatible, checkpoint.string(), "is not a checkpoint of a training stage", ""};
  return *step;
}

std::vector<Moments> fresh_moments(const std::vector<Collect::Entry>& entries) {
  std::vector<Moments> moments;
  for (const auto& e : entries) {
    const auto values = e.slot->detach();
    moments.push_back({torch::zeros_like(values), torch::zeros_like(values), values.clone()});
  }
  return moments;
}

std::vector<Collect::Entry> trained(const std::vector<Collect::Entry>& entries) {
  std::vector<Collect::Entry> out;
  for (const auto& e : entries)
    if (e.trained) out.push_back(e);
  return out;
}

void deliver_average(const std::vector<Collect::Entry>& entries, const std::vector<Moments>& moments) {
  const torch::NoGradGuard no_grad;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].slot->requires_grad_(false);
    entries[i].slot->copy_(moments[i].average);
  }
}

}  // namespace

Result<std::int64_t> load_stage_average(const std::vector<Collect::Entry>& all_entries,
                                        const std::filesystem::path& checkpoint) {
  const auto entries = trained(all_entries);
  auto moments = fresh_moments(entries);
  MIEN_TRY(const auto step, load_checkpoint(state_entries(entries, moments), checkpoint));
  deliver_average(entries, moments);
  return step;
}

Status run_stage(const std::string& name, const std::vector<Collect::Entry>& all_entries,
                 const StageOptions& options, const std::filesystem::path& checkpoint,
                 const std::function<torch::Tensor(std::int64_t)>& loss, Progress& progress,
                 const std::function<void(const StepReport&)>& report) {
  const auto entries = trained(all_entries);
  for (const auto& e : entries) e.slot->requires_grad_(true);
  auto moments = fresh_moments(entries);
  const auto state = state_entries(entries, moments);

  std::int64_t step = 0;
  if (std::filesystem::exists(checkpoint)) {
    MIEN_TRY(step, load_checkpoint(state, checkpoint));
  }
  const auto save = [&] {
    return save_parameters(state, checkpoint, false, {{"step", std::to_string(step)}});
  };

  progress.stage(name, options.num_steps);
  while (step < options.num_steps) {
    const torch::Tensor value = loss(step);
    const double loss_value = value.item<double>();
    if (!std::isfinite(loss_value))
      return Error{Errc::failed, name, "the loss is not finite at step " + std::to_string(step),
                   "Lower the learning rate and go on from the last checkpoint"};
    value.backward();
    const double rate = learning_rate_at(options, step);
    double norm = 0;
    {
      const torch::NoGradGuard no_grad;
      norm = clip_gradients(entries, options.clip_norm);
      adamw_step(options, step, rate, entries, moments);
    }
    report({step, loss_value, rate, norm});
    ++step;
    progress.update(step);
    const bool stop = progress.cancelled();
    if (stop || step == options.num_steps || step % options.checkpoint_every == 0) {
      MIEN_TRY([[maybe_unused]] const auto saved, save());
    }
    if (stop)
      return Error{Errc::cancelled, name, "interrupted at step " + std::to_string(step),
                   "Run again to go on"};
  }
  deliver_average(entries, moments);
  return Done{};
}

}  // namespace mien::train

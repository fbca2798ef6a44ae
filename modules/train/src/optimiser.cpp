#include "mien/train/optimiser.h"

#include <cmath>
#include <numbers>
#include <system_error>

#include "mien/base/number_text.h"

namespace mien::train {
namespace {

struct Moments {
  torch::Tensor first, second, average;  // no average when none is kept
  std::int64_t first_step = -1;          // of the first gradient; -1: there was none yet
};

double learning_rate_at(const StageOptions& o, std::int64_t step) {
  if (step < o.warm_up_steps)
    return o.learning_rate * static_cast<double>(o.starts_at_zero ? step : step + 1) /
           static_cast<double>(o.warm_up_steps);
  if (!o.falling_rate) return o.learning_rate;
  const double done = static_cast<double>(step - o.warm_up_steps) /
                      static_cast<double>(std::max<std::int64_t>(1, o.num_steps - o.warm_up_steps));
  return o.learning_rate * (0.01 + 0.99 * 0.5 * (1 + std::cos(std::numbers::pi * done)));
}

double clip_gradients(const std::vector<Collect::Entry>& entries, double limit) {
  double square = 0;
  for (const auto& e : entries)
    if (e.slot->grad().defined()) square += e.slot->grad().square().sum().item<double>();
  const double norm = std::sqrt(square);
  if (limit > 0 && norm > limit)
    for (const auto& e : entries)
      if (e.slot->grad().defined()) e.slot->mutable_grad().mul_(limit / norm);
  return norm;
}

void adamw_step(const StageOptions& o, std::int64_t step, double rate,
                const std::vector<Collect::Entry>& entries, std::vector<Moments>& moments) {
  // A short run would otherwise keep its random start in the average.
  const auto done = static_cast<double>(step);
  const double decay = step == 0 ? 0 : std::min(o.average_decay, (1 + done) / (10 + done));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    torch::Tensor& p = *entries[i].slot;
    if (p.grad().defined()) {
      const torch::Tensor g = p.grad();
      auto& [m, v, average, first_step] = moments[i];
      if (first_step < 0) first_step = step;
      const auto num_updates = static_cast<double>(step - first_step + 1);
      const double correction1 = 1 - std::pow(o.beta1, num_updates);
      const double correction2 = 1 - std::pow(o.beta2, num_updates);
      m.mul_(o.beta1).add_(g, 1 - o.beta1);
      v.mul_(o.beta2).addcmul_(g, g, 1 - o.beta2);
      if ((p.dim() > 1 || o.decays_vectors) && o.weight_decay > 0) p.mul_(1 - rate * o.weight_decay);
      p.addcdiv_(m, (v / correction2).sqrt_().add_(o.epsilon), -rate / correction1);
      p.mutable_grad().zero_();
    }
    if (moments[i].average.defined()) moments[i].average.lerp_(p, 1 - decay);
  }
}

// What a checkpoint holds: the trained entries, what the optimiser keeps of each, and buffers.
std::vector<Collect::Entry> state_entries(const std::vector<Collect::Entry>& entries,
                                          std::vector<Moments>& moments,
                                          const std::vector<Collect::Entry>& buffers) {
  std::vector<Collect::Entry> all = entries;
  all.insert(all.end(), buffers.begin(), buffers.end());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    all.push_back({"first." + entries[i].name, &moments[i].first, false});
    all.push_back({"second." + entries[i].name, &moments[i].second, false});
    if (moments[i].average.defined())
      all.push_back({"average." + entries[i].name, &moments[i].average, false});
  }
  return all;
}

std::string first_step_key(const Collect::Entry& entry) { return "first_step." + entry.name; }

// Nearly all parameters have a gradient in the first step; the others are named.
Metadata checkpoint_metadata(std::int64_t step, const std::vector<Collect::Entry>& entries,
                             const std::vector<Moments>& moments) {
  Metadata metadata = {{"step", std::to_string(step)}};
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (moments[i].first_step != 0)
      metadata[first_step_key(entries[i])] = std::to_string(moments[i].first_step);
  return metadata;
}

// Fills the state and returns its step.
Result<std::int64_t> load_checkpoint(const std::vector<Collect::Entry>& entries,
                                     std::vector<Moments>& moments,
                                     const std::vector<Collect::Entry>& buffers,
                                     const SafetensorsFile& file) {
  MIEN_TRY([[maybe_unused]] const auto loaded,
           load_parameters(state_entries(entries, moments, buffers), file));
  const auto number = [&](const std::string& key) -> std::optional<std::int64_t> {
    const auto found = file.metadata().find(key);
    return found == file.metadata().end() ? std::nullopt : parse_int(found->second);
  };
  const auto step = number("step");
  if (!step) return Error{Errc::incompatible, "checkpoint", "is not one of a training stage", ""};
  for (std::size_t i = 0; i < entries.size(); ++i)
    moments[i].first_step = number(first_step_key(entries[i])).value_or(0);
  return *step;
}

std::vector<Moments> fresh_moments(const std::vector<Collect::Entry>& entries, bool with_average) {
  std::vector<Moments> moments;
  for (const auto& e : entries) {
    const auto values = e.slot->detach();
    moments.push_back({torch::zeros_like(values), torch::zeros_like(values),
                       with_average ? values.clone() : torch::Tensor()});
  }
  return moments;
}

std::vector<Collect::Entry> trained(const std::vector<Collect::Entry>& entries) {
  std::vector<Collect::Entry> out;
  for (const auto& e : entries)
    if (e.trained) out.push_back(e);
  return out;
}

std::vector<Collect::Entry> not_trained(const std::vector<Collect::Entry>& entries) {
  std::vector<Collect::Entry> out;
  for (const auto& e : entries)
    if (!e.trained) out.push_back(e);
  return out;
}

void run_with_average(const std::vector<Collect::Entry>& entries, const std::vector<Moments>& moments,
                      const std::function<void()>& work) {
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> kept;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!moments[i].average.defined()) continue;
    kept.push_back(entries[i].slot->detach().clone());
    entries[i].slot->copy_(moments[i].average);
  }
  work();
  for (std::size_t i = 0, k = 0; i < entries.size(); ++i)
    if (moments[i].average.defined()) entries[i].slot->copy_(kept[k++]);
}

void deliver_average(const std::vector<Collect::Entry>& entries, const std::vector<Moments>& moments) {
  const torch::NoGradGuard no_grad;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].slot->requires_grad_(false);
    if (moments[i].average.defined()) entries[i].slot->copy_(moments[i].average);
  }
}

}  // namespace

Result<std::int64_t> load_stage_average(const std::vector<Collect::Entry>& all_entries,
                                        const std::filesystem::path& checkpoint) {
  const auto entries = trained(all_entries);
  MIEN_TRY(const auto file, SafetensorsFile::open(checkpoint));
  const bool has_average = !entries.empty() && file.find("average." + entries.front().name) != nullptr;
  auto moments = fresh_moments(entries, has_average);
  auto buffers = not_trained(all_entries);
  std::erase_if(buffers, [&](const auto& e) { return file.find(e.name) == nullptr; });
  MIEN_TRY(const auto step, load_checkpoint(entries, moments, buffers, file));
  deliver_average(entries, moments);
  return step;
}

Status run_stage(const std::string& name, const std::vector<Collect::Entry>& all_entries,
                 const StageOptions& options, const std::filesystem::path& checkpoint,
                 const std::function<Result<torch::Tensor>(std::int64_t)>& loss, Progress& progress,
                 const std::function<void(const StepReport&)>& report) {
  const auto entries = trained(all_entries);
  for (const auto& e : entries) e.slot->requires_grad_(true);
  auto moments = fresh_moments(entries, options.average_decay > 0);
  const auto buffers = options.keeps_buffers ? not_trained(all_entries) : std::vector<Collect::Entry>();

  std::int64_t step = 0;
  if (std::filesystem::exists(checkpoint)) {
    MIEN_TRY(const auto file, SafetensorsFile::open(checkpoint));
    MIEN_TRY(step, load_checkpoint(entries, moments, buffers, file));
    // As after a step: momentum goes on moving what the next loss does not depend on.
    for (std::size_t i = 0; i < entries.size(); ++i)
      if (moments[i].first_step >= 0)
        entries[i].slot->mutable_grad() = torch::zeros_like(entries[i].slot->detach());
  }
  const auto save = [&] {
    return save_parameters(state_entries(entries, moments, buffers), checkpoint, false,
                           checkpoint_metadata(step, entries, moments));
  };

  progress.stage(name, options.num_steps);
  while (step < options.num_steps) {
    MIEN_TRY(const torch::Tensor value, loss(step));
    if (!value.defined()) {  // enough
      progress.update(options.num_steps);
      MIEN_TRY([[maybe_unused]] const auto saved, save());
      break;
    }
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
    report({step, loss_value, rate, norm,
            [&](const std::function<void()>& work) { run_with_average(entries, moments, work); }});
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

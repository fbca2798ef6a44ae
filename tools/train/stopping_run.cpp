#include "stopping_run.h"

#include "mien/base/file.h"
#include "mien/base/number_text.h"

namespace mien::train {
namespace {

std::vector<Collect::Entry> with_state(std::vector<Collect::Entry> learning, EarlyStopping& state) {
  for (auto& entry : state.entries()) learning.push_back(entry);
  return learning;
}

std::string short_number(double value) { return shortest(static_cast<float>(value)); }

std::string report(std::int64_t epoch, const probtalk3d::Validation& v, double figure) {
  std::string text = "epoch " + std::to_string(epoch) + ": validation loss " + short_number(v.mean_loss()) +
                     " (compared: " + short_number(figure) + "), expression " + short_number(v.expression) +
                     ", jaw " + short_number(v.jaw) + ", mean_l2 " + short_number(v.mean_l2) + ", mean_var " +
                     short_number(v.mean_var);
  if (v.perplexity > 0) text += ", codes in use " + fixed(v.perplexity, 1);
  return text;
}

std::filesystem::path best_model(const RunConfig& run) { return run.work_folder / "best.safetensors"; }

// One model file becomes another; both are complete at any time.
Status copy_model(const std::filesystem::path& from, const std::filesystem::path& to) {
  MIEN_TRY(const Bytes bytes, read_file(from));
  return write_file(to, std::span<const std::byte>(bytes));
}

}  // namespace

void read_stopping(TomlFile& file, StoppingFields& stopping) {
  file.read_word("training", "monitor", stopping.monitor, parse_monitor, "running_mean or epoch_mean");
  file.read("training", "patience", stopping.patience, not_negative());
  const auto parse_keep = [](const std::string& word) -> std::optional<bool> {
    if (word != "last" && word != "best") return std::nullopt;
    return word == "best";
  };
  file.read_word("training", "keep", stopping.keeps_best, parse_keep, "last or best");
}

Status run_until_stopped(const RunConfig& run, const StoppingFields& stopping, const StoppingRun& what,
                         ConsoleProgress& progress) {
  if ((stopping.patience > 0 || stopping.keeps_best) && !what.has_validation)
    return Error{Errc::incompatible, "'" + run.data.string() + "'",
                 "has no sequence to validate, which [training] patience and keep = \"best\" need",
                 "Name a corpus of the split valid in [run] validation, or set patience = 0 and keep = "
                 "\"last\""};
  EarlyStopping state(stopping.monitor, stopping.patience);
  const auto best = best_model(run);
  const auto end_epoch = [&](std::int64_t epoch) -> Status {
    if (!what.has_validation) return Done{};
    MIEN_TRY(const auto valid, what.validate(epoch));
    const bool is_best = state.observe(valid.losses);
    progress.say(report(epoch, valid, state.figure()));
    if (state.is_over())
      progress.say("no better in " + std::to_string(stopping.patience) + " epochs: this was the last");
    return is_best ? what.write_model(best) : Status(Done{});
  };
  auto options = what.options;
  options.keeps_buffers = true;  // of `state`
  MIEN_TRY([[maybe_unused]] const auto done,
           run_epochs(run,
                      {with_state(what.learning, state), options, what.steps_per_epoch, what.loss, end_epoch,
                       [&] { return state.is_over(); }},
                      progress));
  MIEN_TRY([[maybe_unused]] const auto saved,
           stopping.keeps_best ? copy_model(best, run.output) : what.write_model(run.output));
  progress.say("wrote " + run.output.string());
  return Done{};
}

Status snapshot_of_stopped(const RunConfig& run, const StoppingFields& stopping,
                           std::vector<Collect::Entry> learning,
                           const std::function<Status(const std::filesystem::path& path)>& write_model,
                           const std::filesystem::path& path, ConsoleProgress& progress) {
  // It says how far the run is, and whether it is one of this configuration.
  EarlyStopping state(stopping.monitor, stopping.patience);
  MIEN_TRY(const auto step, load_stage_average(with_state(std::move(learning), state), run.checkpoint()));
  progress.say("checkpoint of step " + std::to_string(step));
  if (!stopping.keeps_best) return write_model(path);
  const auto best = best_model(run);
  if (!std::filesystem::exists(best))
    return Error{Errc::input, "'" + best.string() + "'", "is absent: no epoch has been validated yet",
                 "Try again after the first epoch, or set [training] keep = \"last\""};
  progress.say("the model of the least validation loss so far, from '" + best.string() + "'");
  return copy_model(best, path);
}

}  // namespace mien::train

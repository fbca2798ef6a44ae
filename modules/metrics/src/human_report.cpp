#include "mien/metrics/human_report.h"

#include <map>
#include <numeric>

#include "mien/base/number_text.h"

namespace mien {
namespace {

constexpr double kFewTargets = 30;

// What the first release is asked to reach, English clean.
std::string target_of(std::string_view name) {
  static const std::map<std::string_view, std::string> targets = {{"closure F1", ">= 0.62"},
                                                                  {"hit rate", ">= 0.88"},
                                                                  {"timing bias", "-30 ... 30"},
                                                                  {"sealed", ">= 0.90"},
                                                                  {"jaw-energy correlation", "0.50 ... 0.85"},
                                                                  {"pause motion ratio", "<= 0.10"},
                                                                  {"mean pause aperture", "<= 0.03"},
                                                                  {"last frame closed", "1"}};
  const auto found = targets.find(name);
  return found == targets.end() ? "" : found->second;
}

int decimals_of(std::string_view unit) { return unit == "events" ? 0 : unit == "ms" ? 1 : 3; }

std::vector<HumanClipScore> select(const std::vector<HumanClipScore>& scores,
                                   const std::vector<std::size_t>& indices) {
  std::vector<HumanClipScore> out;
  for (const std::size_t i : indices) out.push_back(scores[i]);
  return out;
}

struct Column {
  std::string name;
  HumanFigures figures;
  std::vector<Interval> intervals;  // empty = none
};

}  // namespace

MetricTable human_table(const HumanReport& report, int num_draws, std::uint64_t seed) {
  MetricTable table;
  table.title = "Human speech benchmark";
  const auto fields = human_figure_fields();
  std::vector<Column> columns;
  for (const SpeechGroup group : kSpeechGroups) {
    const auto indices = report.group(group);
    if (indices.empty()) continue;
    const auto scores = select(report.scores, indices);
    Column column{std::string(group_name(group)), pool_human(scores), {}};
    if (group == SpeechGroup::english_clean && num_draws > 0)
      column.intervals = human_intervals(scores, num_draws, seed);
    if (column.figures.targets < kFewTargets * static_cast<double>(report.takes))
      table.notes.push_back(column.name + ": fewer than 30 closures in the recordings.");
    columns.push_back(std::move(column));
  }
  const auto english = report.group(SpeechGroup::english_clean);
  if (!english.empty()) {
    const auto ours = select(report.scores, english), loudness = select(report.loudness, english);
    Column column{"loudness only, English clean", pool_human(loudness), {}};
    if (num_draws > 0) {
      column.intervals = human_intervals(loudness, num_draws, seed);
      const auto difference = human_difference_intervals(ours, loudness, num_draws, seed);
      for (std::size_t f = 0; f < fields.size(); ++f)
        if (fields[f].value == &HumanFigures::f1)
          table.notes.push_back(
              "Closure F1 minus that of loudness alone, English clean, paired: " +
              cell_text({columns.front().figures.f1 - column.figures.f1, difference[f]}, 3) + ".");
    }
    columns.push_back(std::move(column));
  }
  for (const Column& column : columns) table.columns.push_back(column.name);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    MetricRow row{std::string(fields[f].name), std::string(fields[f].unit), std::string(fields[f].definition),
                  target_of(fields[f].name),   decimals_of(fields[f].unit), {}};
    for (const Column& column : columns) {
      MetricCell cell{column.figures.*fields[f].value};
      if (!column.intervals.empty() && fields[f].unit != "events") cell.interval = column.intervals[f];
      row.cells.push_back(cell);
    }
    table.rows.push_back(std::move(row));
  }
  table.notes.insert(
      table.notes.begin(),
      "Aperture: " + std::string(aperture_name(report.variant)) + ". Predictions at " +
          fixed(report.motion_fps, 2) + " frames/s, brought to 60; " + std::to_string(report.takes) +
          " takes a recording. Brackets: 95 % bootstrap over speakers. Targets are for English clean.");
  return table;
}

}  // namespace mien

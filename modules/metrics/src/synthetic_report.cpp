#include "mien/metrics/synthetic_benchmark.h"

namespace mien {

MetricTable synthetic_table(std::span<const NamedSyntheticReport> sets, int num_draws, std::uint64_t seed) {
  MetricTable table;
  table.title = "Synthetic benchmark";
  const auto& fields = synthetic_figure_fields();
  for (const SyntheticFigureField& field : fields) {
    const int decimals = field.unit == "items"                       ? 0
                         : field.unit == "ms" || field.unit == "min" ? 1
                         : field.unit == "1/min"                     ? 1
                                                                     : 3;
    table.rows.push_back({field.name, field.unit, field.definition, field.target, decimals, {}});
  }
  for (const NamedSyntheticReport& set : sets) {
    table.columns.push_back(set.name);
    const SyntheticFigures figures = pool_synthetic(set.report.items);
    const auto intervals =
        num_draws > 0 ? synthetic_intervals(set.report.items, num_draws, seed) : std::vector<Interval>{};
    for (std::size_t f = 0; f < fields.size(); ++f) {
      MetricCell cell{fields[f].value(figures)};
      if (!intervals.empty() && fields[f].unit != "items" && fields[f].unit != "min")
        cell.interval = intervals[f];
      table.rows[f].cells.push_back(cell);
    }
  }
  if (sets.empty()) return table;
  const SyntheticOptions& options = sets.front().report.options;
  table.notes.push_back(
      "Truth: the corpus generator on exact phone times, " + std::to_string(options.true_takes) +
      " takes an item and one held out; " + std::to_string(options.samples) +
      " generated takes an item. Scores show that phones are heard, not that faces look human; never "
      "compare them with results on captured data.");
  if (num_draws > 0) table.notes.push_back("Brackets: 95 % bootstrap over recordings.");
  return table;
}

}  // namespace mien

#pragma once
#include <optional>
#include <string>
#include <vector>

#include "mien/metrics/bootstrap.h"

namespace mien {

/// A number of a report; NaN is shown as "-" (null in JSON): not defined, nothing to measure.
struct MetricCell {
  double value = 0;
  std::optional<Interval> interval = std::nullopt;  ///< 95 %
};

/// One measure over all columns, with the definition that it follows.
struct MetricRow {
  std::string name;
  std::string unit;        ///< "" for ratios and shares
  std::string definition;  ///< one sentence
  std::string target;      ///< what it should reach, "" when it is only reported
  int decimals = 3;
  std::vector<MetricCell> cells;  ///< one per column
};

/// Measures of several sets or systems side by side.
struct MetricTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<MetricRow> rows;
  std::vector<std::string>
      notes;  ///< variant, frame rate, number of takes, warnings ("fewer than 30 targets")
};

/// "0.412 [0.36, 0.47]", "-" for NaN.
std::string cell_text(const MetricCell& cell, int decimals);

/// A table of the values, the targets where there are any, then the definitions as a list and the notes.
/// @pre every row has as many cells as there are columns
std::string to_markdown(const MetricTable& table);
/// The same for a terminal: aligned columns, ASCII only where names are.
std::string to_text(const MetricTable& table);
/// {"title", "columns", "notes", "rows": [{"name", "unit", "definition", "target", "values": [{"value",
/// "low", "high"}]}]}
std::string to_json(const MetricTable& table);

}  // namespace mien

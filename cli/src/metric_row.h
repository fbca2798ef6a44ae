#pragma once
#include "mien/metrics/report.h"

namespace mien {

/// A figure of a table with one column and no target.
inline MetricRow metric_row(std::string name, double value, std::string definition, std::string unit = "") {
  return {std::move(name), std::move(unit), std::move(definition), "", 8, {{value, std::nullopt}}};
}

}  // namespace mien

#pragma once
#include <string>
#include <vector>

#include "mien/metrics/aperture.h"
#include "mien/metrics/speech_labels.h"

namespace mien::test {

// Rows that follow each other; the closure of a bilabial is its whole interval.
inline SpeechLabels make_labels(const std::vector<std::pair<std::string, double>>& phones_and_seconds) {
  SpeechLabels labels;
  double t = 0;
  for (const auto& [phone, seconds] : phones_and_seconds) {
    PhoneRow row;
    row.start = t, row.end = t + seconds, row.phone = phone, row.confidence = 0.95;
    if (phone == "p" || phone == "b" || phone == "m") row.closure = ClosureWindow{row.start, row.end};
    labels.rows.push_back(row);
    t += seconds;
  }
  return labels;
}

// 0.4 everywhere, 0 in the given time intervals.
inline Aperture open_except(double seconds, const std::vector<std::pair<double, double>>& closed) {
  Aperture a;
  for (int n = 0; n < static_cast<int>(seconds * kMetricFps + 0.5); ++n) {
    const double t = n / kMetricFps;
    double value = 0.4;
    for (const auto& [start, end] : closed)
      if (t >= start - 1e-9 && t <= end + 1e-9) value = 0;
    a.values.push_back(value);
  }
  return a;
}

}  // namespace mien::test

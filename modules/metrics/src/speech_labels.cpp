#include "mien/metrics/speech_labels.h"

#include <array>
#include <cmath>
#include <utility>

#include "mien/base/number_text.h"

namespace mien {
namespace {

constexpr std::string_view kHeader =
    "start\tend\tphone\tviseme\tclosure_start\tclosure_end\tconfidence\tflags";
constexpr std::size_t kNumColumns = 8;
constexpr std::size_t kMaxRows = 1'000'000;
constexpr double kMaxSeconds = 1e6;      // 11 days; beyond it frame numbers mean nothing
constexpr double kMaxGapSeconds = 1e-3;  // labels carry 4 decimals

constexpr std::array<std::pair<std::string_view, LabelFlag>, 9> kFlags = {
    {{"edge_start", kEdgeStart},
     {"edge_end", kEdgeEnd},
     {"cluster_start", kClusterStart},
     {"cluster_end", kClusterEnd},
     {"merged", kMerged},
     {"same_event_as_previous", kSameEvent},
     {"doubtful", kDoubtful},
     {"dtw_disagrees", kDtwDisagrees},
     {"not_quiet", kNotQuiet}}};

// The next piece of `text` up to `separator`; `text` keeps what follows.
std::string_view take_until(std::string_view& text, char separator) {
  const auto end = text.find(separator);
  const std::string_view piece = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  return piece;
}

std::optional<double> parse_time(std::string_view text) {
  const auto value = parse_double(text);
  if (!value || !std::isfinite(*value) || *value < 0 || *value > kMaxSeconds) return std::nullopt;
  return value;
}

// An error text, or nothing.
std::optional<std::string> parse_row(std::string_view line, PhoneRow& row) {
  std::array<std::string_view, kNumColumns> column;
  std::size_t count = 1;
  for (const char c : line) count += c == '\t';
  if (count != kNumColumns) return "has " + std::to_string(count) + " columns, expected 8";
  for (auto& c : column) c = take_until(line, '\t');
  const auto start = parse_time(column[0]), end = parse_time(column[1]), confidence = parse_double(column[6]);
  if (!start || !end) return "start and end must be times in seconds";
  if (*end < *start) return "ends before it starts";  // an empty row is harmless; the benchmark has one
  if (!confidence || !(*confidence >= 0 && *confidence <= 1)) return "confidence must lie in 0 ... 1";
  if (column[2].empty()) return "has no phone";
  row = {*start, *end, std::string(column[2]), std::string(column[3]), std::nullopt, *confidence, 0};
  if (column[4] != "-" || column[5] != "-") {
    const auto closure_start = parse_time(column[4]), closure_end = parse_time(column[5]);
    if (!closure_start || !closure_end) return "closure_start and closure_end must both be times or both '-'";
    row.closure = ClosureWindow{*closure_start, *closure_end};
  }
  if (column[7] == "-") return std::nullopt;
  for (std::string_view rest = column[7]; !rest.empty();) {
    const std::string_view flag = take_until(rest, ',');
    bool known = false;
    for (const auto& [name, bit] : kFlags)
      if (name == flag) row.flags |= bit, known = true;
    if (!known) return "unknown flag '" + std::string(flag.substr(0, 40)) + "'";
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::size_t> SpeechLabels::rows_of_frames(std::int64_t num_frames, double fps) const {
  std::vector<std::size_t> out;
  if (rows.empty() || num_frames <= 0) return out;
  out.reserve(static_cast<std::size_t>(num_frames));
  std::size_t k = 0;
  for (std::int64_t n = 0; n < num_frames; ++n) {
    const double t = static_cast<double>(n) / fps;
    while (k + 1 < rows.size() && t >= rows[k].end) ++k;
    out.push_back(k);
  }
  return out;
}

Result<SpeechLabels> parse_speech_labels(std::string_view text, std::string_view name) {
  const auto fail = [&](std::size_t line, const std::string& why) {
    return Error{Errc::input, "labels '" + std::string(name) + "'",
                 "line " + std::to_string(line) + " " + why, ""};
  };
  const auto without_return = [](std::string_view line) {
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  };
  if (without_return(take_until(text, '\n')) != kHeader)
    return fail(1, "is not the header 'start end phone viseme closure_start closure_end confidence flags'");
  SpeechLabels labels;
  std::vector<std::string> warnings;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view content = without_return(take_until(text, '\n'));
    if (content.empty()) continue;
    if (labels.rows.size() == kMaxRows) return fail(line, "exceeds a million rows");
    PhoneRow row;
    if (auto why = parse_row(content, row)) return fail(line, *why);
    const double expected = labels.seconds();
    if (std::abs(row.start - expected) > kMaxGapSeconds)
      return fail(line, "starts at " + fixed(row.start, 4) + " s, expected " + fixed(expected, 4) +
                            " s: rows must be contiguous from zero");
    if (row.closure && row.closure->end < row.closure->start)
      warnings.push_back("labels '" + std::string(name) + "': line " + std::to_string(line) +
                         " has a closure that ends before it starts");
    labels.rows.push_back(std::move(row));
  }
  if (labels.rows.empty()) return fail(2, "is missing: the table has no rows");
  Result<SpeechLabels> result(std::move(labels));
  result.warnings = std::move(warnings);
  return result;
}

}  // namespace mien

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "csv_text.h"
#include "even_motion.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/io/live_link_csv.h"
#include "rotations.h"
#include "shape_names.h"
#include "timecode.h"

namespace mien {
namespace {

using namespace io;

constexpr double kHalfDay = 12 * 3600.0;

// What the header says: for each channel of the result, its column.
struct Layout {
  std::size_t num_columns = 0;
  std::optional<std::size_t> time, count;
  std::vector<std::string> channels;  // ARKit, then rotations
  std::vector<std::size_t> columns;
  std::size_t num_arkit = 0;
  std::vector<std::string> unknown;
};

Layout read_header(std::string_view line) {
  const auto names = split(line);
  Layout layout;
  layout.num_columns = names.size();
  std::vector<std::optional<std::size_t>> arkit(kNumArkit), rotations(kRotationNames.size());
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::string name = lower(names[c]);
    if (name == "timecode" && !layout.time) {
      layout.time = c;
    } else if (name == "blendshapecount") {
      layout.count = c;
    } else if (const auto match = match_arkit_name(names[c]); match && !arkit[arkit_index(*match)]) {
      arkit[arkit_index(*match)] = c;
    } else {
      const auto rotation = std::find_if(kRotationNames.begin(), kRotationNames.end(),
                                         [&](std::string_view r) { return lower(r) == name; });
      if (rotation != kRotationNames.end())
        rotations[static_cast<std::size_t>(rotation - kRotationNames.begin())] = c;
      else if (!name.empty())
        layout.unknown.emplace_back(names[c]);
    }
  }
  for (std::size_t i = 0; i < kNumArkit; ++i)
    if (arkit[i]) {
      layout.channels.emplace_back(arkit_names()[i]);
      layout.columns.push_back(*arkit[i]);
    }
  layout.num_arkit = layout.channels.size();
  for (std::size_t i = 0; i < rotations.size(); ++i)
    if (rotations[i]) {
      layout.channels.emplace_back(kRotationNames[i]);
      layout.columns.push_back(*rotations[i]);
    }
  return layout;
}

// The rows as they stand; `seconds` or `timecodes` has one entry per row, or neither.
struct Table {
  std::vector<float> values;
  std::vector<double> seconds;
  std::vector<Timecode> timecodes;
  std::size_t num_rows = 0, num_faceless = 0;
};

Status read_time(std::string_view field, std::size_t line, Table& table) {
  const bool is_first = table.num_rows == 0;
  if (const auto timecode = parse_timecode(field); timecode && (is_first || !table.timecodes.empty())) {
    table.timecodes.push_back(*timecode);
    return Done{};
  }
  if (const auto seconds = parse_double(field);
      seconds && std::isfinite(*seconds) && (is_first || !table.seconds.empty())) {
    table.seconds.push_back(*seconds);
    return Done{};
  }
  return bad_line(line, "'" + std::string(field.substr(0, 40)) +
                            "' is no timecode like 00:00:01:30.000 nor a time in seconds");
}

Status read_row(const Layout& layout, std::string_view text, std::size_t line, Table& table) {
  const auto fields = split(text);
  if (layout.count && *layout.count < fields.size() && fields[*layout.count] == "0") {
    ++table.num_faceless;
    return Done{};
  }
  const bool trailing_comma = fields.size() == layout.num_columns + 1 && fields.back().empty();
  if (fields.size() != layout.num_columns && !trailing_comma)
    return bad_line(
        line,
        "it has " + std::to_string(fields.size()) + " fields, expected " + std::to_string(layout.num_columns),
        fields.size() > layout.num_columns ? "Numbers need a dot, not a comma"
                                           : "The file may be incomplete");
  for (const std::size_t column : layout.columns) {
    const auto value = parse_double(fields[column]);
    const auto number = static_cast<float>(value.value_or(NAN));
    if (!std::isfinite(number))
      return bad_line(line, "field " + std::to_string(column + 1) + ", '" +
                                std::string(fields[column].substr(0, 40)) + "', is not a number");
    table.values.push_back(number);
  }
  if (layout.time) {
    MIEN_TRY([[maybe_unused]] const auto time, read_time(fields[*layout.time], line, table));
  }
  ++table.num_rows;
  return Done{};
}

// Rate of the rows. The usual step between timecodes tells how many timecode frames a row lasts: the lower
// quartile, since dropped frames only make steps longer.
double rate_of(const Table& table, double timecode_fps) {
  constexpr double kSlowest = 5;  // frames a second; rarer rows are a broken clock, not a rate
  if (!table.timecodes.empty()) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < table.num_rows; ++i) {
      const Timecode &a = table.timecodes[i - 1], &b = table.timecodes[i];
      const double step = (b.whole_seconds - a.whole_seconds) * timecode_fps + b.frames - a.frames;
      if (step > 0) steps.push_back(step);
    }
    if (steps.empty()) return timecode_fps;
    const auto usual = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 4);
    std::nth_element(steps.begin(), usual, steps.end());
    const double fps = timecode_fps / std::max(std::round(*usual), 1.0);
    return fps >= kSlowest ? fps : timecode_fps;
  }
  if (table.seconds.size() < 2) return 60;
  const double span = table.seconds.back() - table.seconds.front();
  const double rate = static_cast<double>(table.num_rows - 1) / span;
  return span > 0 && rate > 0.1 && rate < 10000 ? usual_rate(rate) : 60;
}

// Seconds since the first row, and the rows that go forward.
struct Timeline {
  std::vector<double> times;
  std::vector<std::size_t> rows;
};

Timeline timeline_of(const Table& table, double timecode_fps, double fps) {
  Timeline line;
  double midnight = 0, previous = 0;
  for (std::size_t i = 0; i < table.num_rows; ++i) {
    double time = static_cast<double>(i) / fps;
    if (!table.timecodes.empty())
      time = table.timecodes[i].whole_seconds + table.timecodes[i].frames / timecode_fps;
    if (!table.seconds.empty()) time = table.seconds[i];
    if (!table.timecodes.empty()) {
      if (i > 0 && time + midnight < previous - kHalfDay) midnight += 2 * kHalfDay;
      time += midnight;
    }
    if (i > 0 && time <= previous) continue;
    previous = time;
    line.times.push_back(time);
    line.rows.push_back(i);
  }
  if (line.times.empty()) return line;
  const double start = line.times.front();
  for (double& time : line.times) time -= start;
  return line;
}

// Radians to degrees, and rotations that are zero throughout left out.
void finish_rotations(Motion& motion, std::size_t num_arkit) {
  const std::size_t width = motion.channels.size();
  std::vector<float> largest(width);
  for (std::size_t i = 0; i < motion.values.size(); ++i)
    largest[i % width] = std::max(largest[i % width], std::abs(motion.values[i]));
  const bool degrees = std::any_of(largest.begin() + static_cast<std::ptrdiff_t>(num_arkit), largest.end(),
                                   [](float v) { return v > 2.0f; });
  std::vector<std::size_t> kept;
  const auto any_of = [&](std::size_t first, std::size_t last) {
    for (std::size_t c = num_arkit; c < width; ++c) {
      const auto r = static_cast<std::size_t>(
          std::find(kRotationNames.begin(), kRotationNames.end(), motion.channels[c]) -
          kRotationNames.begin());
      if (r >= first && r < last && largest[c] > 0) return true;
    }
    return false;
  };
  const bool head = any_of(0, 3), eyes = any_of(3, 9);
  for (std::size_t c = 0; c < width; ++c) {
    const bool is_head = motion.channels[c].starts_with("head");
    if (c < num_arkit || (is_head ? head : eyes)) kept.push_back(c);
  }
  Motion out{motion.space, {}, motion.fps, {}};
  for (const std::size_t c : kept) out.channels.push_back(motion.channels[c]);
  out.values.reserve(static_cast<std::size_t>(motion.num_frames()) * kept.size());
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    for (const std::size_t c : kept) {
      const double factor = c < num_arkit || degrees ? 1.0 : 180 / std::numbers::pi;
      out.values.push_back(static_cast<float>(factor * motion.frame(n)[c]));
    }
  motion = std::move(out);
}

}  // namespace

Result<Motion> read_live_link_csv(std::string_view text, const CsvReadOptions& options) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const bool ends_cleanly = text.ends_with('\n');
  std::optional<Layout> layout;
  Table table;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view row = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (row.empty()) continue;
    if (!layout) {
      layout = read_header(row);
      if (layout->num_arkit == 0)
        return Error{Errc::incompatible, "CSV", "no column has an ARKit name such as JawOpen", ""};
      continue;
    }
    MIEN_TRY([[maybe_unused]] const auto done, read_row(*layout, row, line, table));
  }
  if (!layout) return Error{Errc::input, "CSV", "the file is empty", ""};

  // Timecodes count at the rate of the motion where their frame numbers allow it.
  const bool counts_so = options.fps > 0 && can_count_at(options.fps, table.timecodes);
  const double timecode_fps = counts_so ? options.fps : timecode_rate(table.timecodes);
  const double fps = options.fps > 0 ? options.fps : rate_of(table, timecode_fps);
  const Timeline line = timeline_of(table, timecode_fps, fps);
  const std::size_t width = layout->channels.size();
  std::vector<float> values;
  values.reserve(line.rows.size() * width);
  for (const std::size_t row : line.rows) {
    const auto first = table.values.begin() + static_cast<std::ptrdiff_t>(row * width);
    values.insert(values.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  auto motion = even_motion(line.times, values, layout->channels, fps);
  if (!motion) return within(motion.error(), "CSV");
  finish_rotations(*motion, layout->num_arkit);

  if (!layout->unknown.empty())
    motion.warnings.push_back("columns that are not used: " + listed(layout->unknown));
  if (line.rows.size() < table.num_rows)
    motion.warnings.push_back(std::to_string(table.num_rows - line.rows.size()) +
                              " rows go back in time and are left out");
  if (table.num_faceless > 0)
    motion.warnings.push_back(std::to_string(table.num_faceless) + " rows without a face are left out");
  if (!ends_cleanly) motion.warnings.emplace_back("the last line has no end: the file may be incomplete");
  return motion;
}

}  // namespace mien

#include "mien/io/edit_csv.h"

#include <cmath>
#include <set>

#include "csv_text.h"
#include "mien/base/number_text.h"

namespace mien {
namespace {

using namespace io;

// The lines of a text that are not blank, with their numbers.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);  // a byte order mark
  }
  // Moves to the next line; false at the end.
  bool next() {
    while (!rest_.empty()) {
      const auto end = rest_.find('\n');
      line = trimmed(rest_.substr(0, end));
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number;
      if (!line.empty()) return true;
    }
    return false;
  }
  std::string_view line;
  std::size_t number = 0;

 private:
  std::string_view rest_;
};

bool is_no_channel(std::string_view name) {
  const std::string word = lower(name);
  return word == "timecode" || word == "blendshapecount" || word == "time";
}

std::string shown(std::string_view field) { return "'" + std::string(field.substr(0, 40)) + "'"; }

}  // namespace

Result<MaskTable> read_mask_csv(std::string_view text) {
  Lines lines(text);
  if (!lines.next())
    return Error{Errc::input, "mask", "is empty", "Write a header of channel names, then a line per frame"};
  MaskTable table;
  std::vector<bool> is_used;
  std::set<std::string_view> seen;
  for (const auto name : split(lines.line)) {
    is_used.push_back(!is_no_channel(name));
    if (!is_used.back()) continue;
    if (name.empty()) return bad_line(lines.number, "a column has no name");
    if (parse_double(name)) return bad_line(lines.number, "has numbers, expected channel names");
    if (!seen.insert(name).second) return bad_line(lines.number, "names " + shown(name) + " twice");
    table.channels.emplace_back(name);
  }
  if (table.channels.empty()) return bad_line(lines.number, "names no channel");
  while (lines.next()) {
    const auto fields = split(lines.line);
    if (fields.size() != is_used.size())
      return bad_line(lines.number, "has " + std::to_string(fields.size()) + " fields, expected " +
                                        std::to_string(is_used.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (!is_used[i]) continue;
      const auto weight = parse_double(fields[i]);
      if (!weight || !(*weight >= 0 && *weight <= 1))
        return bad_line(lines.number, shown(fields[i]) + " is no number from 0 to 1",
                        "Write 1 to keep a value and 0 to make it anew");
      table.weights.push_back(static_cast<float>(*weight));
    }
  }
  if (table.weights.empty()) return Error{Errc::input, "mask", "has a header and no line", ""};
  return table;
}

Result<std::vector<MotionKey>> read_keys_csv(std::string_view text) {
  Lines lines(text);
  if (!lines.next() || lower(lines.line) != "time,channel,value")
    return Error{Errc::input, "keys", "do not begin with the header time,channel,value", ""};
  std::vector<MotionKey> keys;
  while (lines.next()) {
    const auto fields = split(lines.line);
    if (fields.size() != 3)
      return bad_line(lines.number, "has " + std::to_string(fields.size()) + " fields, expected 3",
                      "Write time,channel,value");
    const auto seconds = parse_double(fields[0]);
    if (!seconds || !std::isfinite(*seconds) || *seconds < 0)
      return bad_line(lines.number, shown(fields[0]) + " is no number of seconds from 0 on");
    if (fields[1].empty()) return bad_line(lines.number, "names no channel");
    MotionKey key{*seconds, std::string(fields[1]), std::nullopt};
    if (!fields[2].empty()) {
      const auto value = parse_double(fields[2]);
      if (!value || !std::isfinite(static_cast<float>(*value)))
        return bad_line(lines.number, shown(fields[2]) + " is no finite number");
      key.value = static_cast<float>(*value);
    }
    keys.push_back(std::move(key));
  }
  if (keys.empty()) return Error{Errc::input, "keys", "there is none", "Write lines such as 1.5,jawOpen,0.3"};
  return keys;
}

}  // namespace mien

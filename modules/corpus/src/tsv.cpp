#include "tsv.h"

#include <algorithm>

namespace mien {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> split_tabs(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t tab = line.find('\t');
    cells.push_back(line.substr(0, tab));
    if (tab == std::string_view::npos) return cells;
    line.remove_prefix(tab + 1);
  }
}

std::string_view TsvRow::text(std::string_view column) {
  if (next_ >= cells_.size()) {
    fail(column, "is missing");
    return {};
  }
  return cells_[next_++];
}

double TsvRow::number(std::string_view column, double low, double high) {
  const std::string_view cell = text(column);
  const auto value = parse_double(cell);
  if (value && *value >= low && *value <= high) return *value;
  fail(column, "'" + std::string(cell) + "' is no number from " + shortest(static_cast<float>(low)) + " to " +
                   shortest(static_cast<float>(high)));
  return low;
}

std::int64_t TsvRow::integer(std::string_view column, std::int64_t low, std::int64_t high) {
  const std::string_view cell = text(column);
  const auto value = parse_int(cell);
  if (value && *value >= low && *value <= high) return *value;
  fail(column, "'" + std::string(cell) + "' is no whole number from " + std::to_string(low) + " to " +
                   std::to_string(high));
  return low;
}

std::optional<double> TsvRow::optional_number(std::string_view column, double low, double high) {
  if (next_ < cells_.size() && cells_[next_] == "-") {
    ++next_;
    return std::nullopt;
  }
  return number(column, low, high);
}

void TsvRow::fail(std::string_view column, std::string why) {
  if (!error_)
    error_ = Error{Errc::input, where_, "column " + std::string(column) + ": " + std::move(why), ""};
}

Status read_tsv(std::string_view text, std::string_view name, std::string_view header,
                const std::function<void(TsvRow&)>& read) {
  const auto lines = lines_of(text);
  if (lines.empty() || lines.front() != header)
    return Error{Errc::input, std::string(name), "the first line must be '" + std::string(header) + "'", ""};
  const std::size_t num_columns = split_tabs(header).size();
  for (std::size_t i = 1; i < lines.size(); ++i) {
    TsvRow row(lines[i], std::string(name) + ", line " + std::to_string(i + 1));
    if (row.num_cells() != num_columns)
      return Error{
          Errc::input, std::string(name) + ", line " + std::to_string(i + 1),
          "has " + std::to_string(row.num_cells()) + " columns, expected " + std::to_string(num_columns), ""};
    read(row);
    if (row.error()) return *row.error();
  }
  return Done{};
}

}  // namespace mien

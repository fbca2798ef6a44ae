#include "mien/metrics/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"

namespace mien {
namespace {

using Json = nlohmann::ordered_json;

void require_full_rows(const MetricTable& table) {
  for (const MetricRow& row : table.rows)
    contract(row.cells.size() == table.columns.size(), "report: a row of '" + row.name + "' misses cells");
}

bool has_targets(const MetricTable& table) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [](const MetricRow& r) { return !r.target.empty(); });
}

std::string number(double value, int decimals) { return std::isfinite(value) ? fixed(value, decimals) : "-"; }

std::string label(const MetricRow& row) {
  return row.unit.empty() ? row.name : row.name + " (" + row.unit + ")";
}

// Bars inside a cell would end it.
std::string markdown_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

// Header, then one line a row: label, cells, target.
std::vector<std::vector<std::string>> grid(const MetricTable& table) {
  const bool targets = has_targets(table);
  std::vector<std::vector<std::string>> lines;
  lines.push_back({"measure"});
  lines.back().insert(lines.back().end(), table.columns.begin(), table.columns.end());
  if (targets) lines.back().push_back("target");
  for (const MetricRow& row : table.rows) {
    lines.push_back({label(row)});
    for (const MetricCell& cell : row.cells) lines.back().push_back(cell_text(cell, row.decimals));
    if (targets) lines.back().push_back(row.target);
  }
  return lines;
}

// Characters of a UTF-8 text, for alignment.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

std::string cell_text(const MetricCell& cell, int decimals) {
  std::string out = number(cell.value, decimals);
  if (cell.interval && out != "-")
    out += " [" + number(cell.interval->low, decimals) + ", " + number(cell.interval->high, decimals) + "]";
  return out;
}

std::string to_markdown(const MetricTable& table) {
  require_full_rows(table);
  std::string out;
  if (!table.title.empty()) out += "### " + table.title + "\n\n";
  const auto lines = grid(table);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    out += "|";
    for (const std::string& cell : lines[i]) out += " " + markdown_cell(cell) + " |";
    out += "\n";
    if (i > 0) continue;
    out += "|";
    for (std::size_t c = 0; c < lines[i].size(); ++c) out += " --- |";
    out += "\n";
  }
  out += "\n";
  for (const std::string& note : table.notes) out += note + "\n";
  if (!table.notes.empty()) out += "\n";
  for (const MetricRow& row : table.rows)
    if (!row.definition.empty()) out += "- **" + row.name + "**: " + row.definition + "\n";
  return out;
}

std::string to_text(const MetricTable& table) {
  require_full_rows(table);
  const auto lines = grid(table);
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], width(line[c]));
  std::string out = table.title.empty() ? "" : table.title + "\n";
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t c = 0; c < line.size(); ++c) {
      const std::string padding(widths[c] - width(line[c]), ' ');
      text += c == 0 ? line[c] + padding : "  " + padding + line[c];  // names left, numbers right
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  }
  for (const std::string& note : table.notes) out += note + "\n";
  return out;
}

std::string to_json(const MetricTable& table) {
  require_full_rows(table);
  Json rows = Json::array();
  for (const MetricRow& row : table.rows) {
    Json values = Json::array();
    for (const MetricCell& cell : row.cells) {
      Json value = {{"value", json_number(cell.value)}};
      if (cell.interval)
        value["low"] = json_number(cell.interval->low), value["high"] = json_number(cell.interval->high);
      values.push_back(std::move(value));
    }
    rows.push_back({{"name", row.name},
                    {"unit", row.unit},
                    {"definition", row.definition},
                    {"target", row.target},
                    {"values", std::move(values)}});
  }
  const Json root = {
      {"title", table.title}, {"columns", table.columns}, {"notes", table.notes}, {"rows", std::move(rows)}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mien

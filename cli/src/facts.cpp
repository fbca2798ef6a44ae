#include "facts.h"

#include <algorithm>
#include <cmath>

#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"

namespace mien {

void Facts::add(std::string_view name, std::string_view value) {
  facts_.push_back({std::string(name), std::string(value), json_string(value)});
}

void Facts::add(std::string_view name, std::int64_t value) {
  facts_.push_back({std::string(name), std::to_string(value), std::to_string(value)});
}

void Facts::add(std::string_view name, double value, int decimals, std::string_view unit) {
  const bool defined = std::isfinite(value);
  const std::string number = defined ? fixed(value, decimals) : "-";
  facts_.push_back(
      {std::string(name), number + (unit.empty() ? "" : " " + std::string(unit)), defined ? number : "null"});
}

void Facts::add(std::string_view name, const std::vector<std::string>& values) {
  std::string text, json;
  for (const auto& value : values) {
    text += (text.empty() ? "" : " ") + value;
    json += (json.empty() ? "" : ",") + json_string(value);
  }
  facts_.push_back({std::string(name), text.empty() ? "none" : text, "[" + json + "]"});
}

void Facts::add_table(std::string_view name, std::string text, std::string json) {
  facts_.push_back({std::string(name), std::move(text), std::move(json), true});
}

std::string Facts::to_text() const {
  std::size_t width = 0;
  for (const auto& fact : facts_)
    if (!fact.is_table) width = std::max(width, fact.name.size());
  std::string out;
  for (const auto& fact : facts_) {
    std::string name = fact.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    out += fact.is_table ? name + ":\n" + fact.text
                         : name + std::string(width - name.size() + 2, ' ') + fact.text + "\n";
  }
  return out;
}

std::string Facts::to_json() const {
  std::string out;
  for (const auto& fact : facts_) out += (out.empty() ? "{" : ",") + json_string(fact.name) + ":" + fact.json;
  return out + "}\n";
}

}  // namespace mien

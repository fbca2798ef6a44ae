#include "shape_names.h"

#include <algorithm>
#include <map>

#include "mien/core/arkit.h"

namespace mien::io {
namespace {

// "browInnerUp_L" stands for one half of browInnerUp; the whole ends in "p" or "f".
bool is_half(const std::string& spelling, std::string_view name) {
  if (name != "browInnerUp" && name != "cheekPuff") return false;
  const char last = spelling.back();
  return last != 'p' && last != 'P' && last != 'f' && last != 'F';
}

void take_names(const Json& owner, std::vector<std::string>& names) {
  const Json& list = array_member(member(owner, "extras"), "targetNames");
  for (std::size_t i = 0; i < std::min(list.size(), names.size()); ++i)
    if (names[i].empty() && list[i].is_string()) names[i] = list[i].get<std::string>();
}

}  // namespace

std::size_t num_targets(const Json& mesh) {
  const Json& primitives = array_member(mesh, "primitives");
  return primitives.empty() ? 0 : array_member(primitives[0], "targets").size();
}

std::vector<std::string> target_names(const GltfDocument& document, const Json& mesh) {
  const Json& primitives = array_member(mesh, "primitives");
  if (primitives.empty()) return {};
  const Json& targets = array_member(primitives[0], "targets");
  std::vector<std::string> names(targets.size());
  take_names(mesh, names);
  take_names(primitives[0], names);
  const Json& accessors = array_member(document.json, "accessors");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto accessor = index_member(targets[i], "POSITION");
    if (names[i].empty() && accessor && *accessor < accessors.size())
      names[i] = text_member(accessors[*accessor], "name");
    if (names[i].empty()) names[i] = "target_" + std::to_string(i);
  }
  return names;
}

std::vector<std::optional<std::string>> arkit_of(const std::vector<std::string>& names) {
  std::vector<std::optional<std::string>> matched(names.size());
  struct Claim {
    std::optional<std::size_t> whole;
    std::vector<std::size_t> halves;
  };
  std::map<std::string, Claim> claims;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto name = match_arkit_name(names[i]);
    if (!name) continue;
    Claim& claim = claims[std::string(*name)];
    if (is_half(names[i], *name))
      claim.halves.push_back(i);
    else if (!claim.whole || (names[*claim.whole] != *name && names[i].size() < names[*claim.whole].size()) ||
             (names[*claim.whole] != *name && names[i] == *name))
      claim.whole = i;
  }
  for (const auto& [name, claim] : claims) {
    if (claim.whole)
      matched[*claim.whole] = name;
    else
      for (const std::size_t half : claim.halves) matched[half] = name;
  }
  return matched;
}

std::string listed(const std::vector<std::string>& names, std::size_t limit) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), limit); ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > limit) text += " and " + std::to_string(names.size() - limit) + " more";
  return text;
}

}  // namespace mien::io

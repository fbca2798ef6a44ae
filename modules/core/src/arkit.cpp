#include "mien/core/arkit.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr std::array<std::string_view, kNumArkit> kNames = {
    "eyeBlinkLeft",     "eyeLookDownLeft",   "eyeLookInLeft",    "eyeLookOutLeft",      "eyeLookUpLeft",
    "eyeSquintLeft",    "eyeWideLeft",       "eyeBlinkRight",    "eyeLookDownRight",    "eyeLookInRight",
    "eyeLookOutRight",  "eyeLookUpRight",    "eyeSquintRight",   "eyeWideRight",        "jawForward",
    "jawLeft",          "jawRight",          "jawOpen",          "mouthClose",          "mouthFunnel",
    "mouthPucker",      "mouthLeft",         "mouthRight",       "mouthSmileLeft",      "mouthSmileRight",
    "mouthFrownLeft",   "mouthFrownRight",   "mouthDimpleLeft",  "mouthDimpleRight",    "mouthStretchLeft",
    "mouthStretchRight", "mouthRollLower",   "mouthRollUpper",   "mouthShrugLower",     "mouthShrugUpper",
    "mouthPressLeft",   "mouthPressRight",   "mouthLowerDownLeft", "mouthLowerDownRight", "mouthUpperUpLeft",
    "mouthUpperUpRight", "browDownLeft",     "browDownRight",    "browInnerUp",         "browOuterUpLeft",
    "browOuterUpRight", "cheekPuff",         "cheekSquintLeft",  "cheekSquintRight",    "noseSneerLeft",
    "noseSneerRight",   "tongueOut"};

constexpr std::array<std::string_view, 3> kHead = {"headYaw", "headPitch", "headRoll"};

// Lower case without prefix (up to the last dot) and separators.
std::string plain(std::string_view spelling) {
  if (const auto dot = spelling.rfind('.'); dot != std::string_view::npos) spelling.remove_prefix(dot + 1);
  std::string out;
  for (const char c : spelling)
    if (c != '_' && c != '-' && c != ' ')
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// Plain spelling -> index, with every accepted short form.
const std::unordered_map<std::string, std::size_t>& spellings() {
  static const auto table = [] {
    std::unordered_map<std::string, std::size_t> t;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const std::string name = plain(kNames[i]);
      t[name] = i;
      for (const auto& [side, letter] : {std::pair{"left", 'l'}, {"right", 'r'}}) {
        const std::string_view suffix = side;
        // jawLeft, mouthRight ... are directions, not sides: no short form.
        const bool is_direction = name == "jaw" + std::string(side) || name == "mouth" + std::string(side);
        if (name.ends_with(suffix) && !is_direction)
          t[name.substr(0, name.size() - suffix.size()) + letter] = i;
      }
    }
    for (const char* split : {"browinnerup", "cheekpuff"})
      for (const char* side : {"l", "r", "left", "right"}) t[std::string(split) + side] = t.at(split);
    return t;
  }();
  return table;
}

}  // namespace

std::span<const std::string_view, kNumArkit> arkit_names() { return kNames; }
std::span<const std::string_view, 3> head_names() { return kHead; }

std::vector<std::string> arkit_and_head_channels() {
  std::vector<std::string> names(kNames.begin(), kNames.end());
  names.insert(names.end(), kHead.begin(), kHead.end());
  return names;
}

std::vector<std::string> arkit_order(ArkitOrder order) {
  std::vector<std::string> names(kNames.begin(), kNames.end());
  switch (order) {
    case ArkitOrder::apple:
    case ArkitOrder::unreal:
      return names;
    case ArkitOrder::live_link_csv:
      std::swap(names[15], names[16]);
      std::swap(names[21], names[22]);
      return names;
    case ArkitOrder::alphabetical:
      std::sort(names.begin(), names.end());
      return names;
    case ArkitOrder::beat:
      std::sort(names.begin(), names.end());
      std::erase(names, "tongueOut");
      return names;
    case ArkitOrder::mediapipe:
      std::sort(names.begin(), names.end());
      std::erase(names, "tongueOut");
      names.insert(names.begin(), "_neutral");
      return names;
    case ArkitOrder::said: {
      std::vector<std::string> said(names.begin() + 14, names.begin() + 41);
      said.insert(said.end(), names.begin() + 46, names.begin() + 51);
      return said;
    }
  }
  contract(false, "arkit_order: unknown order");
  return {};
}

std::optional<std::string_view> match_arkit_name(std::string_view spelling) {
  const auto found = spellings().find(plain(spelling));
  if (found == spellings().end()) return std::nullopt;
  return kNames[found->second];
}

std::size_t arkit_index(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  contract(found != kNames.end(), "arkit_index: not an ARKit name: " + std::string(name));
  return static_cast<std::size_t>(found - kNames.begin());
}

}  // namespace mien

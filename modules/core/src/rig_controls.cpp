#include "mien/core/rig_controls.h"

#include <string_view>

#include "mien/base/contract.h"

namespace mien {
namespace {

struct Group {
  std::string_view name;
  std::size_t num_channels;
};

// The eye socket, and the lids and the cheek, are listed once for each side.
constexpr Group kEyeSocket[] = {{"eyesocket_in", 1}, {"eyeball", 2}, {"eyesocket", 17}, {"upperlid", 1},
                                {"lowerlid", 1},     {"eyebrow", 1}, {"eyebrows1-4", 8}};
constexpr Group kLeftFace[] = {{"lids", 14},  {"sneer", 3}, {"cheek", 9},     {"cheekbone", 6},  {"chin", 3},
                               {"lowlip", 6}, {"uplip", 5}, {"cornerlip", 3}, {"mouthcorner", 3}};
constexpr Group kMiddle[] = {{"cn_jaw", 2}, {"cn_upperlip", 3}, {"cn_mouth", 3}, {"cn_lowerlip", 4},
                             {"nose", 5},   {"cn_chin", 3},     {"cn_uplip", 3}, {"cn_lowlip", 3}};

constexpr std::array<std::size_t, 12> kBeatMouth = {23, 25, 27, 28, 31, 37, 39, 40, 41, 42, 47, 48};
constexpr std::array<std::size_t, 16> kBeatUpper = {8,  9,  10, 11, 12, 13, 14, 15,
                                                    16, 17, 18, 19, 20, 21, 49, 50};

void add(std::vector<std::string>& names, std::string_view prefix, std::span<const Group> groups) {
  for (const auto& group : groups)
    for (std::size_t i = 0; i < group.num_channels; ++i) {
      std::string name(prefix);
      name += group.name;
      if (group.num_channels > 1) name += "." + std::to_string(i);
      names.push_back(std::move(name));
    }
}

}  // namespace

std::vector<std::string> uudamm_controls() {
  std::vector<std::string> names;
  add(names, "lf_", kEyeSocket);
  add(names, "rt_", kEyeSocket);
  add(names, "lf_", kLeftFace);
  add(names, "rt_", kLeftFace);
  add(names, "", kMiddle);
  contract(names.size() == kNumUudamm, "uudamm_controls: the table has another number of channels");
  return names;
}

std::vector<std::size_t> uudamm_mouth() {
  std::vector<std::size_t> mouth;
  for (const auto& [first, last] : {std::pair<std::size_t, std::size_t>{94, 113}, {146, 177}, {183, 191}})
    for (std::size_t c = first; c <= last; ++c) mouth.push_back(c);
  return mouth;
}

std::span<const std::size_t> beat_mouth() { return kBeatMouth; }
std::span<const std::size_t> beat_upper_face() { return kBeatUpper; }

}  // namespace mien

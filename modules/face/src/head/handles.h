#pragma once
#include <map>
#include <string>
#include <string_view>

#include "head/head_skin.h"

namespace mien::head {

/// Named skin vertices that shapes pull at. A handle off the middle line exists twice, with "L" and "R" after
/// its name.
using Handles = std::map<std::string, std::uint32_t, std::less<>>;

Handles find_handles(const HeadSkin& skin);

/// True for handles that every shape holds still unless it moves them (nose, brows, forehead, temples, outer
/// eye corner): they keep mouth shapes out of the upper face. @param name with or without side
bool is_guard(std::string_view name);

/// How much of the jaw's motion a handle follows: 1 on the chin, less along the jaw line; 0 for all others.
double jaw_share(std::string_view name);

/// Nearest grid vertex of the front (z > min_z) to a frontal position, cm.
std::uint32_t nearest_in_front(const HeadSkin& skin, double x, double y, double min_z);

}  // namespace mien::head

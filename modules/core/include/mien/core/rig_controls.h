#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace mien {

/// Channels of UUDaMM's rig "Ray" (FaceDiffuser specification, section 10.5).
inline constexpr std::size_t kNumUudamm = 192;

/// One name per channel: the control, and the number of the channel among those of the control or group of
/// controls: "lf_eyebrows1-4.0" ... "lf_eyebrows1-4.7", "cn_jaw.0" (turns about x), "cn_jaw.1" (about y).
std::vector<std::string> uudamm_controls();

/// The channels that the authors' evaluation calls mouth: 94-113, 146-177, 183-191. The others are its upper
/// face.
std::vector<std::size_t> uudamm_mouth();

/// The channels of arkit_order(ArkitOrder::beat) that the authors' evaluation calls mouth (jawOpen,
/// mouthClose and the smiles are not among them) and upper face (section 13).
std::span<const std::size_t> beat_mouth();
std::span<const std::size_t> beat_upper_face();

}  // namespace mien

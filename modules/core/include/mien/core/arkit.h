#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

/// The 52 ARKit coefficient names in the order of Apple's documentation: the order of a Motion made by Mien
/// (specs of the corpus, section 3; SAiD's 32 are entries 14-40 and 46-50).
inline constexpr std::size_t kNumArkit = 52;
std::span<const std::string_view, kNumArkit> arkit_names();

/// headYaw, headPitch, headRoll: degrees; positive = to the subject's left, up, right ear down.
std::span<const std::string_view, 3> head_names();

/// arkit_names followed by head_names: the 55 channels of the default model.
std::vector<std::string> arkit_and_head_channels();

/// The orders in use by other programs; always map by name (docs/formats.md).
enum class ArkitOrder {
  apple,        ///< arkit_names()
  live_link_csv,  ///< Live Link Face CSV: jawRight before jawLeft, mouthRight before mouthLeft
  unreal,       ///< Unreal's enumeration, Live Link UDP; the same arrangement as apple
  alphabetical,
  beat,         ///< alphabetical without tongueOut: 51 names (BEAT, FaceDiffuser)
  mediapipe,    ///< "_neutral" first, then alphabetical without tongueOut
  said,         ///< SAiD and BlendVOCA: 32 names
};
std::vector<std::string> arkit_order(ArkitOrder order);

/// The ARKit name that a producer's spelling stands for: "eyeBlink_L", "EyeBlinkLeft", "blendShape1.eyeBlinkLeft",
/// "Eye-Blink-Left" -> "eyeBlinkLeft". Nothing when it is none of the 52. The two halves that ICT-FaceKit splits,
/// "browInnerUp_L" and "cheekPuff_R", give "browInnerUp" and "cheekPuff".
std::optional<std::string_view> match_arkit_name(std::string_view spelling);

/// Index in arkit_names(). @pre name is one of the 52
std::size_t arkit_index(std::string_view name);

}  // namespace mien

#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/gltf_animation.h"

namespace mien {

/// What some formats need beside the motion.
struct MotionContext {
  std::span<const std::byte> character_glb;  ///< for .glb: the character to animate
  std::string audio_name;                    ///< file name of the speech, stored in .glb and .json
  GlbAnimationOptions glb;
};

/// Extensions that write_motion() and read_motion() know: ".csv", ".glb", ".json", ".npy".
std::span<const std::string_view> motion_extensions();

/// Writes motion in the format of the extension: .csv Live Link Face (.metahuman.csv: FaceDiffuser's form of
/// it; .said.csv: SAiD's 32 coefficients; FLAME parameters: write_flame_csv()), .json, .npy [N, C] float32
/// (FLAME parameters: [1, N, 403] float64), .glb the character of the context with the motion as animation.
/// The file appears when it is complete. Warnings: what the format could not hold. Errors: Errc::usage for an
/// unknown extension or a .glb without character; else those of the format's writer.
Status write_motion(const std::filesystem::path& path, const Motion& motion,
                    const MotionContext& context = {});

struct MotionReadOptions {
  /// Frames a second for files that do not say (.npy, CSV without time): 0 = the papers' rate where the
  /// number of columns tells the data set (BIWI and 3DMEAD 25; VOCASET, Multiface, BEAT, UUDaMM 30), else 60.
  /// Overrides the rate of a .csv.
  double fps = 0;
};

/// Reads motion by extension: .csv (Live Link Face, Audio2Face, names alone), .json (ours, Audio2Face), .glb
/// and .gltf (the animation's weights and head), .npy. The channels of an .npy follow from its width: 52
/// ARKit names in their order, 55 with the head, 51 alphabetical without tongueOut (FaceDiffuser on BEAT), 32
/// SAiD's, 192 UUDaMM's rig, 403 FLAME's parameters; other widths that are multiples of 3 and at least 300
/// are vertex positions, and so is any array [frames, vertices, 3]; the rest is a rig with numbered channels. Errors: Errc::usage for an unknown
/// extension; else those of the format's reader.
Result<Motion> read_motion(const std::filesystem::path& path, const MotionReadOptions& options = {});

}  // namespace mien

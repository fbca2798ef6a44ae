#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien {

struct GlbAnimationOptions {
  std::string name = "speech";  ///< name of the new animation
  /// Store coefficients as normalised unsigned shorts: half the size, steps of 1/65535, cut to [0, 1].
  bool quantised = false;
};

/// Adds one animation to a glTF file (.glb, or .gltf text) and returns it as .glb. Nothing else of the file
/// changes: materials, textures, skins, other animations and unknown extensions stay.
///
/// Every node whose mesh has targets that a channel of `motion` drives gets a "weights" channel; targets are
/// matched by their exact name, else by ARKit name. Targets that nothing drives keep their default weight.
/// headYaw, headPitch and headRoll turn the head node (a joint named head, or a node named so that carries
/// the face), on top of its rest rotation and in the axes of the character. Keys lie at n / fps seconds.
/// animation.extras = {audio, fps}, with the audio's file name when it is not empty.
///
/// Warnings: channels without a target, targets without a channel, head angles without a head node, files
/// beside a .gltf that the result still refers to. Errors: Errc::input for damaged files and for motion
/// without frames; Errc::incompatible when no target matches or the motion is not made of coefficients;
/// Errc::failed for numbers that are not finite and files above 4 GiB.
Result<Bytes> animate_glb(std::span<const std::byte> glb, const Motion& motion, std::string_view audio_name,
                          const GlbAnimationOptions& options = {});

/// The inverse: coefficients (ARKit names in their order) and, where there is a head node that turns, head
/// angles in degrees. Of several animations, the last one written by animate_glb() is read, else the first
/// that has weights. The rate is the one of the extras, else that of the keys when they are even, else 60.
/// Keys closer than 1/20 frame to the instant of a frame are taken as they are. Errors: Errc::input for
/// damaged files and animations longer than their keys justify; Errc::incompatible when no animation moves an
/// ARKit target.
Result<Motion> read_glb_motion(std::span<const std::byte> glb);
/// The same; buffers of a .gltf may also be files in its folder.
Result<Motion> read_glb_motion(const std::filesystem::path& path);

}  // namespace mien

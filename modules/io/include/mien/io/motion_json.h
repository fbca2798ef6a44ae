#pragma once
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien {

/// Writes motion as JSON: {"mien_motion": 1, "space": "arkit" | "flame" | "vertices" | "rig", "fps": 60,
/// "audio": name (when not empty), "channels": [C names] (in the space "vertices"
/// instead "topology": {"name", "vertices": V}), "frames": [N lists of C numbers]}, one line per
/// frame. Numbers read back as the same floats. Errors: Errc::failed for numbers that are not finite.
Status write_motion_json(const Motion& motion, std::string_view audio_name, const TextSink& sink);
Result<std::string> motion_json(const Motion& motion, std::string_view audio_name = "");

/// Reads that, or a JSON export of Audio2Face (exportFps, facsNames, weightMat): its poses become channels
/// under their ARKit name where they have one, the others are left out with a warning; without any ARKit name
/// the space is `rig` and all names stay. Errors: Errc::input for text that is not JSON, wrong types, frames
/// of differing length; Errc::incompatible for JSON of another kind or a newer version.
Result<Motion> read_motion_json(std::string_view text);

}  // namespace mien

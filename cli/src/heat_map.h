#pragma once
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/face/vertex_sequence.h"
#include "pictures.h"

namespace mien {

/// What the colours of a heat map show: how far a vertex moves from frame to frame.
enum class HeatStatistic {
  mean,       ///< where the face moves
  deviation,  ///< where it moves by fits and starts
};
/// "mean" or "std". Errors (Errc::usage).
Result<HeatStatistic> parse_heat_statistic(const std::string& word);

/// Draws the face of each motion, at its first frame, in the colours of its VertexTravel, on one scale from 0
/// to the largest value of all, with a legend in millimetres a frame.
/// @param stages  of one mesh
/// @param labels  one for each stage, or none
Status write_heat_map(const std::filesystem::path& path, std::span<const VertexStage> stages,
                      const std::vector<std::string>& labels, HeatStatistic statistic,
                      const PictureOptions& options);

}  // namespace mien

#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/motion.h"
#include "mien/fit/coefficient_fit.h"

namespace mien {

/// Sequences that a path holds: itself, when it is an .npy file or a folder of frames (.obj .ply .vl, in the
/// order of their names); else the .npy files and folders of frames within it, sorted by name.
/// Errors (Errc::input): nothing of the kind.
Result<std::vector<std::filesystem::path>> find_sequences(const std::string& path);

/// Positions of vertices, frame by frame. @param fps  of files that do not say; 0: see read_motion()
/// Errors: those of the readers; Errc::incompatible for motion that is not of vertices, or frames of
/// different sizes.
Result<Motion> read_sequence(const std::filesystem::path& path, double fps);

/// What is fitted: one mesh with shapes, in the units of the sequences.
struct FitRig {
  std::vector<Vec3> neutral;
  std::vector<Blendshape> shapes;
  FitRegions regions;
  std::vector<std::uint32_t>
      taken;  ///< vertices of a sequence that the rig's stand for; empty: all, in order
};

/// @param names   shapes to use: empty for all, "said" for the 32 of SAiD, or names apart by commas
/// @param subset  file of the vertices that count, or empty: of the sequences, and of the rig too unless that
///                has just as many vertices
/// Errors: Errc::usage for names that the character lacks; those of read_index_list(); Errc::incompatible for
/// a subset that fits neither way.
Result<FitRig> fit_rig(const Character& character, const std::string& names, const std::string& subset,
                       std::int64_t sequence_vertices);

/// The vertices of each frame that the rig takes. @pre they lie within the sequence
Motion taken_vertices(const FitRig& rig, Motion sequence);

}  // namespace mien

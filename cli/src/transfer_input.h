#pragma once
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/transfer/registration.h"

namespace mien {

/// The face that gets shapes: a mesh file (.obj .ply) or the face of a FLAME model (.pkl .npz) as a
/// character of one part, or the parts of a character, in metres. @param unit  "m", "cm" or "mm": of the
/// positions of a mesh file Warnings: a size that no head in that unit has. Errors: those of the readers.
Result<Character> load_target(const std::string& path, const std::string& unit);

/// Where markers come from: a file of pairs, or two files of landmarks, one vertex a line, in the same order.
/// Without files: the landmarks68 that both characters have.
struct MarkerFiles {
  std::string pairs, source_landmarks, target_landmarks;
};
/// Errors: Errc::usage for one landmark file alone with no landmarks of the other face; those of the readers;
/// Errc::input for lists of different lengths.
Result<std::vector<Marker>> read_markers(const MarkerFiles& files, const Character& source,
                                         const Character& target);

/// [V of the merged mesh] what takes no part. Each word is a file of vertex numbers, numbers and ranges as
/// 9409-24590,12, the name of a part, or "islands": all but the largest connected component. Errors: those of
/// read_index_list(), naming the word.
Result<std::vector<bool>> read_exclusions(const std::vector<std::string>& words, const Character& character);

}  // namespace mien

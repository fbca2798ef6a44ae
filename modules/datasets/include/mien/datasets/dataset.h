#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/datasets/layout.h"
#include "mien/datasets/templates.h"

namespace mien {

/// One recording: sound and motion of one name.
struct DatasetSequence {
  std::string name;  ///< of both files, without extension
  SequenceName parts;
  std::string split;                    ///< "train", "val", "test"; empty: none of them
  std::filesystem::path audio, motion;  ///< audio: empty where the layout needs none and there is none
};

/// A prepared data set as the authors' programs read it (FaceDiffuser specification, section 10):
/// <folder>/wav/<name>.wav, <folder>/vertices_npy/<name>.npy and, for meshes, <folder>/templates.pkl (also
/// templates_scaled.pkl, or templates.safetensors as Mien writes it). Parameters of 3DMEAD lie in
/// <folder>/param/<name>.npy, [1, N, 403] (ProbTalk3D specification, section 2.1).
struct Dataset {
  const DatasetLayout* layout = nullptr;
  std::filesystem::path folder;
  std::vector<DatasetSequence> sequences;  ///< both files are there; sorted by name
  Templates templates;                     ///< empty when the data set has none or they were not found
  std::string template_problem;            ///< why they are missing or could not be read
  // What is there and of no use.
  std::vector<std::string> unpaired_audio, unpaired_motion, strange_names;
};

/// Numbers in a frame of an array [N, C], [N, V, 3] or [1, N, 403] (FLAME parameters); 0 for an array of
/// another kind.
std::int64_t frame_width(std::span<const std::int64_t> shape);
/// Frames of the same. @pre frame_width(shape) > 0
std::int64_t frame_count(std::span<const std::int64_t> shape);

/// Lists a data set; no sound and no motion is read. Without `kind` it is found from the folder's name, else
/// from the names and the width of the first sequence. Errors: Errc::input when the folder or one of its two
/// folders is missing; Errc::incompatible when it is not known which data set it is.
Result<Dataset> open_dataset(const std::filesystem::path& folder,
                             std::optional<DatasetKind> kind = std::nullopt);

/// The motion of a sequence as float32 at the layout's rate: of VOCASET every second frame. Errors: those of
/// read_npy(); Errc::incompatible for an array that is not [N, C] of the layout's kind.
Result<Motion> load_sequence(const Dataset& dataset, const DatasetSequence& sequence);

/// Numbers in a frame of what load_sequence() gives: of meshes, which may be reduced, those of the first
/// sequence. Errors: those of load_sequence(); Errc::incompatible: meshes, but no sequence.
Result<std::int64_t> loaded_width(const Dataset& dataset);

}  // namespace mien

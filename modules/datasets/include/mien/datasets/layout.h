#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mien/core/motion.h"

namespace mien {

/// A data set as one of the papers prepared it.
enum class DatasetKind {
  biwi,             ///< FaceDiffuser: emotional readings e01 ... e40, centred and scaled by face area
  biwi_expressive,  ///< FaceXHuBERT: sentences 1-40 neutral, 41-80 emotional, each axis scaled by the
                    ///< subject's box
  vocaset,          ///< FLAME topology, metres, stored at 60 frames a second
  multiface,        ///< MeshTalk topology, each axis scaled to [-1, 1]
  beat,             ///< ARKit coefficients, pieces of ten seconds
  uudamm,           ///< 192 rig controls, scaled to [-1, 1], pieces of ten seconds
  mead,             ///< 3DMEAD as ProbTalk3D prepares it: 403 FLAME parameters; split by sentence (stage 2)
  mead_prior,       ///< the same files, split by subject (stage 1); motion without sound counts, too
  mead_vertices,    ///< the same readings as meshes of FLAME, metres, with templates
};

/// Which sequences make a split.
struct SplitRule {
  std::string_view split;                      ///< "train", "val" or "test"
  std::vector<std::string> subjects;           ///< empty: all
  std::vector<std::pair<int, int>> sentences;  ///< ranges, both ends included
  std::int64_t expected = 0;                   ///< sequences of the full data set; 0: not stated
  /// Of readings with an emotion other than 0; empty: `sentences` are of all.
  std::vector<std::pair<int, int>> emotional = {};
};

struct DatasetLayout {
  DatasetKind kind = DatasetKind::biwi;
  /// "biwi", "biwi-expressive", "vocaset", "multiface", "beat", "uudamm", "3dmead", "3dmead-prior",
  /// "3dmead-vertices"
  std::string_view name;
  MotionSpace space = MotionSpace::vertices;
  std::int64_t width = 0;                   ///< numbers in a frame
  double fps = 25;                          ///< of the motion when loaded
  int keep_every = 1;                       ///< stored frames for one loaded frame
  bool has_templates = false;               ///< a neutral mesh for every subject
  std::vector<std::string> train_subjects;  ///< in the order of the released models' one-hot style
  std::vector<SplitRule> splits;  ///< a sequence goes to the first that matches; empty: see split_dataset()
  std::string_view motion_folder = "vertices_npy";
  bool needs_sound = true;  ///< false: a sequence may have motion alone
};

/// The layouts by kind: FaceDiffuser specification, section 10; FaceXHuBERT specification, section 4;
/// ProbTalk3D specification, sections 2.3 and 2.5.
const DatasetLayout& dataset_layout(DatasetKind kind);
/// All names, in the order of the enumeration.
std::span<const std::string_view> dataset_names();
std::optional<DatasetKind> parse_dataset_kind(std::string_view name);

/// What the name of a sequence says: "F2_e37" (biwi), "F1_41" (biwi_expressive),
/// "FaceTalk_170728_03272_TA_sentence07" (vocaset), "2_46" (multiface), "2_8_01" (beat: actor, emotion,
/// running index), "2_01" (uudamm), "M003_001_0_0" (3dmead: subject, sentence, emotion 0 ... 7, intensity
/// 0 ... 2).
struct SequenceName {
  std::string subject;
  int sentence = 0;
  int emotion = -1;    ///< of beat, 0 ... 7 and more, and 3dmead; -1: the name does not say
  int intensity = -1;  ///< of 3dmead, 0 ... 2
};
/// Nothing for a name that is none of the data set.
std::optional<SequenceName> parse_sequence_name(DatasetKind kind, std::string_view stem);

/// The split of a sequence by its name alone, or nothing: it belongs to none. For beat, whose split needs all
/// names, nothing.
std::optional<std::string_view> split_of(DatasetKind kind, const SequenceName& name);

/// The authors' emotion number of a BEAT recording from the fourth field of its name. The upper end of every
/// range counts as neutral, as in their script.
int beat_emotion(int field);

/// 1 ... n in the order of Python's random.Random(seed).shuffle(): UUDaMM's published split is cut from it.
std::vector<int> python_shuffle(int n, std::uint32_t seed);

}  // namespace mien

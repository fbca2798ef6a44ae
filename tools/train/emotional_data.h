#pragma once
#include <string>
#include <vector>

#include "config_fields.h"
#include "mien/console/console_exit.h"
#include "mien/datasets/dataset.h"
#include "mien/models/model_file.h"
#include "mien/train/face_sequence.h"
#include "mien/train/probtalk3d_losses.h"
#include "mien/train/sound_options.h"

namespace mien::train {

/// What a system wants of data with emotions and intensities.
struct EmotionalDataOptions {
  DatasetKind kind = DatasetKind::mead;  ///< of 3DMEAD's forms
  SoundOptions sound{};
  std::vector<std::string> subjects{};  ///< order of the style columns; empty: that of the data
  std::int64_t num_expression = 50;     ///< FLAME's expressions, of 3DMEAD's parameters
  bool needs_neutral = false;           ///< a face at rest: templates, or zero for ARKit's curves
  CorpusFields corpus{};
};

/// 3DMEAD, or a corpus folder with ARKit's curves in place of FLAME's parameters or vertices.
struct EmotionalData {
  FaceSequences sequences;  ///< in the range of the model, each with its style
  ModelOutput output;
  std::optional<ModelScaler> scaler;
  probtalk3d::JawChannels jaw;        ///< of parameters and curves
  std::vector<std::string> subjects;  ///< in the order of the style columns
  Templates templates;                ///< of meshes
  std::string description, licence;   ///< of the data, for the model file

  /// What a model file says of its output, its style and where it comes from.
  void describe(ModelFile& m) const;
};

/// Opens the folder: a corpus where there is a corpus.json, else 3DMEAD. Errors: of opening; nothing to learn
/// from (Errc::incompatible). Says how many sequences there are, and warns of motion without sound.
Result<EmotionalData> open_emotional_data(const std::filesystem::path& folder,
                                          const EmotionalDataOptions& options, ConsoleProgress& progress);

}  // namespace mien::train

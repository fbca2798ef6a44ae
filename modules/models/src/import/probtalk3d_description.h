#pragma once
#include "mien/models/import/import_model.h"
#include "system_weights.h"
#include "weights_source.h"

namespace mien {

bool is_probtalk3d(Architecture architecture);

/// Attention heads of ProbTalk3D's networks: what the options say, else the checkpoint's own, else the
/// published number, with a warning. 0 for other systems. Error (Errc::usage): --heads for another system.
Result<std::int64_t> probtalk3d_heads(const ImportOptions& options, const WeightsSource& weights,
                                      Architecture architecture);

/// Names of a style's columns, identities, emotions and intensities, as the checkpoint counts them, else as
/// published. Errors: those of subject_names(); (Errc::incompatible): too few columns.
Status name_style_columns(const ImportOptions& options, const WeightsSource& weights, std::int64_t num_styles,
                          ModelFile& model);

/// Completes the description of a motion prior or a whole ProbTalk3D: FLAME parameters, their range, names of
/// the style's columns. Errors (Errc::usage): options that do not apply; (Errc::incompatible): sizes that do
/// not fit.
Status describe_probtalk3d(const ImportOptions& options, const SystemFacts& facts,
                           const WeightsSource& weights, ModelFile& model);

}  // namespace mien

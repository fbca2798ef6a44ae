#pragma once
#include "face_config.h"
#include "mien/console/console_exit.h"
#include "probtalk3d_config.h"
#include "said_config.h"
#include "said_vae_config.h"
#include "training_config.h"

// What `mien train` runs. Each goes on from the checkpoints in its work folder.
namespace mien::train {

/// The default model in its stages.
Status train_default(const TrainingConfig& config, ConsoleProgress& progress);
/// Writes the default model as far as it is: averaged weights of the last checkpoints, start values where
/// there is none yet.
Status snapshot_default(const TrainingConfig& config, const std::filesystem::path& path,
                        ConsoleProgress& progress);

/// FaceXHuBERT or FaceDiffuser on a data set.
Status train_face(const FaceConfig& config, ConsoleProgress& progress);
/// Writes the model of the last checkpoint.
Status snapshot_face(const FaceConfig& config, const std::filesystem::path& path, ConsoleProgress& progress);

/// ProbTalk3D's stage 1 and stage 2, with codes or a Gaussian latent.
Status train_probtalk3d_prior(const ProbTalk3DPriorConfig& config, ConsoleProgress& progress);
Status train_probtalk3d(const ProbTalk3DConfig& config, ConsoleProgress& progress);
/// Write the model of the last checkpoint.
Status snapshot_probtalk3d_prior(const ProbTalk3DPriorConfig& config, const std::filesystem::path& path,
                                 ConsoleProgress& progress);
Status snapshot_probtalk3d(const ProbTalk3DConfig& config, const std::filesystem::path& path,
                           ConsoleProgress& progress);

/// SAiD's denoiser on coefficients and sound.
Status train_said(const SaidConfig& config, ConsoleProgress& progress);
/// Writes the averaged weights of the last checkpoint.
Status snapshot_said(const SaidConfig& config, const std::filesystem::path& path, ConsoleProgress& progress);

/// SAiD's motion codec on a folder of coefficients.
Status train_said_vae(const SaidVaeConfig& config, ConsoleProgress& progress);
/// Writes the codec of the last checkpoint.
Status snapshot_said_vae(const SaidVaeConfig& config, const std::filesystem::path& path,
                         ConsoleProgress& progress);

}  // namespace mien::train

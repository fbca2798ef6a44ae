#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/datasets/layout.h"

namespace mien {

struct PrepareOptions {
  /// biwi_expressive, multiface: unscaled templates (templates_orig.pkl); vocaset: its templates, empty for
  /// templates.pkl beside the recordings. See load_templates().
  std::filesystem::path templates{};
  std::filesystem::path mesh{};           ///< biwi: a mesh with the triangles of the frames (.obj, .ply)
  std::filesystem::path drop_vertices{};  ///< multiface: numbers of the vertices to leave out, a text file
  std::filesystem::path scaler{};         ///< uudamm: the published MinMaxScaler (.pkl); empty: measured
};

struct PrepareReport {
  std::int64_t num_sequences = 0, num_frames = 0;
};

/// Turns recordings as their makers deliver them into the layout of open_dataset(). `out` is made when
/// missing; files of the same names are replaced.
///
/// biwi_expressive (FaceXHuBERT specification, section 4) and biwi (FaceDiffuser specification,
/// section 10.1): every folder below `raw` that holds .vl frames is a sequence, named by its last two folders
/// (F1/e01 or F1/01) or by the last (F1_e01); frames are taken by their number. Sound is the file
/// <subject>_<sentence>_cut.wav or <subject>_<sentence>.wav anywhere below, or <sentence>_cut.wav in the
/// subject's folder. For biwi_expressive e01 ... becomes sentence 41 ..., meshes are scaled by the box of the
/// subject's template, and the scaled templates are written beside them; biwi keeps the emotional readings
/// alone and scales each frame by its area.
///
/// beat (FaceDiffuser specification, section 10.4): every <actor>_<name>_<0>_<e>_....json below `raw` with
/// its .wav is a recording; pieces of 600 of its frames at 60 a second become 300 at 30, with ten seconds of
/// sound each (mono, 16 kHz, 32-bit float: what every model hears), named <actor>_<emotion>_<running index>.
/// Recordings of an actor are taken in the order of their names.
///
/// vocaset (section 10.2): data_verts.npy, subj_seq_to_idx.pkl and raw_audio_fixed.pkl as released. All
/// frames are kept; loading takes every second one.
///
/// multiface (section 10.3): folders <subject>_<sentence> or <subject>/<sentence> with one mesh (.obj, .ply)
/// a frame, sentences by number, and <subject>_<sentence>.wav anywhere below. The vertices that are named are
/// left out, the others keep their order; every axis is scaled by the authors' constants. Sound: mean of the
/// channels, 20 dB louder, 16 kHz.
///
/// uudamm (section 10.5): <actor>_<recording>.npy [frames, 192] at 120 frames a second, exported from the
/// makers' scenes, with the .wav of the same name. Every fourth frame is kept, in pieces of 300 with ten
/// seconds of sound, scaled to -1 ... 1 by the published scaler, or by the ranges of these recordings, which
/// are then written as scaler.safetensors.
///
/// Warnings: recordings that were left out, and why. Errors: Errc::usage for an option that is missing, and
/// for 3DMEAD, whose makers' HDF5 files are not read;
/// Errc::input when nothing was found or a file is damaged; Errc::incompatible when meshes, templates,
/// triangles and tables do not fit; Errc::cancelled.
Result<PrepareReport> prepare_dataset(DatasetKind kind, const std::filesystem::path& raw,
                                      const std::filesystem::path& out, const PrepareOptions& options,
                                      Progress& progress);

}  // namespace mien

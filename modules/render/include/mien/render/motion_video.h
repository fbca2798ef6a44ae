#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/render/image.h"
#include "mien/render/motion_picture.h"

namespace mien {

struct FilmOptions {
  double fps = 30;      ///< frames a second, 1 to 240; frame n shows the instant n / fps
  int num_threads = 1;  ///< frames are drawn in parallel; the file is the same for any number
};

/// Writes the whole motion as .mp4 or .webm. A few pictures per thread are in memory at a time.
///
/// @param sound  the speech, heard from time zero and cut where the pictures end; nullptr: a silent film
/// Errors: as VideoWriter; Errc::failed for a motion without frames; Errc::cancelled. Nothing is left behind
/// then.
Status write_motion_video(const std::filesystem::path& path, const MotionPicture& picture,
                          const AudioClip* sound, const FilmOptions& options, Progress& progress);

/// Writes frame_000000.png, frame_000001.png ... into a folder, which is made when missing.
/// Warns about later frames of an earlier film that are still in the folder.
/// Errors: Errc::usage, Errc::failed, Errc::cancelled; the frames that are complete stay.
Status write_motion_frames(const std::filesystem::path& folder, const MotionPicture& picture,
                           const FilmOptions& options, Progress& progress);

/// A cell of a contact sheet.
struct SheetCell {
  double seconds = 0;
  std::string label;  ///< empty: the time
};

/// Pictures at the given instants in rows of `columns`, each with its label in the upper right corner. @pre
/// columns > 0 Errors (Errc::usage): no cell, or a sheet of more than 16384 pixels on a side.
Result<Image> contact_sheet(const MotionPicture& picture, std::span<const SheetCell> cells, int columns,
                            int num_threads = 1);

/// Pictures in rows of `columns`, on white with a gap of `gap` pixels; cells are as large as the largest
/// picture.
/// @pre columns > 0, gap >= 0
Image make_grid(std::span<const Image> pictures, int columns, int gap = 2);

}  // namespace mien

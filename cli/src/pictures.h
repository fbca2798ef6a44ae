#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/audio_clip.h"
#include "mien/core/character.h"
#include "mien/core/motion.h"
#include "outputs.h"

namespace mien {

/// How a motion is shown.
struct PictureOptions {
  int width = 512, height = 512;  ///< pixels of a video's frame
  double fps = 30;                ///< of videos and numbered pictures
  std::string view = "portrait";
  std::vector<double> times = {};  ///< instants of a sheet; empty: twelve of one motion, six of several
  int columns = 4;                 ///< of a contact sheet, and of faces side by side
  int threads = 1;
  std::vector<std::string> labels = {};  ///< of motions side by side, one for each; or none
};

/// "512" or "640x480". Errors (Errc::usage).
Result<std::pair<int, int>> parse_size(const std::string& text);
/// Errors (Errc::usage): not the name of a view.
Status check_view(const std::string& name);
/// "0.5,1.25": seconds. Errors (Errc::usage).
Result<std::vector<double>> parse_times(const std::string& text);

/// Draws motions on a character, side by side in rows of so many columns, into a video (with the sound when
/// there is one) or numbered pictures; into a sheet one motion at all instants (contact_sheet()), several at
/// one instant side by side, several at several with a row for each (motion_sheet()). @pre
/// output.is_picture(); at least one motion; sound may be null
Status write_pictures(const Output& output, const std::vector<const Motion*>& motions,
                      const Character& character, const AudioClip* sound, const PictureOptions& options,
                      Progress& progress);
Status write_pictures(const Output& output, const Motion& motion, const Character& character,
                      const AudioClip* sound, const PictureOptions& options, Progress& progress);

}  // namespace mien

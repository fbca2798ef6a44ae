#pragma once
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/features.h"
#include "mien/core/motion.h"
#include "mien/face/pose.h"
#include "mien/render/camera.h"
#include "mien/render/curve_strip.h"
#include "mien/render/image.h"
#include "mien/render/rasteriser.h"

namespace mien {

struct MotionPictureOptions {
  RenderOptions shading;            ///< of one face: its size in pixels, supersampling ...
  CameraView view = CameraView::portrait;       ///< the close-up of the mouth stays with the head: its turns are left out
  int columns = 0;                  ///< faces in a row; 0: all of them
  std::vector<std::string> labels;  ///< one for each motion, or none
  int strip_height = 0;             ///< pixels of a strip of curves under each face; 0: none
  CurveStripOptions strip;          ///< its channels and length; where it stands follows the time
  const Features* log_mel = nullptr;  ///< of the speech, for a spectrogram in the strip; borrowed
};

/// A character that performs one motion, or several side by side (truth | model), in rows of so many columns,
/// at any instant.
class MotionPicture {
 public:
  /// @param character, motions  borrowed: must outlive this object
  /// Errors: Errc::usage for options outside of their range; Errc::incompatible for a motion that is neither
  /// named coefficients nor the positions of as many vertices as the character's parts have together, or one of
  /// which no channel moves the character. A motion of coefficients without frames shows the face at rest, one of
  /// vertices is an error (Errc::input). Warnings name the channels that move nothing.
  static Result<MotionPicture> create(const Character& character, std::vector<const Motion*> motions,
                                      const MotionPictureOptions& options);

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// Of the longest motion.
  [[nodiscard]] double seconds() const;
  /// The picture at an instant: coefficients between two frames are interpolated, the first and the last
  /// frame hold before and after. Safe from many threads.
  /// @param num_threads  for this one picture
  [[nodiscard]] Image at(double seconds, int num_threads = 1) const;

 private:
  struct Scratch {
    RenderScratch render;
    PosedCharacter posed;
  };
  struct Performer {
    const Motion* motion;
    std::string label;
    Poser poser;
  };
  MotionPicture(const Character& character, const MotionPictureOptions& options, Camera camera)
      : character_(&character), options_(options), camera_(camera), pool_(std::make_unique<Pool>()) {}

  [[nodiscard]] Scratch take_scratch() const;
  [[nodiscard]] int num_columns() const;
  [[nodiscard]] int num_rows() const;

  const Character* character_;
  MotionPictureOptions options_;
  Camera camera_;
  std::vector<Performer> performers_;
  // Scratch memory of finished pictures, for the next ones: as many as pictures were drawn at the same time.
  struct Pool {
    std::mutex mutex;
    std::vector<Scratch> idle;
  };
  std::unique_ptr<Pool> pool_;
};

}  // namespace mien

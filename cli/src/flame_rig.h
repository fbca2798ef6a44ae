#pragma once
#include <filesystem>
#include <string>

#include "fit_input.h"
#include "mien/base/progress.h"
#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/flame_model.h"
#include "mien/core/mesh.h"
#include "mien/core/motion.h"
#include "mien/face/flame_fit.h"
#include "mien/fit/coefficient_fit.h"

namespace mien {

/// How parameters of FLAME and coefficients of a rig are turned into each other.
struct FlameRigOptions {
  std::string shapes = {};       ///< see fit_rig(); empty: all but those of the gaze and the tongue, which
                                 ///< expression and jaw do not move
  std::string vertices = {};     ///< file of the vertices that count; empty: all
  double max_change = 0.1;       ///< of a coefficient from frame to frame
  std::int64_t expressions = 0;  ///< of FLAME; 0: ProbTalk3D's 50, or as many as the model has
  int threads = 1;
};

/// A FLAME model beside a face of its topology that has ARKit shapes. The two may be different faces: what
/// goes from one to the other is the movement away from the face at rest (carry_movement()).
class FlameRig {
 public:
  /// @param path  of the character, for messages
  /// Errors: Errc::incompatible for another number of vertices; those of fit_rig().
  static Result<FlameRig> create(FlameModel model, Character character, const std::filesystem::path& path,
                                 const FlameRigOptions& options);

  /// Coefficients for FLAME's expression and jaw; its shape is left out, for the rig has a face of its own.
  /// The vertices that FLAME moves, by SAiD's problem (fit_coefficients()). Errors: those of
  /// flame_vertices() and fit_coefficients(). @param fps  of the result; 0: that of the motion
  Result<FitResult> curves(const Motion& parameters, double fps, Progress& progress) const;

  /// FLAME's expression and jaw for coefficients of the rig, or for a motion of its vertices in metres
  /// (fit_flame()). The head's turns are left out. Errors: those of vertex_sequence() and fit_flame().
  Result<FlameFitResult> parameters(const Motion& motion, double fps, Progress& progress) const;

  [[nodiscard]] const Character& character() const { return character_; }

 private:
  FlameModel model_;
  Character character_;
  Mesh face_;  // of all parts
  FitRig rig_;
  FlameRigOptions options_;
};

}  // namespace mien

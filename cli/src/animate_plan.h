#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "director.h"
#include "face_director.h"
#include "flame_outputs.h"
#include "flame_rig.h"
#include "mien/base/bytes.h"
#include "mien/base/parallel.h"
#include "mien/console/console_progress.h"
#include "mien/core/character.h"
#include "mien/core/flame_model.h"
#include "mien/core/mesh.h"
#include "mien/models/model_file.h"
#include "outputs.h"
#include "pictures.h"
#include "said_director.h"
#include "vertex_options.h"

namespace mien {

/// The words of `mien animate`.
struct AnimateArguments {
  std::vector<std::string> speech;
  std::string model, character, flame, flame_rig;
  std::vector<std::string> outputs;
  DirectionWords words;
  FaceWords face;
  SaidWords said;
  VertexOptions vertices;
  int takes = 1;
  double fps = 0;  ///< 0: 60 for motion, 30 for pictures
  std::string size = "512", view = "portrait", times;
  int columns = 4;
  std::string
      emotions;  ///< to show together: "all", "all:3", or a list apart by commas; empty: --emotion alone
  bool allow_silence = false;
  int threads = hardware_threads();
};

/// A recording and what is made of it.
struct ClipPlan {
  std::filesystem::path speech;
  std::vector<Output> outputs;  ///< of all takes, take by take

  [[nodiscard]] std::string audio_name() const { return speech.filename().string(); }
  /// The outputs of one take of `num_takes`.
  [[nodiscard]] std::span<const Output> of_take(int take, int num_takes) const;
};

/// What the words mean, with everything loaded that the outputs need beside the motion.
struct AnimatePlan {
  std::vector<ClipPlan> clips;
  std::vector<std::filesystem::path> folders;  ///< to make before the work
  /// Which model performs: the default one, one that FaceModel runs, or SAiD.
  enum class System { standard, face, said } system = System::standard;
  PerformOptions options;
  FaceOptions face;
  SaidOptions said;
  std::filesystem::path model_path, character_path;
  Bytes character_glb;                 ///< when a .glb is written
  std::optional<Character> character;  ///< when pictures are drawn
  std::optional<Mesh> mesh;            ///< of a model that moves vertices, which needs no character
  VertexOptions vertices;              ///< of that mesh
  FlameFace flame_face = FlameFace::none;
  std::optional<Mesh> other_face;         ///< moves in place of that mesh
  std::optional<FlameModel> flame;        ///< makes the vertices, of the parameters that the model gives
  std::optional<FlameRig> flame_rig;      ///< makes coefficients of them
  std::int64_t num_flame_parameters = 0;  ///< of a model that gives them where nothing makes a face of them
  PictureOptions pictures;

  [[nodiscard]] std::vector<Output> all_outputs() const;
};

/// Which model performs, and what the words tell it: `system`, `model_path`, and `options`, `face` or `said`.
/// @return what the file says of a model that is named; nothing for the default one. Warnings: of words.
/// Errors: Errc::usage; those of reading the model's description.
Result<ModelFile> plan_performer(const AnimateArguments& arguments, AnimatePlan& plan);

/// Everything that can be wrong with the words is found out here, before the work begins. In an output,
/// {name} stands for the recording's file name without extension; for several recordings it must be there, or
/// the output be a folder, which gets NAME.glb (.npy for models that move vertices or FLAME parameters).
/// Errors: Errc::usage; those of reading the model's description.
Result<AnimatePlan> plan_animation(const AnimateArguments& arguments);

/// The words of --emotions, one by one; none where it is not used. "all" stands for those of the model,
/// "all:3" for the same with a level (but neutral). Errors (Errc::usage): what does not go with it
/// (--emotion, several recordings or takes, outputs that are no pictures); a model without emotions, an
/// emotion that it lacks.
Result<std::vector<std::string>> planned_emotions(const AnimateArguments& arguments, const AnimatePlan& plan);
/// The plan with another emotion than that of the arguments. Errors: those of plan_animation() for the word.
Status plan_emotion(const AnimateArguments& arguments, const std::string& emotion, AnimatePlan& plan);

/// Loads characters, makes folders and tries all places that will be written. Errors (Errc::failed): a place
/// that cannot be written; those of load_character().
Status prepare_outputs(AnimatePlan& plan, ConsoleProgress& progress);

}  // namespace mien

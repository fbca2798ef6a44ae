#include "flame_rig.h"

#include <algorithm>

#include "mien/core/arkit.h"
#include "mien/core/flame_parameters.h"
#include "mien/face/carried_movement.h"
#include "mien/face/flame.h"
#include "mien/face/vertex_sequence.h"
#include "mien/io/mesh_file.h"

namespace mien {
namespace {

constexpr std::int64_t kProbTalk3dExpressions = 50;

// Names apart by commas.
std::string shapes_of_flame(const Character& character) {
  std::string names;
  for (const Blendshape& shape : merged_shapes(character))
    if (!shape.name.starts_with("eyeLook") && shape.name != "tongueOut")
      names += (names.empty() ? "" : ",") + shape.name;
  return names;
}

Motion without_shape(Motion parameters) {
  const auto columns = flame_columns(parameters);
  for (std::int64_t n = 0; n < parameters.num_frames(); ++n) {
    const auto frame = parameters.frame(n);
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (columns[c] && *columns[c] < kNumFlameShape) frame[c] = 0;
  }
  return parameters;
}

Motion without_head(Motion motion) {
  for (const auto name : head_names())
    if (const auto channel = motion.find(name))
      for (std::int64_t n = 0; n < motion.num_frames(); ++n)
        motion.frame(n)[static_cast<std::size_t>(*channel)] = 0;
  return motion;
}

std::vector<float> flattened(const std::vector<Vec3>& positions) {
  std::vector<float> values;
  for (const Vec3& p : positions) values.insert(values.end(), {p.x, p.y, p.z});
  return values;
}

Motion at_rate(Motion motion, double fps) {
  return fps > 0 && fps != motion.fps ? resample(motion, fps) : std::move(motion);
}

}  // namespace

Result<FlameRig> FlameRig::create(FlameModel model, Character character, const std::filesystem::path& path,
                                  const FlameRigOptions& options) {
  FlameRig all;
  all.face_ = merged_mesh(character);
  if (static_cast<std::int64_t>(all.face_.positions.size()) != model.num_vertices)
    return Error{Errc::incompatible, "'" + path.string() + "'",
                 "has " + std::to_string(all.face_.positions.size()) + " vertices, the FLAME model " +
                     std::to_string(model.num_vertices),
                 "Coefficients come from FLAME on a face of its topology. Make one: mien transfer "
                 "generic_model.pkl --target-landmarks FLAME_landmarks.txt -o flame_rig.glb"};
  const std::string shapes = options.shapes.empty() ? shapes_of_flame(character) : options.shapes;
  MIEN_TRY(all.rig_, fit_rig(character, shapes, options.vertices, model.num_vertices));
  all.model_ = std::move(model);
  all.character_ = std::move(character);
  all.options_ = options;
  return all;
}

Result<FitResult> FlameRig::curves(const Motion& parameters, double fps, Progress& progress) const {
  MIEN_TRY(Motion vertices, flame_vertices(FlamePoser(model_), without_shape(parameters), options_.threads));
  MIEN_TRY(Motion carried, carry_movement(std::move(vertices), model_.neutral, face_));
  return fit_coefficients(rig_.neutral, rig_.shapes, at_rate(taken_vertices(rig_, std::move(carried)), fps),
                          rig_.regions, {.max_change = options_.max_change, .num_threads = options_.threads},
                          progress);
}

Result<FlameFitResult> FlameRig::parameters(const Motion& motion, double fps, Progress& progress) const {
  Motion moved = motion;
  if (motion.space != MotionSpace::vertices) {
    MIEN_TRY(moved, vertex_sequence(character_, without_head(motion), options_.threads));
  }
  MIEN_TRY(const Motion carried,
           carry_movement(at_rate(std::move(moved), fps), flattened(face_.positions), flame_mesh(model_)));
  const auto given = model_.num_shapes - static_cast<std::int64_t>(kNumFlameShape);
  FitRegions regions = character_.regions;
  regions.erase("landmarks68");
  return fit_flame(model_, carried, rig_.taken, regions,
                   {.num_expressions = options_.expressions > 0 ? options_.expressions
                                                                : std::min(given, kProbTalk3dExpressions),
                    .num_threads = options_.threads},
                   progress);
}

}  // namespace mien

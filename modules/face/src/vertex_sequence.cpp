#include "mien/face/vertex_sequence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"

namespace mien {
namespace {

std::size_t num_vertices(const Character& character) {
  std::size_t count = 0;
  for (const auto& part : character.parts) count += part.mesh.positions.size();
  return count;
}

}  // namespace

Result<Motion> vertex_sequence(const Character& character, const Motion& motion, int num_threads) {
  if (motion.space != MotionSpace::arkit && motion.space != MotionSpace::rig)
    return Error{Errc::incompatible, "motion", "has no named coefficients that could move a character", ""};
  const Poser poser(character, motion.channels);
  if (!motion.channels.empty() && poser.unused_channels().size() == motion.channels.size())
    return Error{Errc::incompatible, "motion", "none of its channels is a shape of the character", ""};
  const std::size_t total = num_vertices(character);
  if (total == 0)
    return Error{Errc::incompatible, "character '" + character.name + "'", "has no vertices", ""};
  Motion out = vertex_motion({character.name, static_cast<std::int64_t>(total)}, motion.fps);
  const std::int64_t num_frames = motion.num_frames();
  out.values.resize(static_cast<std::size_t>(num_frames) * 3 * total);
  constexpr std::int64_t kBlock = 16;  // frames that share one pose's memory
  parallel_for(num_threads, (num_frames + kBlock - 1) / kBlock, [&](std::int64_t block) {
    PosedCharacter posed;
    for (std::int64_t n = block * kBlock; n < std::min(num_frames, (block + 1) * kBlock); ++n) {
      poser.pose(motion.frame(n), posed);
      const auto frame = out.frame(n);
      std::size_t i = 0;
      for (const auto& part : posed)
        for (const Vec3& p : part.positions) frame[i++] = p.x, frame[i++] = p.y, frame[i++] = p.z;
    }
  });
  return out;
}

void pose_vertices(const Character& character, std::span<const float> frame, PosedCharacter& out) {
  contract(frame.size() == 3 * num_vertices(character), "pose_vertices: three numbers per vertex expected");
  out.resize(character.parts.size());
  std::size_t i = 0;
  for (std::size_t p = 0; p < out.size(); ++p) {
    const Mesh& mesh = character.parts[p].mesh;
    out[p].positions.resize(mesh.positions.size());
    for (Vec3& v : out[p].positions) v = {frame[i], frame[i + 1], frame[i + 2]}, i += 3;
    out[p].normals = vertex_normals(out[p].positions, mesh.triangles);
  }
}

LengthScale length_scale(const Motion& motion, double mm_per_unit) {
  contract(motion.space == MotionSpace::vertices, "length_scale: a motion of vertices expected");
  if (mm_per_unit > 0) return {mm_per_unit, "as given"};
  const auto known = known_topology(motion.topology.num_vertices);
  if (known && known->mm_per_unit > 0)
    return {known->mm_per_unit, "the data set is in " + std::string(known->units)};
  float extent = 0;
  if (motion.num_frames() > 0) {
    const auto frame = motion.frame(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float low = frame[axis], high = frame[axis];
      for (std::size_t i = axis; i < frame.size(); i += 3)
        low = std::min(low, frame[i]), high = std::max(high, frame[i]);
      extent = std::max(extent, high - low);
    }
  }
  if (!(extent > 0) || !std::isfinite(extent)) return {1, "the mesh has no extent"};
  return {kHeadExtentMm / static_cast<double>(extent),
          "the mesh's largest extent counts as " + fixed(kHeadExtentMm, 0) + " mm"};
}

Result<VertexStage> stage_vertices(const Motion& motion, const Mesh& mesh, const LengthScale& scale,
                                   DataAxes axes) {
  contract(motion.space == MotionSpace::vertices, "stage_vertices: a motion of vertices expected");
  const auto count = static_cast<std::size_t>(motion.topology.num_vertices);
  if (mesh.positions.size() != count)
    return Error{Errc::incompatible, "mesh",
                 "has " + std::to_string(mesh.positions.size()) + " vertices, the motion moves " +
                     std::to_string(count),
                 "Pass the template mesh of the data set that the motion belongs to"};
  if (motion.num_frames() == 0) return Error{Errc::input, "motion", "has no frames", ""};
  VertexStage stage{{motion.topology.name, {}, {}}, motion};
  const auto metres = static_cast<float>(scale.mm_per_unit / 1000);
  const float turned = axes == DataAxes::inverted ? -metres : metres;
  for (std::size_t i = 0; i < stage.motion.values.size(); ++i)
    stage.motion.values[i] *= i % 3 == 0 ? metres : turned;
  CharacterPart skin{"skin", mesh, {}};
  skin.mesh.normals.clear();
  copy_positions(stage.motion, 0, skin.mesh.positions);
  stage.character.parts.push_back(std::move(skin));
  return stage;
}

}  // namespace mien

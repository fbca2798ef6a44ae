#include "vertex_outputs.h"

#include "character_source.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/face/carried_movement.h"
#include "mien/face/vertex_basis.h"
#include "mien/io/gltf_animation.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "mien/io/vl.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct Compressed {
  VertexBasis basis;
  LengthScale scale;
};

std::string extras_of(const Motion& motion, const Compressed& c) {
  return "{\"mien_vertices\":{\"topology\":" + json_string(motion.topology.name) +
         ",\"vertices\":" + std::to_string(motion.topology.num_vertices) +
         ",\"frames\":" + std::to_string(motion.num_frames()) + ",\"fps\":" + fixed(motion.fps, 6) +
         ",\"shapes\":" + std::to_string(c.basis.shapes.size()) +
         ",\"max_error_mm\":" + fixed(c.basis.max_error * 1000, 6) +
         ",\"rms_error_mm\":" + fixed(c.basis.rms_error * 1000, 6) +
         ",\"mm_per_unit\":" + fixed(c.scale.mm_per_unit, 6) +
         ",\"mm_because\":" + json_string(c.scale.reason) + "}}";
}

void tell_error(const fs::path& path, const Motion& motion, const Compressed& c, ConsoleProgress& progress) {
  const std::string most = fixed(c.basis.max_error * 1000, 4), rms = fixed(c.basis.rms_error * 1000, 4);
  progress.say(path.string() + ": " + std::to_string(motion.num_frames()) + " frames of " +
               std::to_string(motion.topology.num_vertices) + " vertices in " +
               std::to_string(c.basis.shapes.size()) + " shapes; no vertex is farther than " + most +
               " mm from its place (rms " + rms + " mm; 1 unit = " + fixed(c.scale.mm_per_unit, 3) +
               " mm: " + c.scale.reason + ")");
  progress.event("compressed", "\"output\":" + json_string(path.string()) +
                                   ",\"shapes\":" + std::to_string(c.basis.shapes.size()) +
                                   ",\"max_error_mm\":" + most + ",\"rms_error_mm\":" + rms +
                                   ",\"mm_per_unit\":" + fixed(c.scale.mm_per_unit, 6) +
                                   ",\"mm_because\":" + json_string(c.scale.reason));
}

Status write_blendshapes(const fs::path& path, VertexStage stage, const LengthScale& scale,
                         const VertexOptions& options, const VertexShow& show, ConsoleProgress& progress) {
  auto basis = vertex_basis(
      stage.motion,
      {.max_error = options.max_error_mm / 1000, .max_shapes = 512, .num_threads = show.pictures.threads},
      progress);
  if (!basis) return basis.error();
  for (const auto& warning : basis.warnings) progress.warn(path.string() + ": " + warning);
  const Compressed compressed{std::move(*basis), scale};
  CharacterPart& part = stage.character.parts.front();
  part.mesh.positions = compressed.basis.neutral;
  part.shapes = compressed.basis.shapes;
  MIEN_TRY(const Bytes still, write_glb(stage.character, {.normals = !part.mesh.triangles.empty(),
                                                          .pivot = {},
                                                          .extras = extras_of(stage.motion, compressed)}));
  const auto glb = animate_glb(still, compressed.basis.coefficients, show.audio_name);
  if (!glb) return glb.error();
  MIEN_TRY([[maybe_unused]] const auto written, write_file(path, std::span<const std::byte>(*glb)));
  tell_error(path, stage.motion, compressed, progress);
  return Done{};
}

std::string frame_name(std::int64_t n, const std::string& extension) {
  const std::string number = std::to_string(n);
  return "frame_" + std::string(number.size() < 6 ? 6 - number.size() : 0, '0') + number + extension;
}

// One file per frame, in the units of the motion.
Status write_mesh_frames(const fs::path& folder, const Motion& motion, const Mesh& mesh, Progress& progress) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec) return Error{Errc::failed, "'" + folder.string() + "'", "cannot be made: " + ec.message(), ""};
  const bool is_vl = folder.extension() == ".vl";
  Mesh frame{.positions = std::vector<Vec3>(static_cast<std::size_t>(motion.topology.num_vertices)),
             .triangles = mesh.triangles,
             .normals = {},
             .colors = {}};
  progress.stage("meshes", motion.num_frames());
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    copy_positions(motion, n, frame.positions);
    const fs::path path = folder / frame_name(n, is_vl ? ".vl" : ".obj");
    const Status written = is_vl ? write_file(path, std::span<const std::byte>(write_vl(frame.positions)))
                                 : write_file(path, std::string_view(write_obj(frame)));
    if (!written) return written.error();
    progress.update(n + 1);
  }
  return Done{};
}

}  // namespace

Result<Mesh> vertex_mesh(const VertexOptions& options, const Motion& motion) {
  const auto count = static_cast<std::size_t>(motion.topology.num_vertices);
  if (!options.mesh.empty()) {
    auto mesh = load_mesh(options.mesh);
    if (mesh && mesh->positions.size() != count)
      return Error{Errc::incompatible, "--mesh '" + options.mesh + "'",
                   "has " + std::to_string(mesh->positions.size()) + " vertices, the motion moves " +
                       std::to_string(count),
                   "Pass the template mesh of the data set that the motion belongs to"};
    return mesh;
  }
  if (const auto head = character_path("")) {
    auto mesh = load_mesh(*head);
    if (mesh && mesh->positions.size() == count) return mesh;
  }
  Mesh points;
  points.positions.resize(count);
  Result<Mesh> result(std::move(points));
  result.warnings.emplace_back("no triangles are known for " + std::to_string(count) +
                               " vertices: they are points. Pass --mesh FILE with the data set's template");
  return result;
}

Result<std::optional<Mesh>> other_face(const VertexOptions& options, const Mesh& rest) {
  if (options.face.empty()) return std::optional<Mesh>();
  if (rest.triangles.empty())
    return Error{Errc::usage, "--face", "needs the neutral face that the motion moves away from",
                 "Pass --mesh FILE with the template of the data set"};
  MIEN_TRY(Mesh face, load_mesh(options.face));
  if (face.positions.size() != rest.positions.size())
    return Error{
        Errc::incompatible, "--face '" + options.face + "'",
        "has " + std::to_string(face.positions.size()) + " vertices, the motion moves " +
            std::to_string(rest.positions.size()),
        "Pass a face of the same topology; another one moves by its shapes: mien fit, mien transfer"};
  if (options.face_z_up) turn_z_up(face);
  return std::optional<Mesh>(std::move(face));
}

Result<Motion> on_other_face(Motion motion, const Mesh& rest, const std::optional<Mesh>& face) {
  if (!face) return motion;
  std::vector<float> neutral;
  for (const Vec3& p : rest.positions) neutral.insert(neutral.end(), {p.x, p.y, p.z});
  return carry_movement(std::move(motion), neutral, *face);
}

Result<std::vector<VertexStage>> staged(const Output& output, const std::vector<Motion>& motions,
                                        const Mesh& mesh, const VertexOptions& options) {
  if (mesh.triangles.empty())
    return Error{Errc::usage, "output '" + output.path.string() + "'", "a picture needs triangles",
                 "Pass --mesh FILE with the template of the data set (.obj or .ply)"};
  std::vector<VertexStage> stages;
  const LengthScale scale = length_scale(motions.front(), options.mm_per_unit);
  for (const Motion& motion : motions) {
    MIEN_TRY(stages.emplace_back(),
             stage_vertices(motion, mesh, scale, options.inverted ? DataAxes::inverted : DataAxes::upright));
  }
  return stages;
}

Status write_vertex_pictures(const Output& output, const std::vector<Motion>& motions, const Mesh& mesh,
                             const VertexOptions& options, const AudioClip* sound,
                             const PictureOptions& pictures, Progress& progress) {
  MIEN_TRY(const auto stages, staged(output, motions, mesh, options));
  std::vector<const Motion*> shown;
  for (const VertexStage& stage : stages) shown.push_back(&stage.motion);
  return write_pictures(output, shown, stages.front().character, sound, pictures, progress);
}

Status write_vertex_output(const Output& output, const Motion& motion, const Mesh& mesh,
                           const VertexOptions& options, const VertexShow& show, ConsoleProgress& progress) {
  if (output.kind == OutputKind::meshes) return write_mesh_frames(output.path, motion, mesh, progress);
  if (output.kind == OutputKind::motion && !output.is_glb())
    return write_motion(output.path, motion, {.character_glb = {}, .audio_name = show.audio_name, .glb = {}});
  if (output.is_picture())
    return write_vertex_pictures(output, {motion}, mesh, options, show.sound, show.pictures, progress);
  const LengthScale scale = length_scale(motion, options.mm_per_unit);
  MIEN_TRY(VertexStage stage,
           stage_vertices(motion, mesh, scale, options.inverted ? DataAxes::inverted : DataAxes::upright));
  return write_blendshapes(output.path, std::move(stage), scale, options, show, progress);
}

}  // namespace mien

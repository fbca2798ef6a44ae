// mien render: a motion file on a face, as a film, pictures or meshes.
#include <algorithm>
#include <chrono>

#include "character_source.h"
#include "flame_outputs.h"
#include "heat_map.h"
#include "mien/audio/load_audio.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/face/flame.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "options.h"
#include "pictures.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

struct RenderArguments {
  std::vector<std::string> motions;
  std::string character, audio, output, size, view = "portrait", times, heat_map, flame;
  VertexOptions vertices;
  double fps = 30, motion_fps = 0;
  int columns = 4;
  int threads = hardware_threads();
};

// What is drawn or written, all found out before the work.
struct Job {
  const RenderArguments& a;
  Output output;
  std::filesystem::path character_path;
  std::vector<Motion> motions;  // all of coefficients, or all of vertices
  std::optional<AudioClip> sound;
  PictureOptions pictures;
  std::optional<HeatStatistic> heat;
  VertexOptions vertices;
  std::optional<Mesh> flame_mesh;  // of motions that were FLAME parameters
};

Status check_together(const RenderArguments& a, const Output& output, std::span<const Motion> motions) {
  for (std::size_t i = 1; i < motions.size(); ++i) {
    const Motion &first = motions[0], &other = motions[i];
    if ((first.space == MotionSpace::vertices) != (other.space == MotionSpace::vertices) ||
        first.topology.num_vertices != other.topology.num_vertices)
      return Error{Errc::incompatible, "'" + a.motions[i] + "'",
                   "moves other things than '" + a.motions[0] + "'",
                   "Side by side go motions of coefficients, or motions of the same vertices"};
  }
  if (motions.size() > 1 && !output.is_picture())
    return Error{Errc::usage, "output '" + output.path.string() + "'",
                 "holds one motion; " + std::to_string(motions.size()) + " were given",
                 "Write a video or pictures, or one motion at a time"};
  return Done{};
}

Status draw_vertices(const Job& job, const std::vector<Motion>& motions, const Mesh& mesh,
                     ConsoleProgress& progress) {
  if (!job.heat)
    return write_vertex_pictures(job.output, motions, mesh, job.vertices, job.sound ? &*job.sound : nullptr,
                                 job.pictures, progress);
  MIEN_TRY(const auto stages, staged(job.output, motions, mesh, job.vertices));
  return write_heat_map(job.output.path, stages, job.pictures.labels, *job.heat, job.pictures);
}

Status render_vertices(Job& job, ConsoleProgress& progress) {
  const auto mesh =
      job.flame_mesh ? Result<Mesh>(*job.flame_mesh) : vertex_mesh(job.vertices, job.motions.front());
  if (!mesh) return mesh.error();
  MIEN_TRY(const auto face, other_face(job.vertices, *mesh));
  for (Motion& motion : job.motions) {
    MIEN_TRY(motion, on_other_face(std::move(motion), *mesh, face));
  }
  const bool needs_triangles = job.output.kind != OutputKind::motion || job.output.is_glb();
  if (needs_triangles)
    for (const auto& warning : mesh.warnings) progress.warn(warning);
  if (job.output.is_picture()) return draw_vertices(job, job.motions, *mesh, progress);
  return write_vertex_output(job.output, job.motions.front(), *mesh, job.vertices,
                             {job.pictures, nullptr, ""}, progress);
}

// Coefficients move a character: into pictures, its .glb, or the positions of its vertices.
Status render_curves(const Job& job, ConsoleProgress& progress) {
  const Motion& first = job.motions.front();
  if (!job.vertices.face.empty())
    return Error{Errc::usage, "--face", "is for motions of vertices and of FLAME parameters",
                 "Coefficients move any face with such shapes: --character FACE"};
  if (job.output.is_glb()) {
    MIEN_TRY(const Bytes glb, character_glb(job.character_path));
    return write_motion(job.output.path, first, {.character_glb = glb, .audio_name = "", .glb = {}});
  }
  auto character = load_character(job.character_path);
  if (!character) return character.error();
  for (const auto& warning : character.warnings) progress.warn(warning);
  if (job.output.is_picture() && !job.heat) {
    std::vector<const Motion*> shown;
    for (const Motion& motion : job.motions) shown.push_back(&motion);
    return write_pictures(job.output, shown, *character, job.sound ? &*job.sound : nullptr, job.pictures,
                          progress);
  }
  std::vector<Motion> vertices;
  for (const Motion& motion : job.motions) {
    MIEN_TRY(vertices.emplace_back(), vertex_sequence(*character, motion, job.a.threads));
  }
  if (job.heat) return draw_vertices(job, vertices, merged_mesh(*character), progress);
  return write_vertex_output(job.output, vertices.front(), merged_mesh(*character), job.vertices,
                             {job.pictures, nullptr, ""}, progress);
}

Result<Job> plan(const RenderArguments& a) {
  Job job{.a = a,
          .output = {},
          .character_path = {},
          .motions = {},
          .sound = {},
          .pictures = {.fps = a.fps, .view = a.view, .columns = a.columns, .threads = a.threads},
          .heat = {},
          .vertices = a.vertices,
          .flame_mesh = {}};
  MIEN_TRY([[maybe_unused]] const auto view, check_view(a.view));
  if (!a.times.empty()) {
    MIEN_TRY(job.pictures.times, parse_times(a.times));
  }
  MIEN_TRY(job.character_path, character_path(a.character));
  constexpr OutputKind kKinds[] = {OutputKind::video, OutputKind::sheet, OutputKind::frames,
                                   OutputKind::motion, OutputKind::meshes};
  std::vector<std::filesystem::path> inputs = {a.audio, job.character_path, a.vertices.mesh, a.vertices.face,
                                               a.flame};
  inputs.insert(inputs.end(), a.motions.begin(), a.motions.end());
  MIEN_TRY(const auto outputs, plan_outputs({&a.output, 1}, inputs, kKinds));
  job.output = outputs.front();
  const bool is_sheet = job.output.kind == OutputKind::sheet;
  if (!a.heat_map.empty()) {
    MIEN_TRY(job.heat, parse_heat_statistic(a.heat_map));
    if (!is_sheet)
      return Error{Errc::usage, "--heatmap", "is a picture: '" + a.output + "' is none", "Write a .png"};
    if (!a.times.empty())
      return Error{Errc::usage, "--times", "a heat map is of the whole motion", "Leave it out"};
  }
  MIEN_TRY(const auto size, parse_size(!a.size.empty() ? a.size : is_sheet && !job.heat ? "256" : "512"));
  job.pictures.width = size.first, job.pictures.height = size.second;
  if (a.motions.size() > 1)
    for (const auto& motion : a.motions)
      job.pictures.labels.push_back(std::filesystem::path(motion).stem().string());
  if (!a.audio.empty() && job.output.kind != OutputKind::video)
    return Error{Errc::usage, "--audio", "only videos have sound: '" + a.output + "' is none",
                 "Leave --audio out, or write .mp4 or .webm"};
  return job;
}

// FLAME parameters become the vertices of a FLAME model.
Status pose_flame(Job& job) {
  const auto is_flame = [](const Motion& motion) { return motion.space == MotionSpace::flame; };
  const auto first = std::find_if(job.motions.begin(), job.motions.end(), is_flame);
  if (first == job.motions.end()) {
    if (job.a.flame.empty()) return Done{};
    return Error{Errc::usage, "--flame", "is for motions of FLAME parameters", "Leave it out"};
  }
  if (job.a.flame.empty())
    return Error{Errc::usage,
                 "'" + job.a.motions[static_cast<std::size_t>(first - job.motions.begin())] + "'",
                 "holds FLAME parameters, which move no face of their own",
                 "Pass a FLAME model: --flame generic_model.pkl"};
  MIEN_TRY(const FlameModel model, read_flame_model(job.a.flame));
  const FlamePoser poser(model);
  for (Motion& motion : job.motions) {
    if (!is_flame(motion)) continue;
    MIEN_TRY(motion, flame_vertices(poser, motion, job.a.threads));
  }
  job.flame_mesh = flame_mesh(model);
  if (job.vertices.mm_per_unit == 0) job.vertices.mm_per_unit = kFlameMmPerUnit;
  return Done{};
}

Status read_inputs(Job& job, ConsoleProgress& progress) {
  for (const auto& path : job.a.motions) {
    auto motion = read_motion(path, {.fps = job.a.motion_fps});
    if (!motion) return motion.error();
    for (const auto& warning : motion.warnings) progress.warn(warning);
    job.motions.push_back(std::move(*motion));
  }
  MIEN_TRY([[maybe_unused]] const auto posed, pose_flame(job));
  MIEN_TRY([[maybe_unused]] const auto together, check_together(job.a, job.output, job.motions));
  if (job.a.audio.empty()) return Done{};
  auto clip = load_audio(job.a.audio);
  if (!clip) return clip.error();
  for (const auto& warning : clip.warnings) progress.warn(warning);
  job.sound = std::move(*clip);
  return Done{};
}

Status run_render(const RenderArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  MIEN_TRY(Job job, plan(a));
  progress.event("start", "\"command\":\"render\",\"input\":" + json_string(a.motions.front()) +
                              ",\"outputs\":[" + json_string(job.output.path.string()) + "]");
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable({&job.output, 1}));
  MIEN_TRY([[maybe_unused]] const auto read, read_inputs(job, progress));
  const auto done = job.motions.front().space == MotionSpace::vertices ? render_vertices(job, progress)
                                                                       : render_curves(job, progress);
  if (!done) return done.error();
  for (const auto& warning : done.warnings) progress.warn(warning);
  double seconds = 0;
  for (const Motion& motion : job.motions) seconds = std::max(seconds, motion.seconds());
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.event("success", "\"outputs\":[" + json_string(job.output.path.string()) +
                                "],\"motion_seconds\":" + fixed(seconds, 3) +
                                ",\"seconds\":" + fixed(taken, 3));
  progress.say("wrote " + a.output + ": " + fixed(seconds, 2) + " s of motion in " + fixed(taken, 2) + " s");
  return Done{};
}

}  // namespace

void add_render_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("render", "Put a motion on a face: a video, pictures or meshes");
  auto a = std::make_shared<RenderArguments>();
  command
      ->add_option(
          "MOTION", a->motions,
          "Motion file: .glb .csv .json .npy. Several are shown side by side, named by their files; in a "
          "sheet of several instants each has a row")
      ->required();
  command
      ->add_option(
          "-o,--output", a->output,
          "Video (.mp4 .webm), contact sheet (.png), a folder/ of numbered pictures; positions of all "
          "vertices (.npy .glb), or a folder of meshes: name.obj/ or name.vl/")
      ->required();
  command->add_option("--character", a->character,
                      "Character to draw (.glb .gltf .vrm .safetensors). Default: Mien's head");
  command->add_option("--audio", a->audio, "Sound of the video");
  command->add_option("--flame", a->flame,
                      "FLAME model (generic_model.pkl or .npz) for motions of FLAME parameters");
  add_vertex_options(*command, a->vertices);
  add_other_face_options(*command, a->vertices);
  command
      ->add_option(
          "--motion-fps", a->motion_fps,
          "Frames a second of a MOTION, 1 to 240: of an .npy, which does not say, and of a .csv, whose "
          "timecodes are taken to count at this rate unless they count higher")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--fps", a->fps, "Frames a second of videos and numbered pictures, 1 to 240")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  command->add_option("--size", a->size,
                      "Pixels of a picture: 512 or 640x480. Default: 512; 256 in a contact sheet");
  add_view_option(*command, a->view);
  add_sheet_options(*command, a->times, a->columns, "motions");
  command->add_option(
      "--heatmap", a->heat_map,
      "A picture of how far each vertex moves from frame to frame: mean, or std (its spread)");
  add_threads_option(*command, a->threads);
  add_console_options(*command, chosen);
  add_footer(*command,
             "  mien render hello.glb --audio hello.wav -o hello.mp4\n"
             "  mien render predicted.npy --mesh template.obj -o predicted.glb --max-error 0.05\n"
             "  mien render hello.csv --view mouth --times 0.4,0.8,1.2 -o sheet.png\n"
             "  mien render neutral.csv happy.csv sad.csv --times 0.4,0.8,1.2 -o emotions.png\n"
             "  mien render truth.npy model.npy --mesh template.obj --audio hello.wav -o both.mp4\n"
             "  mien render hello.npy --flame generic_model.pkl --audio hello.wav -o hello.mp4\n"
             "  mien render take-1.csv take-2.csv take-3.csv --heatmap std -o spread.png\n");
  command->callback(
      [a, &chosen] { chosen.work = [a](ConsoleProgress& progress) { return run_render(*a, progress); }; });
}

}  // namespace mien

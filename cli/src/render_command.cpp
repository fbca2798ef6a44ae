// mien render: a motion file on a face, as a film, pictures or meshes.
#include <chrono>

#include "character_source.h"
#include "mien/audio/load_audio.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/io/character_file.h"
#include "mien/io/mesh_file.h"
#include "mien/io/motion_file.h"
#include "options.h"
#include "pictures.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

struct RenderArguments {
  std::string motion, character, audio, output, size, view = "portrait", times;
  VertexOptions vertices;
  double fps = 30, motion_fps = 0;
  int columns = 4;
  int threads = hardware_threads();
};

Status render_vertices(const RenderArguments& a, const Output& output, const Motion& motion,
                       const VertexShow& show, ConsoleProgress& progress) {
  const auto mesh = vertex_mesh(a.vertices, motion);
  if (!mesh) return mesh.error();
  const bool needs_triangles = output.kind != OutputKind::motion || output.is_glb();
  if (needs_triangles)
    for (const auto& warning : mesh.warnings) progress.warn(warning);
  return write_vertex_output(output, motion, *mesh, a.vertices, show, progress);
}

// Coefficients move a character: into pictures, its .glb, or the positions of its vertices.
Status render_curves(const RenderArguments& a, const std::filesystem::path& path, const Output& output,
                     const Motion& motion, const VertexShow& show, ConsoleProgress& progress) {
  if (output.is_glb()) {
    MIEN_TRY(const Bytes glb, character_glb(path));
    return write_motion(output.path, motion, {.character_glb = glb, .audio_name = "", .glb = {}});
  }
  auto character = load_character(path);
  if (!character) return character.error();
  for (const auto& warning : character.warnings) progress.warn(warning);
  if (output.is_picture())
    return write_pictures(output, motion, *character, show.sound, show.pictures, progress);
  MIEN_TRY(const Motion vertices, vertex_sequence(*character, motion, show.pictures.threads));
  return write_vertex_output(output, vertices, merged_mesh(*character), a.vertices, show, progress);
}

Status run_render(const RenderArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  PictureOptions options{.fps = a.fps, .view = a.view, .columns = a.columns, .threads = a.threads};
  MIEN_TRY([[maybe_unused]] const auto view, check_view(a.view));
  if (!a.times.empty()) {
    MIEN_TRY(options.times, parse_times(a.times));
  }
  MIEN_TRY(const auto path, character_path(a.character));
  constexpr OutputKind kKinds[] = {OutputKind::video, OutputKind::sheet, OutputKind::frames,
                                   OutputKind::motion, OutputKind::meshes};
  const std::array<std::filesystem::path, 4> inputs = {a.motion, a.audio, path, a.vertices.mesh};
  MIEN_TRY(const auto outputs, plan_outputs({&a.output, 1}, inputs, kKinds));
  const Output& output = outputs.front();
  MIEN_TRY(const auto size, parse_size(!a.size.empty()                    ? a.size
                                       : output.kind == OutputKind::sheet ? "256"
                                                                          : "512"));
  options.width = size.first, options.height = size.second;
  if (!a.audio.empty() && output.kind != OutputKind::video)
    return Error{Errc::usage, "--audio", "only videos have sound: '" + a.output + "' is none",
                 "Leave --audio out, or write .mp4 or .webm"};

  progress.event("start", "\"command\":\"render\",\"input\":" + json_string(a.motion) + ",\"outputs\":[" +
                              json_string(output.path.string()) + "]");
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable(outputs));
  auto motion = read_motion(a.motion, {.fps = a.motion_fps});
  if (!motion) return motion.error();
  std::optional<AudioClip> sound;
  if (!a.audio.empty()) {
    auto clip = load_audio(a.audio);
    if (!clip) return clip.error();
    for (const auto& warning : clip.warnings) progress.warn(warning);
    sound = std::move(*clip);
  }
  for (const auto& warning : motion.warnings) progress.warn(warning);

  const VertexShow show{options, sound ? &*sound : nullptr, ""};
  const auto done = motion->space == MotionSpace::vertices
                        ? render_vertices(a, output, *motion, show, progress)
                        : render_curves(a, path, output, *motion, show, progress);
  if (!done) return done.error();
  for (const auto& warning : done.warnings) progress.warn(warning);
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.event("success", "\"outputs\":[" + json_string(output.path.string()) + "],\"motion_seconds\":" +
                                fixed(motion->seconds(), 3) + ",\"seconds\":" + fixed(taken, 3));
  progress.say("wrote " + a.output + ": " + fixed(motion->seconds(), 2) + " s of motion in " +
               fixed(taken, 2) + " s");
  return Done{};
}

}  // namespace

void add_render_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("render", "Put a motion on a face: a video, pictures or meshes");
  auto a = std::make_shared<RenderArguments>();
  command->add_option("MOTION", a->motion, "Motion file: .glb .csv .json .npy")->required();
  command
      ->add_option(
          "-o,--output", a->output,
          "Video (.mp4 .webm), contact sheet (.png), a folder/ of numbered pictures; positions of all "
          "vertices (.npy .glb), or a folder of meshes: name.obj/ or name.vl/")
      ->required();
  command->add_option("--character", a->character,
                      "Character to draw (.glb .gltf .vrm .safetensors). Default: Mien's head");
  command->add_option("--audio", a->audio, "Sound of the video");
  add_vertex_options(*command, a->vertices);
  command
      ->add_option("--motion-fps", a->motion_fps, "Frames a second of a MOTION that does not say, 1 to 240")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--fps", a->fps, "Frames a second of videos and numbered pictures, 1 to 240")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
  command->add_option("--size", a->size,
                      "Pixels of a picture: 512 or 640x480. Default: 512; 256 in a contact sheet");
  command->add_option("--view", a->view, "front, portrait, three-quarter, side or mouth")
      ->capture_default_str();
  command->add_option("--times", a->times,
                      "Instants of a contact sheet in seconds: 0.5,1.25. Default: twelve, evenly spread");
  command->add_option("--columns", a->columns, "Pictures in a row of a contact sheet, 1 to 64")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  add_threads_option(*command, a->threads);
  add_console_options(*command, chosen);
  add_footer(*command,
             "  mien render hello.glb --audio hello.wav -o hello.mp4\n"
             "  mien render predicted.npy --mesh template.obj -o predicted.glb --max-error 0.05\n"
             "  mien render hello.csv --view mouth --times 0.4,0.8,1.2 -o sheet.png\n");
  command->callback(
      [a, &chosen] { chosen.work = [a](ConsoleProgress& progress) { return run_render(*a, progress); }; });
}

}  // namespace mien

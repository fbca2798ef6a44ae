// mien edit: a part of a motion made anew, the rest as it was.
#include <chrono>

#include "character_source.h"
#include "face_director.h"
#include "flame_outputs.h"
#include "keep_words.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/io/character_file.h"
#include "mien/io/motion_file.h"
#include "mien/models/edit.h"
#include "options.h"
#include "outputs.h"
#include "pictures.h"
#include "said_director.h"
#include "share.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct EditArguments {
  std::string motion, speech, model, character;
  std::vector<std::string> outputs;
  KeepWords keep;
  DirectionWords words;
  FaceWords face;
  SaidWords said;
  VertexOptions vertices;
  int takes = 1;
  double motion_fps = 0;
  std::string size = "512", view = "portrait";
  int threads = hardware_threads();
};

// The outputs, and what they need; everything that can be wrong is found out before the work begins.
struct Targets {
  std::vector<Output> outputs;  // of all takes, take by take
  Bytes character_glb;          // when a .glb is written
  std::optional<Character> character;
  std::optional<AudioClip> sound;  // of a video
  PictureOptions pictures;
  std::optional<Mesh> mesh;  // of a motion of vertices, which needs no character
};

Result<Targets> targets(const EditArguments& a, const fs::path& model, const Motion& motion,
                        ConsoleProgress& progress) {
  Targets t;
  const bool is_mesh = motion.space == MotionSpace::vertices;
  if (is_mesh) {
    MIEN_TRY(t.mesh, vertex_mesh(a.vertices, motion));
  }
  MIEN_TRY(const fs::path face, character_path(a.character));
  MIEN_TRY(const auto size, parse_size(a.size));
  MIEN_TRY([[maybe_unused]] const auto view, check_view(a.view));
  t.pictures = {.width = size.first, .height = size.second, .view = a.view, .threads = a.threads};
  constexpr OutputKind kKinds[] = {OutputKind::motion, OutputKind::video, OutputKind::sheet,
                                   OutputKind::frames, OutputKind::meshes};
  const std::array<fs::path, 7> inputs = {a.motion,    a.speech,    model,          face,
                                          a.keep.mask, a.keep.keys, a.vertices.mesh};
  MIEN_TRY(t.outputs, plan_outputs(a.outputs, inputs, std::span(kKinds).first(is_mesh ? 5 : 4), a.takes));
  if (motion.space == MotionSpace::flame) {
    MIEN_TRY([[maybe_unused]] const auto fit, plan_flame_outputs(t.outputs, FlameFace::none));
  }
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable(t.outputs));
  for (const Output& output : t.outputs) {
    if (output.is_glb() && !is_mesh && t.character_glb.empty()) {
      MIEN_TRY(t.character_glb, character_glb(face));
    }
    if (output.is_picture() && !is_mesh && !t.character) {
      auto character = load_character(face);
      if (!character) return character.error();
      for (const auto& warning : character.warnings) progress.warn(warning);
      t.character = std::move(*character);
    }
    if (output.kind == OutputKind::video && !t.sound) {
      MIEN_TRY(t.sound, load_audio(a.speech));
    }
  }
  return t;
}

Status write_takes(const EditArguments& a, const Targets& t, const std::vector<Motion>& takes,
                   ConsoleProgress& progress) {
  const std::size_t per_take = t.outputs.size() / takes.size();
  const MotionContext context{
      .character_glb = t.character_glb, .audio_name = fs::path(a.speech).filename().string(), .glb = {}};
  for (std::size_t k = 0; k < t.outputs.size(); ++k) {
    const Motion& take = takes[k / per_take];
    const AudioClip* sound = t.sound ? &*t.sound : nullptr;
    const Status written = t.mesh ? write_vertex_output(t.outputs[k], take, *t.mesh, a.vertices,
                                                        {t.pictures, sound, context.audio_name}, progress)
                           : t.outputs[k].is_picture()
                               ? write_pictures(t.outputs[k], take, *t.character, sound, t.pictures, progress)
                               : write_motion(t.outputs[k].path, take, context);
    if (!written) return written.error();
    if (k < per_take)
      for (const auto& warning : written.warnings) progress.warn(t.outputs[k].path.string() + ": " + warning);
  }
  return Done{};
}

// The takes of the model that the arguments name.
Result<std::vector<Motion>> perform(const EditArguments& a, const fs::path& path, const ModelFile& model,
                                    const Motion& motion, const KeptValues& kept, ConsoleProgress& progress) {
  if (model.architecture == Architecture::default_model) {
    MIEN_TRY(const PerformOptions options, perform_options(a.words));
    MIEN_TRY(AudioReader speech, AudioReader::open(a.speech));
    MIEN_TRY(const DefaultModel standard, DefaultModel::load(path));
    return edit(standard, speech, motion, kept, options, a.takes, a.threads, progress);
  }
  MIEN_TRY(const EncoderPrecision precision, encoder_precision(a.face));
  const auto speech = load_audio(a.speech);
  if (!speech) return speech.error();
  Result<std::vector<Motion>> takes{std::vector<Motion>()};
  if (model.architecture == Architecture::said) {
    MIEN_TRY(const SaidOptions options, said_options(a.words, a.face, a.said, trained_steps(model)));
    MIEN_TRY(const SaidModel said, SaidModel::load(path, precision));
    takes = edit(said, *speech, motion, kept, options, a.takes, a.threads, progress);
  } else {
    MIEN_TRY(const FaceOptions options, face_options(a.words, a.face, model));
    MIEN_TRY(const FaceModel face, FaceModel::load(path, a.threads, precision));
    takes = edit(face, *speech, motion, kept, options, a.takes, a.threads, progress);
  }
  if (takes) takes.warnings.insert(takes.warnings.end(), speech.warnings.begin(), speech.warnings.end());
  return takes;
}

// The model's description. Errors (Errc::usage): words that are not for it.
Result<ModelFile> describe(const EditArguments& a, const SafetensorsFile& file) {
  auto model = read_model_file(file.metadata());
  if (!model) return within(model.error(), "loading model '" + a.model + "'");
  const auto other = [](const std::string& word, const std::string& whose) {
    return Error{Errc::usage, word, "does not apply to this model: it is for " + whose,
                 "Leave it out, or name such a model with --model"};
  };
  const bool is_said = model->architecture == Architecture::said;
  if (const std::string word = a.said.used(); !word.empty() && !is_said) return other(word, "SAiD");
  if (model->architecture == Architecture::default_model) {
    if (const std::string word = a.face.used(); !word.empty()) return other(word, "the published systems");
    MIEN_TRY([[maybe_unused]] const auto options, perform_options(a.words));
    return model;
  }
  MIEN_TRY([[maybe_unused]] const auto precision, encoder_precision(a.face));
  if (is_said) {
    if (!a.said.init.empty() || a.face.window_s > 0)
      return Error{Errc::usage, a.said.init.empty() ? "--window" : "--init", "does not apply to an edit",
                   "Leave it out"};
    auto options = said_options(a.words, a.face, a.said, trained_steps(*model));
    if (!options) return options.error();
    model.warnings = options.warnings;
    return model;
  }
  MIEN_TRY([[maybe_unused]] const auto checked, check_words(a.face, *model));
  MIEN_TRY([[maybe_unused]] const auto options, face_options(a.words, a.face, *model));
  return model;
}

Status run_edit(const EditArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  fs::path model_path = a.model;
  if (a.model.empty()) {
    MIEN_TRY(model_path, shared_file("default.safetensors", "--model FILE"));
  }
  MIEN_TRY(const SafetensorsFile model_file, SafetensorsFile::open(model_path));
  const auto model = describe(a, model_file);
  if (!model) return model.error();
  for (const auto& warning : model.warnings) progress.warn(warning);
  const auto motion = read_motion(a.motion, {.fps = a.motion_fps});
  if (!motion) return motion.error();
  for (const auto& warning : motion.warnings) progress.warn(warning);
  const auto kept = kept_values(a.keep, *motion, model_file);
  if (!kept) return kept.error();
  for (const auto& warning : kept.warnings) progress.warn(warning);
  MIEN_TRY([[maybe_unused]] const AudioReader readable, AudioReader::open(a.speech));
  MIEN_TRY(const Targets t, targets(a, model_path, *motion, progress));
  progress.event(
      "start", "\"command\":\"edit\",\"input\":" + json_string(a.motion) +
                   ",\"speech\":" + json_string(a.speech) + ",\"model\":" + json_string(model_path.string()) +
                   ",\"outputs\":" + json_list(t.outputs) + ",\"seed\":" + std::to_string(a.words.seed));

  const auto takes = perform(a, model_path, *model, *motion, *kept, progress);
  if (!takes) return within(takes.error(), "editing '" + a.motion + "'");
  for (const auto& warning : takes.warnings) progress.warn(warning);
  MIEN_TRY([[maybe_unused]] const auto written, write_takes(a, t, *takes, progress));

  const FrameRange edited = kept->edited();
  const double first = static_cast<double>(edited.first) / motion->fps,
               last = static_cast<double>(edited.end - 1) / motion->fps;
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.event("success", "\"outputs\":" + json_list(t.outputs) + ",\"edited_from\":" + fixed(first, 4) +
                                ",\"edited_to\":" + fixed(last, 4) + ",\"takes\":" + std::to_string(a.takes) +
                                ",\"seconds\":" + fixed(taken, 3) +
                                ",\"seed\":" + std::to_string(a.words.seed));
  progress.say("wrote " + output_list(t.outputs) + ": new between " + fixed(first, 3) + " and " +
               fixed(last, 3) + " s, in " + fixed(taken, 2) + " s, seed " + std::to_string(a.words.seed));
  return Done{};
}

}  // namespace

void add_edit_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("edit", "Make a part of a motion anew and keep the rest");
  auto a = std::make_shared<EditArguments>();
  command->add_option("MOTION", a->motion, "Motion file: .glb .csv .json .npy")->required();
  command->add_option("--speech", a->speech, "The sound that the motion belongs to: wav, flac, mp3, mp4 ...")
      ->required();
  add_keep_options(*command, a->keep);
  command
      ->add_option("-o,--output", a->outputs,
                   "File to write, may be repeated: .glb .csv .json .npy .mp4 .webm .png, or a folder/ of "
                   "pictures. Several takes get -1, -2 ... at the end of their names")
      ->required()
      ->allow_extra_args(false);
  command->add_option("--model", a->model,
                      "Model file (.safetensors). Default: the one that comes with Mien");
  command->add_option(
      "--character", a->character,
      "Character with ARKit morph targets (.glb .gltf .vrm .safetensors). Default: Mien's head");
  command->add_option(
      "--emotion", a->words.emotion,
      "Of what is made anew, as for mien animate: happy:2, or a .csv or .json file over time. "
      "Default: neutral");
  command->add_option("--style", a->words.style,
                      "Manner of a speaker, S00 to S11. Default: none in particular");
  command->add_option("--seed", a->words.seed, "Chooses the take: the same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--takes", a->takes, "Number of different takes, 1 to 100")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  add_face_options(*command, a->words, a->face);
  add_said_options(*command, a->said);
  command
      ->add_option(
          "--motion-fps", a->motion_fps,
          "Frames a second of a MOTION, 1 to 240: of an .npy, which does not say, and of a .csv, whose "
          "timecodes are taken to count at this rate unless they count higher")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--size", a->size, "Pixels of pictures: 512 or 640x480")->capture_default_str();
  add_view_option(*command, a->view);
  add_vertex_options(*command, a->vertices);
  add_threads_option(*command, a->threads);
  add_console_options(*command, chosen);
  add_footer(
      *command,
      "  mien edit hello.csv --speech hello.wav --range 1.20-2.05 --takes 4 -o again.csv\n"
      "  mien edit face.npy --speech hello.wav --model biwi.safetensors --range 1-2 --lock upper -o "
      "again.npy\n"
      "  mien edit hello.glb --speech hello.wav --lock 'jawOpen,mouth*' --emotion happy:2 -o again.glb\n"
      "  mien edit hello.csv --speech hello.wav --range 0.5-1.5 --keep-keys keys.csv -o again.csv -o "
      "again.mp4\n");
  command->callback(
      [a, &chosen] { chosen.work = [a](ConsoleProgress& progress) { return run_edit(*a, progress); }; });
}

}  // namespace mien

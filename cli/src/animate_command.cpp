// mien animate: speech in, motion files and videos out.
#include <chrono>

#include "character_source.h"
#include "director.h"
#include "face_director.h"
#include "flame_outputs.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/motion_file.h"
#include "mien/models/animate.h"
#include "mien/models/face_model.h"
#include "options.h"
#include "outputs.h"
#include "pictures.h"
#include "share.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kSilent = "the recording is silent";  // the reader's warning (mien/audio)

struct AnimateArguments {
  std::string speech, model, character, flame;
  std::vector<std::string> outputs;
  DirectionWords words;
  FaceWords face;
  VertexOptions vertices;
  int takes = 1;
  double fps = 0;  // 0: 60 for motion, 30 for pictures
  std::string size = "512", view = "portrait";
  bool allow_silence = false;
  int threads = hardware_threads();
};

// Everything that can be wrong is found out before the work begins.
struct Prepared {
  std::vector<Output> outputs;  // of all takes, take by take
  bool is_published = false;    // FaceXHuBERT, FaceDiffuser or ProbTalk3D, not the default model
  bool moves_flame = false;     // parameters of FLAME
  PerformOptions options;
  FaceOptions face;
  fs::path model_path, character_path;
  Bytes character_glb;                 // when a .glb is written
  std::optional<Character> character;  // when pictures are drawn
  std::optional<FlameModel> flame;     // that makes a face of its parameters
  std::optional<Mesh> mesh;            // of a model that moves vertices, which needs no character
  PictureOptions pictures;
};

// The architecture decides what the words mean and what is written.
Result<ModelFile> describe(const fs::path& path) {
  const auto file = SafetensorsFile::open(path);
  if (!file) return file.error();
  auto model = read_model_file(file->metadata());
  if (!model) return within(model.error(), "loading model '" + path.string() + "'");
  return model;
}

Status direct(const AnimateArguments& a, const ModelFile& model, Prepared& p) {
  if (p.is_published) {
    MIEN_TRY([[maybe_unused]] const auto checked, check_words(a.face, model));
    MIEN_TRY(p.face, face_options(a.words, a.face, model));
    MIEN_TRY([[maybe_unused]] const auto precision, encoder_precision(a.face));
    return Done{};
  }
  if (const std::string word = a.face.used(); !word.empty())
    return Error{Errc::usage, word, "does not apply to this model: it is for published systems",
                 "Leave it out, or name such a model with --model"};
  MIEN_TRY(p.options, perform_options(a.words));
  return Done{};
}

// The mesh whose vertices the model moves; outputs that cannot be made of it are refused before the work.
Status prepare_mesh(const AnimateArguments& a, const ModelFile& model, Prepared& p) {
  const auto mesh = vertex_mesh(a.vertices, vertex_motion(topology_of(model.output.channels / 3), 1));
  if (!mesh) return mesh.error();
  Status status = Done{};
  for (const auto& output : p.outputs) {
    const auto extension = output.path.extension();
    if (extension == ".csv" || extension == ".json")
      return Error{Errc::usage, "output '" + output.path.string() + "'",
                   "cannot hold the vertices that this model moves", "Write .npy, .glb, meshes or pictures"};
    if (output.is_picture() && mesh->triangles.empty())
      return Error{Errc::usage, "output '" + output.path.string() + "'", "a picture needs triangles",
                   "Pass --mesh FILE with the template of the data set (.obj or .ply)"};
    if (output.is_glb()) status.warnings = mesh.warnings;
  }
  p.mesh = *mesh;
  return status;
}

Result<Prepared> prepare(const AnimateArguments& a) {
  Prepared p;
  ModelFile model;
  bool moves_vertices = false;
  if (!a.model.empty()) {
    MIEN_TRY(model, describe(a.model));
    p.is_published = FaceModel::runs(model.architecture);
    moves_vertices = p.is_published && model.output.space == "vertices";
    p.moves_flame = p.is_published && model.output.space == "flame";
  }
  if (!a.vertices.mesh.empty() && !moves_vertices)
    return Error{Errc::usage, "--mesh", "is for models that move vertices",
                 "Leave it out, or pass a face with --character"};
  if (!a.flame.empty()) {
    if (!p.moves_flame)
      return Error{Errc::usage, "--flame", "is for models that give FLAME parameters", "Leave it out"};
    MIEN_TRY(p.flame, read_flame_model(a.flame));
  }
  MIEN_TRY([[maybe_unused]] const auto directed, direct(a, model, p));
  const auto size = parse_size(a.size);
  if (!size) return size.error();
  p.pictures = {.width = size->first, .height = size->second, .threads = a.threads};
  if (a.fps > 0) p.pictures.fps = a.fps;
  MIEN_TRY([[maybe_unused]] const auto view, check_view(a.view));
  p.pictures.view = a.view;
  std::vector<std::string> names = a.outputs;
  if (names.empty())
    names.push_back(fs::path(a.speech).stem().string() + (moves_vertices || p.moves_flame ? ".npy" : ".glb"));
  if (a.model.empty()) {
    MIEN_TRY(p.model_path, shared_file("default.safetensors", "--model FILE"));
  } else {
    p.model_path = a.model;
  }
  MIEN_TRY(p.character_path, character_path(a.character));
  constexpr OutputKind kAll[] = {OutputKind::motion, OutputKind::video, OutputKind::sheet, OutputKind::frames,
                                 OutputKind::meshes};
  const std::span<const OutputKind> kinds = std::span(kAll).first(moves_vertices || p.flame ? 5 : 4);
  const std::array<fs::path, 5> inputs = {a.speech, p.model_path, p.character_path, a.vertices.mesh, a.flame};
  MIEN_TRY(p.outputs, plan_outputs(names, inputs, kinds, a.takes));
  if (p.moves_flame && !p.flame) {
    MIEN_TRY([[maybe_unused]] const auto fit, check_flame_outputs(p.outputs));
  }
  if (!moves_vertices) return p;
  const Status mesh = prepare_mesh(a, model, p);
  if (!mesh) return mesh.error();
  Result<Prepared> prepared(std::move(p));
  prepared.warnings = mesh.warnings;
  return prepared;
}

Status load_character_for(const std::vector<Output>& outputs, Prepared& p, ConsoleProgress& progress) {
  if (p.mesh || p.flame) return Done{};
  const auto any = [&](auto wanted) { return std::any_of(outputs.begin(), outputs.end(), wanted); };
  if (any([](const Output& o) { return o.is_glb(); })) {
    MIEN_TRY(p.character_glb, character_glb(p.character_path));
  }
  if (any([](const Output& o) { return o.is_picture(); })) {
    auto character = load_character(p.character_path);
    if (!character) return character.error();
    for (const auto& warning : character.warnings) progress.warn(warning);
    p.character = std::move(*character);
  }
  return Done{};
}

std::string output_list(const std::vector<Output>& outputs) {
  std::string list;
  for (const auto& output : outputs)
    list +=
        (list.empty() ? "" : ", ") + output.path.string() + (output.kind == OutputKind::frames ? "/" : "");
  return list;
}

std::string json_list(const std::vector<Output>& outputs) {
  std::string list;
  for (const auto& output : outputs) list += (list.empty() ? "" : ",") + json_string(output.path.string());
  return "[" + list + "]";
}

Status write_vertex_outputs(const AnimateArguments& a, const Prepared& p, const std::vector<Motion>& takes,
                            const AudioClip* sound, ConsoleProgress& progress) {
  const std::size_t per_take = p.outputs.size() / takes.size();
  const VertexShow show{p.pictures, sound, fs::path(a.speech).filename().string()};
  for (std::size_t k = 0; k < p.outputs.size(); ++k) {
    const Status written =
        write_vertex_output(p.outputs[k], takes[k / per_take], *p.mesh, a.vertices, show, progress);
    if (!written) return written.error();
    for (const auto& warning : written.warnings) progress.warn(warning);
  }
  return Done{};
}

Status write_flames(const AnimateArguments& a, const Prepared& p, const std::vector<Motion>& takes,
                    const AudioClip* sound, ConsoleProgress& progress) {
  const std::size_t per_take = p.outputs.size() / takes.size();
  const VertexShow show{p.pictures, sound, fs::path(a.speech).filename().string()};
  for (std::size_t take = 0; take < takes.size(); ++take) {
    const auto own = std::span(p.outputs).subspan(take * per_take, per_take);
    const Status written = write_flame_outputs(own, takes[take], *p.flame, a.vertices, show, progress);
    if (!written) return written.error();
  }
  return Done{};
}

// Writes all outputs of all takes. Motion files are small and written side by side; films take all threads.
Status write_outputs(const AnimateArguments& a, const Prepared& p, const std::vector<Motion>& takes,
                     const AudioClip* sound, ConsoleProgress& progress) {
  if (p.flame) return write_flames(a, p, takes, sound, progress);
  if (p.mesh) return write_vertex_outputs(a, p, takes, sound, progress);
  const std::size_t per_take = p.outputs.size() / takes.size();
  std::vector<Status> results(p.outputs.size(), Status(Done{}));
  const MotionContext context{
      .character_glb = p.character_glb, .audio_name = fs::path(a.speech).filename().string(), .glb = {}};
  parallel_for(a.threads, static_cast<std::int64_t>(p.outputs.size()), [&](std::int64_t i) {
    const auto k = static_cast<std::size_t>(i);
    if (p.outputs[k].is_picture()) return;
    results[k] = write_motion(p.outputs[k].path, takes[k / per_take], context);
  });
  for (std::size_t k = 0; k < p.outputs.size(); ++k) {
    if (p.outputs[k].is_picture())
      results[k] =
          write_pictures(p.outputs[k], takes[k / per_take], *p.character, sound, p.pictures, progress);
    if (!results[k]) return results[k].error();
    if (k < per_take)
      for (const auto& warning : results[k].warnings)
        progress.warn(p.outputs[k].path.string() + ": " + warning);
  }
  return Done{};
}

Result<std::vector<Motion>> perform(const AnimateArguments& a, const Prepared& p, ConsoleProgress& progress) {
  if (!p.is_published) {
    MIEN_TRY(AudioReader speech, AudioReader::open(a.speech));
    MIEN_TRY(const DefaultModel model, DefaultModel::load(p.model_path));
    return animate(model, speech, p.options, a.takes, a.threads, progress);
  }
  auto clip = load_audio(a.speech);
  if (!clip) return clip.error();
  MIEN_TRY(const EncoderPrecision precision, encoder_precision(a.face));
  MIEN_TRY(const FaceModel model, FaceModel::load(p.model_path, a.threads, precision));
  auto takes = animate(model, *clip, p.face, a.takes, a.threads, progress);
  if (takes) takes.warnings = clip.warnings;
  return takes;
}

Status run_animate(const AnimateArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  auto prepared = prepare(a);
  if (!prepared) return prepared.error();
  for (const auto& warning : prepared.warnings) progress.warn(warning);
  Prepared& p = *prepared;
  MIEN_TRY([[maybe_unused]] const AudioReader readable, AudioReader::open(a.speech));
  progress.event("start", "\"command\":\"animate\",\"input\":" + json_string(a.speech) + ",\"model\":" +
                              json_string(p.model_path.string()) + ",\"outputs\":" + json_list(p.outputs) +
                              ",\"seed\":" + std::to_string(a.words.seed));
  MIEN_TRY([[maybe_unused]] const auto writable, check_writable(p.outputs));
  MIEN_TRY([[maybe_unused]] const auto character, load_character_for(p.outputs, p, progress));

  auto takes = perform(a, p, progress);
  if (!takes) return within(takes.error(), "animating '" + a.speech + "'");
  for (const auto& warning : takes.warnings) {
    if (warning == kSilent && !a.allow_silence)
      return Error{Errc::input, "'" + a.speech + "'", warning, "Pass --allow-silence to get a face at rest"};
    progress.warn(warning);
  }
  const double seconds = takes->front().seconds();
  if (a.fps > 0 && a.fps != takes->front().fps)
    for (auto& motion : *takes) motion = resample(motion, a.fps);

  std::optional<AudioClip> sound;
  for (const auto& output : p.outputs) {
    if (output.kind != OutputKind::video || sound) continue;
    auto clip = load_audio(a.speech);
    if (!clip) return clip.error();
    sound = std::move(*clip);
  }
  MIEN_TRY([[maybe_unused]] const auto written,
           write_outputs(a, p, *takes, sound ? &*sound : nullptr, progress));

  if (p.moves_flame && !p.flame) progress.say(flame_parameters_notice(takes->front()));
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double factor = taken / seconds;
  progress.event("success",
                 "\"outputs\":" + json_list(p.outputs) + ",\"speech_seconds\":" + fixed(seconds, 3) +
                     ",\"seconds\":" + fixed(taken, 3) + ",\"real_time_factor\":" + fixed(factor, 4) +
                     ",\"seed\":" + std::to_string(a.words.seed));
  progress.say("wrote " + output_list(p.outputs) + ": " + fixed(seconds, 2) + " s of speech in " +
               fixed(taken, 2) + " s (real-time factor " + fixed(factor, 3) + "), seed " +
               std::to_string(a.words.seed));
  return Done{};
}

}  // namespace

void add_animate_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("animate", "Turn recorded speech into facial animation");
  auto a = std::make_shared<AnimateArguments>();
  command->add_option("SPEECH", a->speech, "Any file with sound: wav, flac, ogg, mp3, m4a, mp4 ...")
      ->required();
  command
      ->add_option(
          "-o,--output", a->outputs,
          "File to write, may be repeated: .glb .csv .json .npy .mp4 .webm .png, or a folder/ of pictures. "
          "Default: SPEECH with .glb, in the current folder. Several takes get -1, -2 ... at the end of "
          "their names")
      ->allow_extra_args(false);
  command->add_option("--model", a->model,
                      "Model file (.safetensors). Default: the one that comes with Mien");
  command->add_option(
      "--character", a->character,
      "Character with ARKit morph targets (.glb .gltf .vrm .safetensors). Default: Mien's head");
  command->add_option(
      "--emotion", a->words.emotion,
      "neutral, happy, sad, surprised, fear, disgusted, angry or contempt, with a level :1 :2 :3 or an "
      "intensity :0.0 to :1.0; or a .csv or .json file: time,emotion,intensity[,style]. Default: neutral. "
      "FaceXHuBERT: neutral or expressive, which is its default. ProbTalk3D: levels 1 to 3 or low, medium, "
      "high");
  command->add_option(
      "--style", a->words.style,
      "Manner of a speaker, S00 to S11. Default: none in particular. Published models: one of their "
      "subjects; default: the first");
  command->add_option("--seed", a->words.seed, "Chooses the take: the same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--takes", a->takes, "Number of different takes, 1 to 100")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  auto* steps = command
                    ->add_option("--steps", a->words.steps,
                                 "Diffusion steps, 1 to 1000. Default: 8; published models: all of theirs")
                    ->check(CLI::Range(1, 1000));
  auto* sampler =
      command->add_option("--sampler", a->words.sampler,
                          "dpm++, ddim or ddpm. Default: dpm++; published models: ddpm; emotional "
                          "FaceDiffuser: ddim");
  command->add_option("--subject", a->face.subject,
                      "Published models: whose manner and neutral face, one of the model's subjects");
  command->add_option("--template", a->face.neutral,
                      "Published models: whose neutral face. Default: that of --style");
  command
      ->add_option(
          "--skip", a->face.skip,
          "Published models: noisiest diffusion steps to leave out. Default: 0; emotional FaceDiffuser: 900")
      ->check(CLI::Range(0, 100000));
  command->add_option(
      "--respacing", a->face.respacing,
      "Published models: which steps to keep: ddim50, or counts for equal sections: 10,15,20");
  command
      ->add_option("--eta", a->face.eta,
                   "Published models: share of fresh noise with ddim, 0 to 1. Default: 0")
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--const-noise", a->face.same_noise,
                    "Published models: fresh noise of a step is the same in all frames");
  command
      ->add_option(
          "--temperature", a->face.temperature,
          "ProbTalk3D: how freely codes are drawn; 0 takes the nearest code, the same in every take. "
          "Default: 0.2; 0.1 to 0.5 are recommended")
      ->check(CLI::Range(0.0, 1e6));
  command->add_option("--draw", a->face.draw, "ProbTalk3D: take the K-th code of a draw without replacement")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--noise", a->face.noise,
                   "ProbTalk3D's Gaussian variant: deviations from the mean, times this; 0 gives the mean. "
                   "Default: 20")
      ->check(CLI::Range(0.0, 1e6));
  command->add_option("--precision", a->face.precision,
                      "Published models: numbers of the speech encoder, f32, bf16 or int8. Default: f32");
  command
      ->add_option("--window", a->face.window_s,
                   "Published models: seconds of speech to encode at once, with 5 s heard on either side; "
                   "saves time and memory on long speech and is not exact. Default: 0, all of it")
      ->check(CLI::Range(0.0, 3600.0));
  command->add_option("--fps", a->fps, "Frames a second, 1 to 240. Default: 60, pictures 30")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--size", a->size, "Pixels of pictures: 512 or 640x480")->capture_default_str();
  command->add_option("--view", a->view, "front, portrait, three-quarter, side or mouth")
      ->capture_default_str();
  command->add_flag("--allow-silence", a->allow_silence, "Animate a silent recording too: a face at rest");
  command->add_option(
      "--flame", a->flame,
      "FLAME model (generic_model.pkl or .npz) that makes a face of ProbTalk3D's parameters: .npy, "
      ".glb, meshes and pictures then show its vertices; .csv and .json stay parameters");
  add_vertex_options(*command, a->vertices);
  add_threads_option(*command, a->threads);
  add_console_options(*command, chosen);
  add_footer(
      *command,
      "  mien animate hello.wav\n"
      "  mien animate hello.wav -o hello.glb -o hello.csv -o hello.mp4 --emotion happy:2 --seed 7\n"
      "  mien animate hello.wav --model biwi.safetensors --subject M3 --skip 450 -o hello.npy\n"
      "  mien animate hello.wav --model probtalk3d.safetensors --style W028 --emotion happy:3 --takes 10 -o "
      "hello.npy\n"
      "  mien animate hello.wav --model voca.safetensors --mesh FLAME_sample.ply -o hello.glb -o "
      "hello.mp4\n");
  command->callback([a, steps, sampler, &chosen] {
    a->face.has_steps = steps->count() > 0;
    a->face.has_sampler = sampler->count() > 0;
    chosen.work = [a](ConsoleProgress& progress) { return run_animate(*a, progress); };
  });
}

}  // namespace mien

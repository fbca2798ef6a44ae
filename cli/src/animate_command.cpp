// mien animate: speech in, motion files and videos out.
#include <chrono>

#include "animate_clip.h"
#include "animate_plan.h"
#include "flame_outputs.h"
#include "mien/audio/load_audio.h"
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "options.h"

namespace mien {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The members "outputs" to "seed" of an event.
std::string outcome_json(const std::vector<Output>& outputs, double speech_seconds, double seconds,
                         std::uint64_t seed) {
  return "\"outputs\":" + json_list(outputs) + ",\"speech_seconds\":" + fixed(speech_seconds, 3) +
         ",\"seconds\":" + fixed(seconds, 3) + ",\"real_time_factor\":" + fixed(seconds / speech_seconds, 4) +
         ",\"seed\":" + std::to_string(seed);
}

std::string outcome_text(const std::string& what, double speech_seconds, double seconds, std::uint64_t seed) {
  return "wrote " + what + ": " + fixed(speech_seconds, 2) + " s of speech in " + fixed(seconds, 2) +
         " s (real-time factor " + fixed(seconds / speech_seconds, 3) + "), seed " + std::to_string(seed);
}

void tell_start(const AnimateArguments& a, const AnimatePlan& p, ConsoleProgress& progress) {
  std::string inputs, outputs;
  for (const auto& speech : a.speech) inputs += (inputs.empty() ? "" : ",") + json_string(speech);
  for (const auto& output : p.all_outputs())
    outputs += (outputs.empty() ? "" : ",") + json_string(output.path.string());
  progress.event("start", "\"command\":\"animate\",\"input\":" + json_string(a.speech.front()) +
                              ",\"inputs\":[" + inputs + "],\"model\":" + json_string(p.model_path.string()) +
                              ",\"outputs\":[" + outputs + "],\"seed\":" + std::to_string(a.words.seed));
}

// A recording that cannot be animated is no reason to lose the others; a wrong word or an interruption is.
bool concerns_all(const Error& error) { return error.code == Errc::usage || error.code == Errc::cancelled; }

// Several recordings, with the model loaded once.
Status animate_all(const AnimateArguments& a, const AnimatePlan& p, const Performer& performer,
                   Clock::time_point start, ConsoleProgress& progress) {
  std::vector<Output> written;
  std::string failed;
  int num_failed = 0;
  double speech_seconds = 0;
  for (std::span<const ClipPlan> rest = p.clips; !rest.empty();) {
    const auto clips = rest.first(num_clips_together(a, performer, rest));
    rest = rest.subspan(clips.size());
    const auto clips_start = Clock::now();
    const auto seconds = animate_clips(a, p, performer, clips, progress);
    double together = 0;
    for (const auto& own : seconds) together += own ? *own : 0;
    const double taken_together = seconds_since(clips_start);
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const ClipPlan& clip = clips[i];
      const std::string input = "\"input\":" + json_string(clip.speech.string()) + ",";
      if (!seconds[i]) {
        if (concerns_all(seconds[i].error())) return seconds[i].error();
        ++num_failed;
        failed += (failed.empty() ? "'" : ", '") + clip.speech.string() + "'";
        report_error(seconds[i].error(), progress, "clip_failed", input);
        continue;
      }
      speech_seconds += *seconds[i];
      written.insert(written.end(), clip.outputs.begin(), clip.outputs.end());
      const double taken = taken_together * *seconds[i] / together;
      progress.event("clip", input + outcome_json(clip.outputs, *seconds[i], taken, a.words.seed));
      progress.say(outcome_text(output_list(clip.outputs), *seconds[i], taken, a.words.seed));
    }
  }
  const std::string count = std::to_string(p.clips.size());
  if (num_failed > 0)
    return Error{Errc::failed, std::to_string(num_failed) + " of " + count + " recordings",
                 "failed: " + failed + "; the others are written", ""};
  const double taken = seconds_since(start);
  progress.event("success", outcome_json(written, speech_seconds, taken, a.words.seed));
  progress.say(outcome_text(count + " recordings", speech_seconds, taken, a.words.seed));
  return Done{};
}

Status run_animate(const AnimateArguments& a, ConsoleProgress& progress) {
  const auto start = Clock::now();
  auto plan = plan_animation(a);
  if (!plan) return plan.error();
  for (const auto& warning : plan.warnings) progress.warn(warning);
  MIEN_TRY(const auto emotions, planned_emotions(a, *plan));
  if (a.speech.size() == 1) {
    MIEN_TRY([[maybe_unused]] const auto readable, AudioReader::open(a.speech.front()));
  }
  tell_start(a, *plan, progress);
  MIEN_TRY([[maybe_unused]] const auto prepared, prepare_outputs(*plan, progress));
  if (plan->num_flame_parameters > 0) progress.say(flame_parameters_notice(plan->num_flame_parameters));
  MIEN_TRY(const Performer performer, load_performer(a, *plan));
  if (plan->clips.size() > 1) return animate_all(a, *plan, performer, start, progress);

  const ClipPlan& clip = plan->clips.front();
  MIEN_TRY(const double seconds,
           emotions.empty() ? std::move(animate_clips(a, *plan, performer, plan->clips, progress).front())
                            : show_emotions(a, *plan, performer, emotions, progress));
  const double taken = seconds_since(start);
  progress.event("success", outcome_json(clip.outputs, seconds, taken, a.words.seed));
  progress.say(outcome_text(output_list(clip.outputs), seconds, taken, a.words.seed));
  return Done{};
}

}  // namespace

void add_animate_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("animate", "Turn recorded speech into facial animation");
  auto a = std::make_shared<AnimateArguments>();
  command
      ->add_option("SPEECH", a->speech,
                   "Files with sound: wav, flac, ogg, mp3, m4a, mp4 ... One that cannot be animated does not "
                   "stop the others")
      ->required();
  command
      ->add_option(
          "-o,--output", a->outputs,
          "File to write, may be repeated: .glb .csv .json .npy .mp4 .webm .png, or a folder/ of pictures. "
          "{name} stands for the name of SPEECH without extension. Several SPEECH need it, or a folder/ for "
          "a "
          ".glb of each. Default: {name}.glb, in the current folder. Several takes get -1, -2 ... at the "
          "end of their names")
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
  command->add_option("--emotions", a->emotions,
                      "Several emotions in one picture or film: all, all:3 (with a level), or "
                      "happy:1,happy:3,sad. A .png has a "
                      "row for each and a column for each of --times; films show them side by side");
  command->add_option(
      "--style", a->words.style,
      "Manner of a speaker, S00 to S11. Default: none in particular. Published models: one of their "
      "subjects; default: the first");
  command->add_option("--seed", a->words.seed, "Chooses the take: the same seed gives the same bytes")
      ->capture_default_str();
  command->add_option("--takes", a->takes, "Number of different takes, 1 to 100")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  add_face_options(*command, a->words, a->face);
  add_said_options(*command, a->said);
  command->add_option("--fps", a->fps, "Frames a second, 1 to 240. Default: 60, pictures 30")
      ->check(CLI::Range(1.0, 240.0));
  command->add_option("--size", a->size, "Pixels of pictures: 512 or 640x480")->capture_default_str();
  add_view_option(*command, a->view);
  add_sheet_options(*command, a->times, a->columns, "emotions");
  command->add_flag("--allow-silence", a->allow_silence, "Animate a silent recording too: a face at rest");
  command->add_option(
      "--flame", a->flame,
      "FLAME model (generic_model.pkl or .npz) that makes a face of ProbTalk3D's parameters: .npy, "
      ".glb, meshes and pictures then show its vertices; .csv and .json stay parameters. With --character, "
      "whose topology is FLAME's, all outputs are ARKit coefficients of it");
  command->add_option("--flame-rig", a->flame_rig,
                      "Face of FLAME's topology with ARKit shapes (see mien transfer): ProbTalk3D then moves "
                      "any --character, "
                      "by the coefficients of this one that come closest to its vertices");
  add_vertex_options(*command, a->vertices);
  add_other_face_options(*command, a->vertices);
  add_threads_option(*command, a->threads);
  add_console_options(*command, chosen);
  add_footer(
      *command,
      "  mien animate hello.wav\n"
      "  mien animate lines/*.wav -o takes/ --takes 3\n"
      "  mien animate a.wav b.wav -o '{name}.csv' -o '{name}.mp4'\n"
      "  mien animate hello.wav -o hello.glb -o hello.csv -o hello.mp4 --emotion happy:2 --seed 7\n"
      "  mien animate hello.wav --emotions all:3 --times 0.4,0.8,1.2 -o emotions.png -o emotions.mp4\n"
      "  mien animate hello.wav --model biwi.safetensors --subject M3 --skip 450 -o hello.npy\n"
      "  mien animate hello.wav --model said.safetensors --steps 50 --guidance 2 -o hello.said.csv\n"
      "  mien animate hello.wav --model probtalk3d.safetensors --style W028 --emotion happy:3 --takes 10 "
      "-o hello.npy\n"
      "  mien animate hello.wav --model probtalk3d.safetensors --flame generic_model.pkl --flame-rig "
      "flame_rig.glb --character hero.glb -o hello.glb -o hello.csv\n"
      "  mien animate hello.wav --model voca.safetensors --mesh FLAME_sample.ply -o hello.glb -o "
      "hello.mp4\n");
  command->callback(
      [a, &chosen] { chosen.work = [a](ConsoleProgress& progress) { return run_animate(*a, progress); }; });
}

}  // namespace mien

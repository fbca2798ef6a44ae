#include "animate_clip.h"

#include <algorithm>
#include <limits>

#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/face/flame.h"
#include "mien/io/motion_file.h"
#include "mien/models/animate.h"
#include "take_files.h"
#include "vertex_outputs.h"

namespace mien {
namespace {

constexpr std::string_view kSilent = "the recording is silent";  // the reader's warning (mien/audio)

constexpr double kCurvesFps = 60;  // of coefficients made of FLAME parameters, as of the default model

using Takes = std::vector<TakeFiles>;

Motion empty_motion(const Performer& performer) {
  if (const auto* face = std::get_if<FaceModel>(&performer)) return face->empty_motion();
  if (const auto* said = std::get_if<SaidModel>(&performer)) return said->empty_motion();
  return empty_default_motion();
}

// SAiD sees the whole clip, or a window of it, at once, so its frames do not come one by one.
Status perform_said(const AnimateArguments& a, const AnimatePlan& p, const SaidModel& model,
                    AudioReader& speech, Progress& progress, const FrameSink& sink) {
  MIEN_TRY(const AudioClip clip, read_all(speech));
  SaidOptions options = p.said;
  std::optional<KeptValues> start;
  Status status = Done{};
  if (!a.said.init.empty()) {
    MIEN_TRY(const Motion motion, read_motion(a.said.init));
    auto values = start_values(motion, model.empty_motion());
    if (!values) return within(values.error(), "--init '" + a.said.init + "'");
    status.warnings = values.warnings;
    start = std::move(*values);
    options.known = &*start;
  }
  const auto takes = animate(model, clip, options, a.takes, a.threads, progress);
  if (!takes) return takes.error();
  status.warnings.insert(status.warnings.end(), takes.warnings.begin(), takes.warnings.end());
  for (int take = 0; take < a.takes; ++take) {
    MIEN_TRY([[maybe_unused]] const auto taken, sink(take, (*takes)[static_cast<std::size_t>(take)].values));
  }
  return status;
}

FrameSink sink_of(Takes& takes) {
  return [&takes](int take, std::span<const float> frames) {
    return takes[static_cast<std::size_t>(take)].add(frames);
  };
}

// Speech to the frames of all takes.
Status perform(const AnimateArguments& a, const AnimatePlan& p, const Performer& performer,
               AudioReader& speech, Takes& takes, Progress& progress) {
  const FrameSink sink = sink_of(takes);
  if (const auto* face = std::get_if<FaceModel>(&performer))
    return animate(*face, speech, p.face, a.takes, a.threads, progress, sink);
  if (const auto* said = std::get_if<SaidModel>(&performer))
    return perform_said(a, p, *said, speech, progress, sink);
  return animate(std::get<DefaultModel>(performer), speech, p.options, a.takes, a.threads, progress, sink);
}

// One output that needs the whole motion.
Status write_whole(const AnimatePlan& p, const ClipPlan& clip, const Output& output, const Motion& motion,
                   const AudioClip* sound, ConsoleProgress& progress) {
  if (p.mesh)
    return write_vertex_output(output, motion, *p.mesh, p.vertices, {p.pictures, sound, clip.audio_name()},
                               progress);
  if (output.is_picture()) return write_pictures(output, motion, *p.character, sound, p.pictures, progress);
  return write_motion(output.path, motion,
                      {.character_glb = p.character_glb, .audio_name = clip.audio_name(), .glb = {}});
}

// Coefficients of a rig for the FLAME parameters of a take.
Result<Motion> curves_of_flame(const AnimateArguments& a, const AnimatePlan& p, const Motion& parameters,
                               int take, ConsoleProgress& progress) {
  MIEN_TRY(FitResult fitted, p.flame_rig->curves(parameters, a.fps > 0 ? a.fps : kCurvesFps, progress));
  double sum = 0;
  for (const double r : fitted.residual) sum += r;
  const double mm = fitted.residual.empty() ? 0 : 1000 * sum / static_cast<double>(fitted.residual.size());
  progress.say((a.takes > 1 ? "take " + std::to_string(take + 1) + ": c" : "c") +
               "oefficients of the rig leave " + fixed(mm, 3) + " mm of FLAME's movement (root mean square)");
  progress.event("fitted", "\"take\":" + std::to_string(take + 1) + ",\"residual_mm\":" + fixed(mm, 6));
  return std::move(fitted.coefficients);
}

// What an output shows that is not the model's own motion.
Result<Motion> derived(const AnimateArguments& a, const AnimatePlan& p, const Motion& motion, int take,
                       ConsoleProgress& progress) {
  if (p.flame_face == FlameFace::rig) return curves_of_flame(a, p, motion, take, progress);
  if (p.flame_face == FlameFace::none) return on_other_face(motion, *p.mesh, p.other_face);
  MIEN_TRY(Motion vertices, flame_vertices(FlamePoser(*p.flame), motion, a.threads));
  return on_other_face(std::move(vertices), *p.mesh, p.other_face);
}

// All outputs of all takes: first the files that are only to be finished, then those that need the whole
// motion, then the pictures.
Status write_outputs(const AnimateArguments& a, const AnimatePlan& p, const ClipPlan& clip, Takes& takes,
                     const AudioClip* sound, ConsoleProgress& progress) {
  for (std::size_t take = 0; take < takes.size(); ++take) {
    const Status finished = takes[take].finish();
    if (!finished) return finished.error();
    for (const auto& warning : finished.warnings)
      if (take == 0) progress.warn(warning);
  }
  for (const bool pictures : {false, true})
    for (int take = 0; take < a.takes; ++take) {
      std::optional<Motion> made;  // of this take, for the first output that is derived
      for (const Output& output : clip.of_take(take, a.takes)) {
        if (output.is_picture() != pictures || TakeFiles::is_streamed(output)) continue;
        const Motion& motion = takes[static_cast<std::size_t>(take)].motion();
        if (output.is_derived && !made) {
          MIEN_TRY(made, derived(a, p, motion, take, progress));
        }
        const Status written =
            write_whole(p, clip, output, output.is_derived ? *made : motion, sound, progress);
        if (!written) return written.error();
        for (const auto& warning : written.warnings)
          if (take == 0) progress.warn(p.mesh ? warning : output.path.string() + ": " + warning);
      }
    }
  return Done{};
}

Result<std::optional<AudioClip>> sound_for(const ClipPlan& clip) {
  for (const auto& output : clip.outputs) {
    if (output.kind != OutputKind::video) continue;
    MIEN_TRY(AudioClip sound, load_audio(clip.speech));
    return std::optional<AudioClip>(std::move(sound));
  }
  return std::optional<AudioClip>();
}

// A recording at work.
struct OpenClip {
  AudioReader speech;
  Takes takes;
};

Result<OpenClip> open_clip(const AnimateArguments& a, const AnimatePlan& p, const Performer& performer,
                           const ClipPlan& clip) {
  MIEN_TRY(AudioReader speech, AudioReader::open(clip.speech));
  Takes takes;
  for (int take = 0; take < a.takes; ++take) {
    // Coefficients of a rig are brought to --fps after they were fitted.
    MIEN_TRY(TakeFiles files, TakeFiles::create(clip.of_take(take, a.takes), empty_motion(performer),
                                                p.flame_rig ? 0 : a.fps, clip.audio_name()));
    takes.push_back(std::move(files));
  }
  return OpenClip{std::move(speech), std::move(takes)};
}

// After the last frame: the takes are whole.
Status end_clip(const AnimateArguments& a, const ClipPlan& clip, OpenClip& open, const Status& performed,
                ConsoleProgress& progress) {
  const std::string what = "animating '" + clip.speech.string() + "'";
  if (!performed) return within(performed.error(), what);
  for (const auto& warning : performed.warnings) progress.warn(warning);
  for (const auto& warning : open.speech.warnings()) {
    if (warning == kSilent && !a.allow_silence)
      return Error{Errc::input, "'" + clip.speech.string() + "'", warning,
                   "Pass --allow-silence to get a face at rest"};
    progress.warn(warning);
  }
  for (TakeFiles& take : open.takes)
    if (const Status ended = take.end(); !ended) return within(ended.error(), what);
  return Done{};
}

// From the last frame to the files. @return seconds of speech
Result<double> finish_clip(const AnimateArguments& a, const AnimatePlan& p, const ClipPlan& clip,
                           OpenClip& open, const Status& performed, ConsoleProgress& progress) {
  MIEN_TRY([[maybe_unused]] const auto ended, end_clip(a, clip, open, performed, progress));
  MIEN_TRY(const auto sound, sound_for(clip));
  MIEN_TRY([[maybe_unused]] const auto written,
           write_outputs(a, p, clip, open.takes, sound ? &*sound : nullptr, progress));
  return open.takes.front().seconds();
}

}  // namespace

Result<Performer> load_performer(const AnimateArguments& a, const AnimatePlan& p) {
  if (p.system == AnimatePlan::System::standard) {
    MIEN_TRY(DefaultModel model, DefaultModel::load(p.model_path));
    return Performer(std::move(model));
  }
  MIEN_TRY(const EncoderPrecision precision, encoder_precision(a.face));
  if (p.system == AnimatePlan::System::said) {
    MIEN_TRY(SaidModel model, SaidModel::load(p.model_path, precision));
    return Performer(std::move(model));
  }
  MIEN_TRY(FaceModel model, FaceModel::load(p.model_path, a.threads, precision));
  return Performer(std::move(model));
}

std::size_t num_clips_together(const AnimateArguments& a, const Performer& performer,
                               std::span<const ClipPlan> next) {
  constexpr std::size_t kLanes = 8;  // more gain little: docs/performance.md
  if (!std::holds_alternative<FaceModel>(performer)) return 1;
  std::size_t count = 0;
  for (const ClipPlan& clip : next.first(std::min(next.size(), kLanes / static_cast<std::size_t>(a.takes)))) {
    const auto speech = AudioReader::open(clip.speech);
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    if (speech && speech->info().seconds.value_or(kUnknown) > kLongSpeech_s)
      break;  // much memory for features
    ++count;
  }
  return std::max<std::size_t>(count, 1);
}

std::vector<Result<double>> animate_clips(const AnimateArguments& a, const AnimatePlan& p,
                                          const Performer& performer, std::span<const ClipPlan> clips,
                                          ConsoleProgress& progress) {
  std::vector<Result<OpenClip>> open;
  for (const ClipPlan& clip : clips) open.push_back(open_clip(a, p, performer, clip));
  std::vector<Status> performed(clips.size(), Status(Done{}));
  if (clips.size() == 1) {
    if (open[0]) performed[0] = perform(a, p, performer, open[0]->speech, open[0]->takes, progress);
  } else {
    std::vector<FaceClip> together;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      if (!open[i]) continue;
      together.push_back({&open[i]->speech, sink_of(open[i]->takes)});
      places.push_back(i);
    }
    auto done = animate(std::get<FaceModel>(performer), together, p.face, a.takes, a.threads, progress);
    for (std::size_t i = 0; i < places.size(); ++i) performed[places[i]] = std::move(done[i]);
  }
  std::vector<Result<double>> seconds;
  for (std::size_t i = 0; i < clips.size(); ++i)
    seconds.push_back(open[i] ? finish_clip(a, p, clips[i], *open[i], performed[i], progress)
                              : Result<double>(open[i].error()));
  return seconds;
}

Result<double> show_emotions(const AnimateArguments& a, AnimatePlan& p, const Performer& performer,
                             const std::vector<std::string>& emotions, ConsoleProgress& progress) {
  const ClipPlan& clip = p.clips.front();
  std::vector<Motion> motions;
  double seconds = 0;
  for (const std::string& emotion : emotions) {
    MIEN_TRY([[maybe_unused]] const auto planned, plan_emotion(a, emotion, p));
    MIEN_TRY(OpenClip open, open_clip(a, p, performer, clip));
    const Status performed = perform(a, p, performer, open.speech, open.takes, progress);
    MIEN_TRY([[maybe_unused]] const auto ended, end_clip(a, clip, open, performed, progress));
    const TakeFiles& take = open.takes.front();
    seconds = take.seconds();
    motions.push_back(take.motion());
    if (clip.outputs.front().is_derived) {
      MIEN_TRY(motions.back(), derived(a, p, take.motion(), 0, progress));
    }
  }
  MIEN_TRY(const auto sound, sound_for(clip));
  PictureOptions pictures = p.pictures;
  pictures.labels = emotions;
  std::vector<const Motion*> shown;
  for (const Motion& motion : motions) shown.push_back(&motion);
  for (const Output& output : clip.outputs) {
    const AudioClip* heard = sound ? &*sound : nullptr;
    const Status drawn =
        p.mesh ? write_vertex_pictures(output, motions, *p.mesh, p.vertices, heard, pictures, progress)
               : write_pictures(output, shown, *p.character, heard, pictures, progress);
    if (!drawn) return drawn.error();
    for (const auto& warning : drawn.warnings) progress.warn(warning);
  }
  return seconds;
}

}  // namespace mien

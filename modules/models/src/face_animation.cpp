#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "choose_name.h"
#include "face_parts.h"
#include "mien/base/parallel.h"
#include "mien/models/alignment.h"
#include "mien/models/facediffuser/frame_diffusion.h"
#include "mien/models/seeds.h"
#include "mien/motion/diffusion_process.h"
#include "probtalk3d/animate.h"
#include "probtalk3d/style_choice.h"

namespace mien {
namespace {

constexpr std::uint32_t kNoiseStream = 2;  // of the diffusion; the default model has 1
constexpr std::int64_t kBlockFrames = 128;

// What the words mean for this model.
struct Conditions {
  std::int64_t emotion = 0;
  Tensor style;    // weights of the style's columns, [1, columns]; empty for networks without
  Tensor neutral;  // [1, D]; empty for networks without
};

Result<Conditions> conditions(const FaceModel::Parts& model, const FaceOptions& options) {
  const ModelFile& d = model.description;
  Conditions c;
  // Also of the emotional FaceDiffuser on ARKit's curves, whose face at rest is zero.
  const bool is_styled = model.vertices != nullptr || model.facexhubert != nullptr;
  MIEN_TRY(const std::int64_t subject,
           choose_name("--style", options.style, is_styled ? d.subjects : std::vector<std::string>(), 0));
  if (!d.intensities.empty()) {
    MIEN_TRY(const auto weights, probtalk3d::chosen_style(d, options));
    c.style = Tensor({1, static_cast<std::int64_t>(weights.size())}, weights);
  } else {
    MIEN_TRY(c.emotion, choose_name("--emotion", options.emotion, d.emotions,
                                    d.emotions.empty() ? 0 : d.emotions.size() - 1));
    if (is_styled)
      c.style = Operations<Tensor>::one_hot({}, subject, static_cast<std::int64_t>(d.subjects.size()));
  }
  std::vector<std::string> names;
  for (const auto& neutral : model.neutrals) names.push_back(neutral.first);
  std::string own = options.neutral;
  if (own.empty() && is_styled && model.neutral(d.subjects[static_cast<std::size_t>(subject)]) != nullptr)
    own = d.subjects[static_cast<std::size_t>(subject)];
  MIEN_TRY(const std::int64_t face, choose_name("--template", own, names, 0));
  if (is_styled)
    c.neutral = names.empty() ? Tensor({1, d.output.channels})
                              : model.neutrals[static_cast<std::size_t>(face)].second;
  return c;
}

// Gives each take its frames. The first take with an error speaks.
Status hand_out(int num_takes, int num_threads, const FrameSink& sink,
                const std::function<std::span<const float>(int take)>& frames_of) {
  std::vector<Status> taken(static_cast<std::size_t>(num_takes), Status(Done{}));
  parallel_for(num_threads, num_takes, [&](std::int64_t take) {
    taken[static_cast<std::size_t>(take)] = sink(static_cast<int>(take), frames_of(static_cast<int>(take)));
  });
  for (auto& status : taken)
    if (!status) return status;
  return Done{};
}

// What an edit keeps, in the range of the training data.
KeptValues scaled(const ModelFile& description, const KeptValues& kept) {
  std::vector<float> values, weights;
  for (std::int64_t n = 0; n < kept.num_frames(); ++n)
    for (std::int64_t c = 0; c < kept.num_channels(); ++c) {
      values.push_back(kept.value(n, c));
      weights.push_back(kept.weight(n, c));
    }
  if (description.scaler) apply_scaler(*description.scaler, values);
  return {kept.num_channels(), std::move(values), std::move(weights)};
}

// Makes frames from aligned features [count, f H], block after block.
using MakeFrames = std::function<Status(const Tensor& speech)>;

// Features as they arrive from the encoder, and the frames of animation that can be made of them. Holds a few
// blocks, however long the speech is.
class FeatureFeed {
 public:
  FeatureFeed(const Alignment& alignment, std::int64_t num_features, MakeFrames make, Progress& progress)
      : alignment_(alignment), num_features_(num_features), make_(std::move(make)), progress_(progress) {}

  void push(const Tensor& features) {
    waiting_ = waiting_.count() == 0 ? features : concat_rows(waiting_, features);
    while (status_ && next_frame_ < alignment_.num_frames) {
      const std::int64_t count = std::min(kBlockFrames, alignment_.num_frames - next_frame_);
      if (rows_needed(next_frame_ + count) > first_row_ + waiting_.num_rows()) break;
      if (progress_.cancelled()) {
        status_ = Error{Errc::cancelled, "animating", "interrupted", ""};
        break;
      }
      status_ = make_(block(next_frame_, count));
      next_frame_ += count;
      progress_.update(next_frame_);
      drop_used();
    }
  }
  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] bool is_finished() const { return next_frame_ == alignment_.num_frames; }

 private:
  // Rows of features that frames before `end` read.
  [[nodiscard]] std::int64_t rows_needed(std::int64_t end) const {
    if (alignment_.positions.empty()) return end * alignment_.group;
    const double last = alignment_.positions[static_cast<std::size_t>(end * alignment_.group - 1)];
    return std::min(static_cast<std::int64_t>(std::ceil(last)) + 1, num_features_);
  }
  [[nodiscard]] Tensor block(std::int64_t first, std::int64_t count) const {
    const std::int64_t group = alignment_.group;
    if (alignment_.positions.empty())
      return group_rows(rows(waiting_, first * group - first_row_, count * group), group);
    std::vector<double> positions;
    for (std::int64_t i = first * group; i < (first + count) * group; ++i)
      positions.push_back(alignment_.positions[static_cast<std::size_t>(i)] -
                          static_cast<double>(first_row_));
    return group_rows(interpolate_rows(waiting_, positions), group);
  }
  void drop_used() {
    if (next_frame_ >= alignment_.num_frames) return;
    const std::int64_t group = alignment_.group;
    const auto still =
        alignment_.positions.empty()
            ? next_frame_ * group
            : static_cast<std::int64_t>(alignment_.positions[static_cast<std::size_t>(next_frame_ * group)]);
    const std::int64_t used = std::min(still - first_row_, waiting_.num_rows());
    waiting_ = rows(waiting_, used, waiting_.num_rows() - used);
    first_row_ += used;
  }

  const Alignment& alignment_;
  std::int64_t num_features_;  // A of the whole speech
  MakeFrames make_;
  Progress& progress_;
  Tensor waiting_;  // [.., H], rows of features from first_row_ on
  std::int64_t first_row_ = 0, next_frame_ = 0;
  Status status_ = Done{};
};

Result<DiffusionProcess> diffusion_process(const FaceModel::Parts& model, const FaceOptions& options) {
  const ModelDiffusion& trained = *model.description.diffusion;
  const auto schedule = parse_beta_schedule(trained.schedule);
  if (!schedule)
    return Error{Errc::incompatible, "model", "has an unknown noise schedule '" + trained.schedule + "'", ""};
  const DiffusionProcess whole(betas_of(*schedule, trained.steps));
  MIEN_TRY(const auto kept, respaced_steps(options.respacing, whole.size()));
  const DiffusionProcess process = whole.respaced(kept);
  if (options.skip < 0 || options.skip >= process.size())
    return Error{Errc::usage, "--skip " + std::to_string(options.skip),
                 "must leave at least one of " + std::to_string(process.size()) + " steps", ""};
  return process;
}

SeededFrameNoise noise_of(int take, std::int64_t width, const FaceOptions& options) {
  return {performance_seed(options.seed, take), kNoiseStream, width, options.same_noise};
}

// One walk for all takes of all clips, side by side through the same weights.
class SharedWalk {
 public:
  SharedWalk(const FaceModel::Parts& model, const Conditions& given, const FaceOptions& options,
             const DiffusionProcess& process, std::size_t num_clips, int num_takes, int num_threads)
      : model_(model), num_takes_(num_takes), num_threads_(num_threads) {
    for (int take = 0; take < num_takes; ++take)
      noise_.push_back(noise_of(take, model.folded->noise_width, options));
    std::vector<facediffuser::Lane> lanes;
    for (std::size_t lane = 0; lane < num_clips * noise_.size(); ++lane) {
      facediffuser::Lane own;
      own.noise = &noise_[lane % noise_.size()];
      if (model.vertices != nullptr) {
        own.style = model.vertices->style(given.style);
        own.neutral = given.neutral;
      }
      lanes.push_back(std::move(own));
    }
    if (options.kept) kept_ = scaled(model.description, *options.kept);
    diffusion_.emplace(model.folded, process,
                       facediffuser::Walk{options.sampler, options.skip, kept_ ? &*kept_ : nullptr},
                       std::move(lanes), num_threads);
  }
  SharedWalk(const SharedWalk&) = delete;
  SharedWalk& operator=(const SharedWalk&) = delete;

  // The next frames. @param speech  of each clip aligned features [F, f H], F equal
  void advance(std::span<const Tensor> speech) {
    std::vector<Tensor> lanes;
    for (const Tensor& clip : speech) lanes.insert(lanes.end(), noise_.size(), clip);
    frames_ = diffusion_->next(lanes);
  }
  // The first `count` of the last frames of a clip.
  Status hand_out_clip(std::size_t clip, std::int64_t count, const FrameSink& sink) {
    return hand_out(num_takes_, num_threads_, sink, [&](int take) -> std::span<const float> {
      Tensor& own = frames_[clip * noise_.size() + static_cast<std::size_t>(take)];
      if (model_.description.scaler) undo_scaler(*model_.description.scaler, own.values());
      return own.values().first(static_cast<std::size_t>(count * own.width()));
    });
  }

 private:
  const FaceModel::Parts& model_;
  int num_takes_, num_threads_;
  std::vector<SeededFrameNoise> noise_;  // by take
  std::optional<KeptValues> kept_;
  std::optional<facediffuser::FrameDiffusion> diffusion_;
  std::vector<Tensor> frames_;  // clip by clip, of each take [F, D]
};

Result<MakeFrames> diffusing(const FaceModel::Parts& model, const Conditions& given,
                             const FaceOptions& options, int num_takes, int num_threads,
                             const FrameSink& sink) {
  MIEN_TRY(const DiffusionProcess process, diffusion_process(model, options));
  const auto walk = std::make_shared<SharedWalk>(model, given, options, process, 1, num_takes, num_threads);
  return MakeFrames([&sink, walk](const Tensor& speech) -> Status {
    walk->advance(std::span(&speech, 1));
    return walk->hand_out_clip(0, speech.num_rows(), sink);
  });
}

// Makes all frames at once, when the speech of the whole clip is there: for what has no fast path.
MakeFrames at_the_end(std::int64_t num_frames, MakeFrames make) {
  const auto speech = std::make_shared<Tensor>();
  return [speech, num_frames, make = std::move(make)](const Tensor& block) -> Status {
    *speech = speech->count() == 0 ? block : concat_rows(*speech, block);
    return speech->num_rows() < num_frames ? Status(Done{}) : make(*speech);
  };
}

// Ablations of FaceDiffuser: the plain sampler, or no diffusion.
template <class Network>
Result<MakeFrames> diffusing_plainly(const FaceModel::Parts& model, std::shared_ptr<const Network> network,
                                     const Conditions& given, const FaceOptions& options, int num_takes,
                                     Progress& progress, const FrameSink& sink) {
  std::optional<DiffusionProcess> process;
  if (network->sizes.is_diffusion()) {
    MIEN_TRY(process, diffusion_process(model, options));
  }
  return MakeFrames([&model, network, given, options, num_takes, &progress, &sink,
                     process](const Tensor& speech) -> Status {
    facediffuser::Conditions<Tensor> conditions{network->speech_tokens(speech), {}, {}};
    if constexpr (std::is_same_v<Network, facediffuser::VertexDenoiser<Tensor>>) {
      conditions.style = network->style(given.style);
      conditions.neutral = given.neutral;
    }
    // After an interruption the rest of a walk costs nothing.
    const auto denoise = [&](const Tensor& x_t, std::int64_t step) {
      return progress.cancelled() ? x_t : network->predict_x0(x_t, conditions, step);
    };
    std::optional<KeptValues> kept;
    if (options.kept) kept = scaled(model.description, *options.kept);
    const facediffuser::Walk walk{options.sampler, options.skip, kept ? &*kept : nullptr};
    for (int take = 0; take < num_takes; ++take) {
      const std::int64_t width = network->sizes.num_channels;
      Tensor frames = process ? facediffuser::sample_plainly(denoise, speech.num_rows(), width, *process,
                                                             walk, noise_of(take, width, options))
                              : network->predict_x0({}, conditions, 0);
      if (progress.cancelled()) return Error{Errc::cancelled, "animating", "interrupted", ""};
      if (model.description.scaler) undo_scaler(*model.description.scaler, frames.values());
      MIEN_TRY([[maybe_unused]] const auto written, sink(take, frames.values()));
    }
    return Done{};
  });
}

MakeFrames predicting(const FaceModel::Parts& model, const Conditions& given, int num_takes, int num_threads,
                      const FrameSink& sink) {
  const auto& sizes = model.facexhubert->sizes;
  const Tensor emotion = Operations<Tensor>::one_hot({}, given.emotion, sizes.num_emotions);
  // Recurrent decoders read the clip block after block.
  const auto past =
      model.facexhubert->decoder.is_recurrent() ? std::make_shared<std::vector<Tensor>>() : nullptr;
  return [&model, &sink, subject = given.style, emotion, neutral = given.neutral, past, num_takes,
          num_threads](const Tensor& speech) -> Status {
    const Tensor frames = (*model.facexhubert)(speech, subject, emotion, neutral, past.get());
    // It has no randomness: takes are equal.
    return hand_out(num_takes, num_threads, sink, [&](int) { return frames.values(); });
  };
}

// Speech that was read once, for its loudness and length.
struct HeardSpeech {
  SpeechStatistics statistics;
  std::int64_t num_features;
  Alignment alignment;
  double seconds;
};

Result<HeardSpeech> hear(const FaceModel::Parts& model, SampleSource& speech) {
  MIEN_TRY(SpeechStatistics statistics, model.encoder.hear(speech));
  const double fps = model.description.output.fps;
  const std::int64_t num_samples = statistics.samples.num_samples();
  const std::int64_t num_features = model.encoder.config().num_frames(num_samples);
  const bool is_diffusion = model.facexhubert == nullptr;
  Alignment alignment = align_features(
      num_features, is_diffusion ? num_diffuser_frames(num_samples, fps) : num_features / 2, fps);
  if (alignment.num_frames < 1)
    return Error{Errc::input, "speech",
                 "is too short: " + std::to_string(num_samples) + " samples at 16 kHz give no frame",
                 "At least two frames' time is needed"};
  return HeardSpeech{std::move(statistics), num_features, std::move(alignment),
                     static_cast<double>(num_samples) / kModelSampleRateHz};
}

// Reads the speech again and makes its frames, block after block, in a stage of the progress called `stage`.
Status encode(const FaceModel::Parts& model, SampleSource& speech, const HeardSpeech& heard,
              const FaceOptions& options, int num_threads, MakeFrames make, const char* stage,
              Progress& progress) {
  progress.stage("encoding", 0);
  FeatureFeed feed(heard.alignment, heard.num_features, std::move(make), progress);
  const bool is_long = !options.windows && heard.seconds > kLongSpeech_s;
  const EncodeOptions encoding{
      .num_threads = num_threads,
      .num_frames = 0,
      .windows = is_long ? windows_of(kLongSpeechWindow_s) : options.windows.value_or(EncoderWindows()),
      .on_hidden = {}};
  bool is_first = true;
  const Status encoded =
      model.encoder.encode(speech, heard.statistics, encoding, [&](const Tensor& features) {
        if (std::exchange(is_first, false)) progress.stage(stage, heard.alignment.num_frames);
        if (feed.status()) feed.push(features);
      });
  if (!encoded) return encoded.error();
  if (!feed.status()) return feed.status().error();
  contract(feed.is_finished(), "animate: the encoder gave fewer frames than its configuration says");
  Status status = Done{};
  if (is_long) status.warnings.push_back(windows_warning(heard.seconds));
  return status;
}

// `count` rows of a block, or zeros where there is none: a clip that has ended waits for the longer ones.
Tensor padded(const std::vector<Tensor>& blocks, std::size_t block, std::int64_t count, std::int64_t width) {
  Tensor out({count, width});
  if (block < blocks.size()) std::copy_n(blocks[block].data(), blocks[block].count(), out.data());
  return out;
}

// The walk of several clips. @param blocks  of each clip; of one that failed: none
void walk_together(SharedWalk& walk, std::span<const FaceClip> clips,
                   const std::vector<std::vector<Tensor>>& blocks, Progress& progress,
                   std::vector<Status>& done) {
  const auto fail_all = [&](const Error& error) {
    for (std::size_t clip = 0; clip < clips.size(); ++clip)
      if (done[clip]) done[clip] = error;
  };
  std::size_t num_blocks = 0;
  std::int64_t num_frames = 0, width = 0;
  for (const auto& own : blocks) num_blocks = std::max(num_blocks, own.size());
  for (const auto& own : blocks)
    if (!own.empty()) width = own.front().width();
  progress.stage("animating", static_cast<std::int64_t>(num_blocks) * kBlockFrames);
  for (std::size_t block = 0; block < num_blocks; ++block) {
    if (progress.cancelled()) return fail_all({Errc::cancelled, "animating", "interrupted", ""});
    std::int64_t count = 0;
    for (const auto& own : blocks)
      if (block < own.size()) count = std::max(count, own[block].num_rows());
    std::vector<Tensor> speech;
    for (const auto& own : blocks) speech.push_back(padded(own, block, count, width));
    walk.advance(speech);
    for (std::size_t clip = 0; clip < clips.size(); ++clip) {
      if (!done[clip] || block >= blocks[clip].size()) continue;
      const Status taken = walk.hand_out_clip(clip, blocks[clip][block].num_rows(), clips[clip].sink);
      if (!taken) done[clip] = taken.error();
    }
    progress.update(num_frames += kBlockFrames);
  }
}

}  // namespace

std::vector<Status> animate(const FaceModel& model, std::span<const FaceClip> clips,
                            const FaceOptions& options, int num_takes, int num_threads, Progress& progress) {
  const FaceModel::Parts& parts = model.parts();
  std::vector<Status> done;
  if (parts.folded == nullptr || clips.size() < 2) {
    for (const FaceClip& clip : clips)
      done.push_back(animate(model, *clip.speech, options, num_takes, num_threads, progress, clip.sink));
    return done;
  }
  contract(num_takes >= 1 && options.kept == nullptr,
           "animate: at least one take is needed, and an edit is of one clip");
  const auto given = conditions(parts, options);
  const auto process = diffusion_process(parts, options);
  if (!given || !process) return std::vector<Status>(clips.size(), given ? process.error() : given.error());
  std::vector<std::vector<Tensor>> blocks(clips.size());
  const auto listen = [&](std::size_t clip) -> Status {
    MIEN_TRY(const HeardSpeech heard, hear(parts, *clips[clip].speech));
    const auto keep = [&](const Tensor& block) -> Status {
      blocks[clip].push_back(block);
      return Done{};
    };
    return encode(parts, *clips[clip].speech, heard, options, num_threads, keep, "encoding", progress);
  };
  for (std::size_t clip = 0; clip < clips.size(); ++clip) {
    done.push_back(listen(clip));
    if (!done.back()) blocks[clip].clear();
  }
  SharedWalk walk(parts, *given, options, *process, clips.size(), num_takes, num_threads);
  walk_together(walk, clips, blocks, progress, done);
  return done;
}

Status animate(const FaceModel& model, SampleSource& speech, const FaceOptions& options, int num_takes,
               int num_threads, Progress& progress, const FrameSink& sink) {
  contract(num_takes >= 1, "animate: at least one take is needed");
  const FaceModel::Parts& parts = model.parts();
  if (parts.probtalk3d != nullptr)
    return probtalk3d::animate(parts, speech, options, num_takes, num_threads, progress, sink);
  MIEN_TRY(const Conditions given, conditions(parts, options));
  progress.stage("hearing", 0);
  MIEN_TRY(const HeardSpeech heard, hear(parts, speech));
  MakeFrames make;
  const auto plainly = [&](const auto& network) -> Status {
    MIEN_TRY(MakeFrames all, diffusing_plainly(parts, network, given, options, num_takes, progress, sink));
    make = at_the_end(heard.alignment.num_frames, std::move(all));
    return Done{};
  };
  Status is_ready = Done{};
  if (parts.facexhubert != nullptr) {
    make = predicting(parts, given, num_takes, num_threads, sink);
    if (!parts.facexhubert->decoder.is_recurrent())
      make = at_the_end(heard.alignment.num_frames, std::move(make));
  } else if (parts.folded != nullptr) {
    MIEN_TRY(make, diffusing(parts, given, options, num_takes, num_threads, sink));
  } else {
    is_ready = parts.vertices != nullptr ? plainly(parts.vertices)
               : parts.beat != nullptr   ? plainly(parts.beat)
                                         : plainly(parts.damm);
  }
  if (!is_ready) return is_ready.error();
  return encode(parts, speech, heard, options, num_threads, std::move(make), "animating", progress);
}

Result<std::vector<Motion>> animate(const FaceModel& model, const AudioClip& clip, const FaceOptions& options,
                                    int num_takes, int num_threads, Progress& progress) {
  contract(clip.sample_rate_hz == kModelSampleRateHz, "animate: the clip must be at 16 kHz");
  SamplesInMemory speech(clip.samples);
  std::vector<Motion> motions(static_cast<std::size_t>(std::max(num_takes, 1)), model.empty_motion());
  const Status status = animate(model, speech, options, num_takes, num_threads, progress,
                                [&](int take, std::span<const float> values) -> Status {
                                  auto& own = motions[static_cast<std::size_t>(take)].values;
                                  own.insert(own.end(), values.begin(), values.end());
                                  return Done{};
                                });
  if (!status) return status.error();
  Result<std::vector<Motion>> result(std::move(motions));
  result.warnings = status.warnings;
  return result;
}

}  // namespace mien

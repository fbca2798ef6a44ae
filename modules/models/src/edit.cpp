#include "mien/models/edit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mien/base/hash.h"
#include "mien/base/number_text.h"
#include "mien/motion/kept_join.h"

namespace mien {
namespace {

// Of so many tries for each take, the one with the smoothest joins is taken for each stretch: the past
// decides what a model makes, and chance whether that leads to what is kept after it.
constexpr int kTries = 8;
constexpr double kSameLength = 0.1;  // seconds: files of one recording may differ by a few frames

std::uint64_t edit_seed(std::uint64_t seed) { return hash_combine(seed, hash64("edit")); }

// Which channel of the motion each channel of the model is; nothing where the motion lacks it. Controls
// without names (a .npy of a rig) go by their place.
std::vector<std::optional<std::int64_t>> channels_in(const Motion& motion, const Motion& model) {
  std::vector<std::optional<std::int64_t>> found(static_cast<std::size_t>(model.num_channels()));
  const bool is_mesh = motion.space == MotionSpace::vertices;
  if (is_mesh != (model.space == MotionSpace::vertices)) return found;
  bool any = false;
  for (std::size_t c = 0; c < found.size() && !is_mesh; ++c) {
    found[c] = motion.find(model.channels[c]);
    any |= found[c].has_value();
  }
  const bool by_place =
      is_mesh || (motion.space == MotionSpace::rig && model.space == MotionSpace::rig && !any);
  if (by_place && motion.num_channels() == model.num_channels())
    for (std::size_t c = 0; c < found.size(); ++c) found[c] = static_cast<std::int64_t>(c);
  return found;
}

// The values of a motion and what is kept of them as the model has frames and channels; what the motion lacks
// is free.
std::shared_ptr<const KeptValues> as_model(const KeptValues& kept, const Motion& motion,
                                           const std::vector<std::optional<std::int64_t>>& channels,
                                           double fps) {
  const std::int64_t num_frames = num_motion_frames(motion.seconds(), fps);
  std::vector<float> values(static_cast<std::size_t>(num_frames) * channels.size()), weights(values.size());
  for (std::int64_t n = 0; n < num_frames; ++n) {
    const double at = static_cast<double>(n) / fps * motion.fps;
    const std::int64_t before = std::min(static_cast<std::int64_t>(at + 1e-6), motion.num_frames() - 1);
    const std::int64_t after =
        std::min(before + (at - static_cast<double>(before) > 1e-6 ? 1 : 0), motion.num_frames() - 1);
    const auto share = static_cast<float>(std::max(at - static_cast<double>(before), 0.0));
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (!channels[c]) continue;
      const std::int64_t own = *channels[c];
      const std::size_t i = static_cast<std::size_t>(n) * channels.size() + c;
      values[i] = after == before ? kept.value(before, own)
                                  : (1 - share) * kept.value(before, own) + share * kept.value(after, own);
      weights[i] = std::min(kept.weight(before, own), kept.weight(after, own));
    }
  }
  return std::make_shared<KeptValues>(static_cast<std::int64_t>(channels.size()), std::move(values),
                                      std::move(weights));
}

// The edited motion, of what the model made for the whole of it.
Result<Motion> finish(const Motion& motion, KeptValues kept, const Motion& made,
                      const std::vector<std::optional<std::int64_t>>& channels) {
  if (std::abs(made.seconds() - motion.seconds()) > kSameLength)
    return Error{Errc::incompatible, "motion",
                 "lasts " + fixed(motion.seconds(), 2) + " s, the speech " + fixed(made.seconds(), 2) + " s",
                 "Pass the speech that the motion was made from"};
  const Motion at_rate = made.fps == motion.fps ? made : resample(made, motion.fps);
  Motion result = motion;
  std::vector<bool> is_made(static_cast<std::size_t>(motion.num_channels()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!channels[c]) continue;
    const auto own = static_cast<std::size_t>(*channels[c]);
    is_made[own] = true;
    for (std::int64_t n = 0; n < motion.num_frames(); ++n)
      result.frame(n)[own] = at_rate.frame(std::min(n, at_rate.num_frames() - 1))[c];
  }
  for (std::size_t c = 0; c < is_made.size(); ++c)
    if (!is_made[c]) kept.keep_channel(static_cast<std::int64_t>(c));
  join_kept(kept, result);
  return result;
}

// What the model and the motion have in common. Error (Errc::incompatible): nothing.
Result<std::vector<std::optional<std::int64_t>>> common_channels(const Motion& motion, const KeptValues& kept,
                                                                 const Motion& model) {
  contract(kept.num_frames() == motion.num_frames() && kept.num_channels() == motion.num_channels(),
           "edit: what is kept is of another motion");
  auto channels = channels_in(motion, model);
  if (std::none_of(channels.begin(), channels.end(), [](const auto& c) { return c.has_value(); }))
    return Error{Errc::incompatible, "motion",
                 "has " + std::to_string(motion.num_channels()) +
                     " channels, of which the model makes none of its " +
                     std::to_string(model.num_channels()),
                 "Name the model that made the motion with --model"};
  return channels;
}

// Runs of frames that are not kept entirely and lie between or beside frames that are.
std::vector<FrameRange> stretches_of(const KeptValues& kept) {
  std::vector<FrameRange> stretches;
  for (std::int64_t n = 0; n < kept.num_frames(); ++n) {
    if (kept.keeps_frame(n)) continue;
    if (stretches.empty() || stretches.back().end != n) stretches.push_back({n, n});
    ++stretches.back().end;
  }
  const bool has_joins = stretches.size() != 1 || stretches.front() != FrameRange{0, kept.num_frames()};
  return has_joins ? stretches : std::vector<FrameRange>();
}

// One motion of several tries: for each stretch that with the smoothest joins.
Motion smoothest(std::span<const Motion> tries, const KeptValues& kept,
                 std::span<const FrameRange> stretches) {
  Motion best = tries.front();
  for (const FrameRange& stretch : stretches) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Motion& one : tries) {
      const double roughness = join_roughness(kept, one, stretch);
      if (roughness >= lowest) continue;
      lowest = roughness;
      for (std::int64_t n = stretch.first; n < stretch.end; ++n)
        std::copy(one.frame(n).begin(), one.frame(n).end(), best.frame(n).begin());
    }
  }
  return best;
}

Result<std::vector<Motion>> finish_all(const Motion& motion, const KeptValues& kept,
                                       const std::vector<std::optional<std::int64_t>>& channels,
                                       Result<std::vector<Motion>> takes) {
  if (!takes) return takes;
  for (Motion& take : *takes) {
    MIEN_TRY(take, finish(motion, kept, take, channels));
  }
  return takes;
}

}  // namespace

Result<std::vector<Motion>> edit(const DefaultModel& model, AudioReader& speech, const Motion& motion,
                                 const KeptValues& kept, const PerformOptions& options, int num_takes,
                                 int num_threads, Progress& progress) {
  const Motion empty = empty_default_motion();
  MIEN_TRY(const auto channels, common_channels(motion, kept, empty));
  PerformOptions own = options;
  own.seed = edit_seed(options.seed);
  own.kept = as_model(kept, motion, channels, empty.fps);
  const std::vector<FrameRange> stretches = stretches_of(kept);
  const int num_tries = stretches.empty() ? 1 : kTries;
  std::vector<Motion> tries(static_cast<std::size_t>(num_takes * num_tries), empty);
  const FrameSink collect = [&](int take, std::span<const float> frames) -> Status {
    auto& values = tries[static_cast<std::size_t>(take)].values;
    values.insert(values.end(), frames.begin(), frames.end());
    return Done{};
  };
  MIEN_TRY([[maybe_unused]] const auto made,
           animate(model, speech, own, num_takes * num_tries, num_threads, progress, collect));
  for (Motion& one : tries) {
    MIEN_TRY(one, finish(motion, kept, one, channels));
  }
  Result<std::vector<Motion>> takes{std::vector<Motion>()};
  for (int take = 0; take < num_takes; ++take)
    takes->push_back(smoothest(std::span(tries).subspan(static_cast<std::size_t>(take * num_tries),
                                                        static_cast<std::size_t>(num_tries)),
                               kept, stretches));
  takes.warnings = speech.warnings();
  return takes;
}

Result<std::vector<Motion>> edit(const FaceModel& model, const AudioClip& speech, const Motion& motion,
                                 const KeptValues& kept, const FaceOptions& options, int num_takes,
                                 int num_threads, Progress& progress) {
  const Motion empty = model.empty_motion();
  MIEN_TRY(const auto channels, common_channels(motion, kept, empty));
  FaceOptions own = options;
  own.seed = edit_seed(options.seed);
  own.kept = as_model(kept, motion, channels, empty.fps);
  return finish_all(motion, kept, channels, animate(model, speech, own, num_takes, num_threads, progress));
}

Result<std::vector<Motion>> edit(const SaidModel& model, const AudioClip& speech, const Motion& motion,
                                 const KeptValues& kept, const SaidOptions& options, int num_takes,
                                 int num_threads, Progress& progress) {
  contract(options.known == nullptr && options.window.value_or(0) == 0,
           "edit: SAiD knows what is kept, in one window");
  const Motion empty = model.empty_motion();
  MIEN_TRY(const auto channels, common_channels(motion, kept, empty));
  const auto known = as_model(kept, motion, channels, empty.fps);
  SaidOptions own = options;
  own.seed = edit_seed(options.seed);
  own.known = known.get();
  return finish_all(motion, kept, channels, animate(model, speech, own, num_takes, num_threads, progress));
}

}  // namespace mien

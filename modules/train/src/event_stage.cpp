#include <cmath>

#include "chunk_sequence.h"
#include "mien/base/hash.h"
#include "mien/models/default/event_history.h"
#include "raise_target.h"

namespace mien::train {
namespace {

namespace dm = default_model;

}  // namespace

// An event that begins at a frame.
struct EventStage::Event {
  bool begins = false;
  float log_size = 0;
};

EventStage::EventStage(const TrainingSet& set, const ChunkFeatures& features, Network& network,
                       const DefaultTrainingOptions& options, Events events)
    : set_(set),
      features_(features),
      options_(options),
      events_(events),
      name_(events == Events::blinks ? "blink" : "brow"),
      path_(events == Events::blinks ? network.blink : network.brow),
      entries_(entries_of_at_least(set, options.sequence_chunks)) {}

std::vector<Collect::Entry> EventStage::parameters() {
  Collect collect;
  collect.scope(name_, path_);
  return collect.entries;
}

// Whether the path should let an event begin at frame n of an entry.
EventStage::Event EventStage::event_at(std::int64_t take, const TrainingSet::Entry& entry,
                                       std::int64_t n) const {
  if (n < 0 || n >= entry.num_frames) return {};
  if (events_ == Events::blinks) return {set_.blink_onset(take, entry.frame_start + n), 0};
  const float amplitude = raise_that_begins(set_, take, entry, n);
  if (amplitude <= 0) return {};
  return {true, static_cast<float>(std::log(static_cast<double>(amplitude) / dm::kTypicalRaise))};
}

torch::Tensor EventStage::loss(std::int64_t step) {
  const dm::EventKind& kind = path_.kind;
  const auto batch = draw_batch(set_, features_, entries_, options_,
                                hash_combine(hash64(name_, options_.seed), static_cast<std::uint64_t>(step)));
  const auto speech = speech_of_steps(batch.speech, kind);
  const std::int64_t num_batch = speech.size(0), num_steps = speech.size(1);
  std::vector<float> history, log_sizes;
  std::vector<std::int64_t> classes;
  for (const auto& sequence : batch.sequences) {
    const auto& entry = set_.entries()[sequence.entry];
    const std::int64_t first_step = sequence.first_chunk * (dm::kChunkFrames / kind.frames);
    dm::EventHistory past(kind);
    for (std::int64_t s = 0; s < first_step + num_steps; ++s) {
      int event_class = 0;
      float log_size = 0;
      for (std::int64_t f = 0; f < kind.frames && event_class == 0; ++f) {
        const Event event = event_at(sequence.take, entry, s * kind.frames + kind.offset + f);
        if (event.begins) event_class = static_cast<int>(f) + 1, log_size = event.log_size;
      }
      if (s >= first_step) {
        const auto numbers = past.numbers();
        history.insert(history.end(), numbers.begin(), numbers.end());
        classes.push_back(event_class);
        log_sizes.push_back(log_size);
      }
      past.add(event_class);
    }
  }
  const auto device = options_.device;
  auto state = torch::zeros({num_batch, 1, path_.hidden}, device);
  const auto history_tensor =
      torch::from_blob(history.data(), {num_batch, num_steps, kind.num_history()}).clone().to(device);
  const auto out = path_(speech, history_tensor, path_.condition(batch.condition), state).flatten(0, 1);
  const auto truth =
      torch::from_blob(classes.data(), {num_batch * num_steps}, torch::kLong).clone().to(device);
  const auto loss = torch::nn::functional::cross_entropy(out.narrow(-1, 0, kind.num_classes()), truth);
  if (!kind.has_size) return loss;
  // A size is normal with a known spread around what the path expects.
  const auto size = torch::from_blob(log_sizes.data(), {num_batch * num_steps}).clone().to(device);
  const auto error = (out.select(-1, kind.num_classes()) - size) / dm::kRaiseLogSpread;
  return loss + (0.5 * error.square() * (truth > 0)).mean();
}

}  // namespace mien::train

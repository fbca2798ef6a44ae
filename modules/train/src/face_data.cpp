#include "mien/train/face_data.h"

#include <algorithm>

#include "mien/core/emotion.h"
#include "mien/core/flame_parameters.h"
#include "mien/models/probtalk3d/conventions.h"
#include "sound_input.h"

namespace mien::train {
namespace {

constexpr int kLastNeutralSentence = 40;  // of FaceXHuBERT's BIWI

bool is_expressive(DatasetKind kind, const SequenceName& name) {
  return kind == DatasetKind::biwi ||
         (kind == DatasetKind::biwi_expressive && name.sentence > kLastNeutralSentence);
}

// Expressions and jaw out of all parameters, [N, 403] -> [N, num_expression + 3].
std::vector<float> expression_and_jaw(const Motion& all, std::int64_t num_expression) {
  constexpr std::size_t kJaw = kNumFlameShape + kNumFlameExpression;
  std::vector<float> kept;
  kept.reserve(static_cast<std::size_t>(all.num_frames()) *
               (static_cast<std::size_t>(num_expression) + kNumFlameJaw));
  for (std::int64_t n = 0; n < all.num_frames(); ++n) {
    const auto expression = all.frame(n).subspan(kNumFlameShape, static_cast<std::size_t>(num_expression));
    const auto jaw = all.frame(n).subspan(kJaw, kNumFlameJaw);
    kept.insert(kept.end(), expression.begin(), expression.end());
    kept.insert(kept.end(), jaw.begin(), jaw.end());
  }
  return kept;
}

// What the closure of FaceSequences holds.
struct Source {
  std::shared_ptr<const Dataset> dataset;
  FaceDataOptions options;
  std::vector<const DatasetSequence*> train, valid;

  [[nodiscard]] std::vector<float> style_of(const SequenceName& name) const {
    const auto num_subjects = static_cast<std::int64_t>(options.subjects.size());
    const std::int64_t subject = std::ranges::find(options.subjects, name.subject) - options.subjects.begin();
    if (!options.has_emotions) return one_hot_weights(subject, num_subjects);
    return mien::probtalk3d::style_weights(
        subject, num_subjects, name.emotion, kNumEmotions, name.intensity,
        static_cast<std::int64_t>(mien::probtalk3d::published_intensities().size()));
  }
  [[nodiscard]] Result<FaceSequence> load(const DatasetSequence& from) const {
    FaceSequence s;
    s.name = from.name;
    MIEN_TRY(s.waveform, heard_sound(from.audio, options.sound));
    MIEN_TRY(Motion motion, load_sequence(*dataset, from));
    s.motion = dataset->layout->space == MotionSpace::flame
                   ? expression_and_jaw(motion, options.num_expression)
                   : std::move(motion.values);
    if (options.scaler) apply_scaler(*options.scaler, s.motion);
    if (!options.subjects.empty()) s.style = style_of(from.parts);
    s.emotion = is_expressive(dataset->layout->kind, from.parts) ? 1 : 0;
    if (options.needs_neutral) s.neutral = dataset->templates.at(from.parts.subject);
    return s;
  }
};

}  // namespace

Result<FaceSequences> face_sequences(std::shared_ptr<const Dataset> dataset, FaceDataOptions options) {
  const auto source = std::make_shared<Source>(Source{std::move(dataset), std::move(options), {}, {}});
  const auto& subjects = source->options.subjects;
  const std::string folder = "'" + source->dataset->folder.string() + "'";
  for (const DatasetSequence& s : source->dataset->sequences) {
    if (s.split != "train" && s.split != "val") continue;
    if (!subjects.empty() && std::ranges::find(subjects, s.parts.subject) == subjects.end()) continue;
    if (source->options.needs_neutral && !source->dataset->templates.contains(s.parts.subject))
      return Error{Errc::incompatible, folder, "there is no template of subject '" + s.parts.subject + "'",
                   source->dataset->template_problem};
    (s.split == "train" ? source->train : source->valid).push_back(&s);
  }
  if (source->train.empty())
    return Error{Errc::incompatible, folder, "no sequence of the split train is of a subject to train on",
                 "Run: mien data check " + folder};
  FaceSequences sequences{source->train.size(), source->valid.size(), {}};
  sequences.load = [source](FaceSequences::Split split, std::size_t index) {
    return source->load(*(split == FaceSequences::Split::train ? source->train : source->valid).at(index));
  };
  return sequences;
}

}  // namespace mien::train

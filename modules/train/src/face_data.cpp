#include "mien/train/face_data.h"

#include <algorithm>

#include "mien/audio/load_audio.h"
#include "mien/models/speech_encoder/network.h"

namespace mien::train {
namespace {

constexpr int kLastNeutralSentence = 40;  // of FaceXHuBERT's BIWI

bool is_expressive(DatasetKind kind, const SequenceName& name) {
  return kind == DatasetKind::biwi ||
         (kind == DatasetKind::biwi_expressive && name.sentence > kLastNeutralSentence);
}

// What the closure of FaceSequences holds.
struct Source {
  std::shared_ptr<const Dataset> dataset;
  EncoderConfig encoder;
  FaceDataOptions options;
  std::vector<const DatasetSequence*> train, valid;

  [[nodiscard]] Result<FaceSequence> load(const DatasetSequence& from) const {
    FaceSequence s;
    s.name = from.name;
    MIEN_TRY(AudioClip clip, load_audio(from.audio));
    s.waveform = std::move(clip.samples);
    if (encoder.do_normalize) normalise_waveform(s.waveform, encoder.normalise_eps);
    MIEN_TRY(Motion motion, load_sequence(*dataset, from));
    s.motion = std::move(motion.values);
    const auto subject = std::ranges::find(options.subjects, from.parts.subject);
    if (subject != options.subjects.end()) s.subject = subject - options.subjects.begin();
    s.emotion = is_expressive(dataset->layout->kind, from.parts) ? 1 : 0;
    if (options.needs_neutral) s.neutral = dataset->templates.at(from.parts.subject);
    return s;
  }
};

}  // namespace

Result<FaceSequences> face_sequences(std::shared_ptr<const Dataset> dataset, const EncoderConfig& encoder,
                                     FaceDataOptions options) {
  const auto source =
      std::make_shared<Source>(Source{std::move(dataset), encoder, std::move(options), {}, {}});
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

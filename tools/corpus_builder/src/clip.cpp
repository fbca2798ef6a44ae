#include "clip.h"

#include <algorithm>
#include <cmath>

#include "emotional_voice.h"
#include "filters.h"
#include "mien/core/audio_clip.h"
#include "mien/corpus/closure.h"
#include "mien/corpus/prominence.h"

namespace mien {
namespace {

constexpr double kRate = kModelSampleRateHz;

PhoneSource phone_source(EngineId engine, const std::string& voice) {
  if (engine == EngineId::espeak) return PhoneSource::espeak;
  if (voice == "slt_hts") return PhoneSource::hts;
  return voice.starts_with("kal") || voice == "ked" ? PhoneSource::diphone : PhoneSource::statistical;
}

Result<Utterance> utterance_of(const Sentence& sentence, const ClipRequest& request) {
  Utterance out;
  const auto source = phone_source(request.engine, request.voice);
  for (const auto& phone : sentence.phones) {
    PhoneSegment segment;
    segment.start_s = phone.start;
    segment.end_s = phone.end;
    segment.label = phone.label;
    if (request.engine == EngineId::espeak) {
      segment.visemes = visemes_of_ipa(phone.label);
    } else {
      const auto visemes = visemes_of_arpabet(phone.label);
      if (!visemes)
        return Error{Errc::failed,
                     std::string(engine_name(request.engine)) + " voice '" + request.voice + "'",
                     "unknown phone '" + phone.label + "'", ""};
      segment.visemes = *visemes;
    }
    if (segment.is_bilabial())
      segment.closure = closure_window(source, segment, phone.burst.value_or(phone.start));
    out.phones.push_back(std::move(segment));
  }
  out.is_question = request.text.find('?') != std::string::npos;
  return out;
}

}  // namespace

Result<Clip> speak(const ClipRequest& request) {
  auto* engine = find_engine(request.engine);
  if (engine == nullptr)
    return Error{Errc::failed, std::string(engine_name(request.engine)), "this engine is absent",
                 "See mien-corpus list"};
  const auto speaking = with_emotion(request.speaking, request.emotion, request.intensity);
  MIEN_TRY(const auto sentence, engine->synthesise(request.text, request.voice, speaking));
  Clip clip;
  clip.num_sentences = 1;
  MIEN_TRY(clip.spoken, utterance_of(sentence, request));
  auto samples = resample_audio(sentence.samples, sentence.sample_rate_hz, kRate);
  color_with_emotion(samples, request.emotion, request.intensity);

  const auto before = static_cast<std::size_t>(std::llround(request.pad_before_s * kRate));
  const auto after = static_cast<std::size_t>(std::llround(request.pad_after_s * kRate));
  clip.samples.assign(before + samples.size() + after, 0.0f);
  std::copy(samples.begin(), samples.end(), clip.samples.begin() + static_cast<std::ptrdiff_t>(before));
  const double shift = static_cast<double>(before) / kRate;
  for (auto& phone : clip.spoken.phones) {
    phone.start_s += shift;
    phone.end_s += shift;
    if (phone.closure) phone.closure = TimeSpan{phone.closure->start_s + shift, phone.closure->end_s + shift};
  }
  clip.spoken.seconds = static_cast<double>(clip.samples.size()) / kRate;
  add_prominence(clip.spoken, clip.samples);
  return clip;
}

Clip join_clips(std::vector<Clip> parts) {
  Clip all;
  std::vector<Utterance> spoken;
  for (auto& part : parts) {
    all.samples.insert(all.samples.end(), part.samples.begin(), part.samples.end());
    spoken.push_back(std::move(part.spoken));
    all.num_sentences += part.num_sentences;
  }
  all.spoken = join(std::move(spoken));
  all.spoken.seconds = static_cast<double>(all.samples.size()) / kRate;
  return all;
}

Clip without_speech(std::vector<float> samples) {
  Clip clip{std::move(samples), {}, 0};
  clip.spoken.seconds = static_cast<double>(clip.samples.size()) / kRate;
  return clip;
}

}  // namespace mien

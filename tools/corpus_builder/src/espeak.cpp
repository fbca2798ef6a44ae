// espeak-ng through its C library (GPL-3-or-later): the only file that includes it. Corpus spec section 1.1.
#include <espeak-ng/speak_lib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "engine.h"

namespace mien {
namespace {

constexpr double kSilence = 2e-4;             // |sample| below this is the engine's own silence
constexpr double kLongestClosure = 0.150;     // seconds walked back from a burst
constexpr double kShortestClosure = 0.008;    // shorter silent runs are not closures
constexpr double kShortestNeighbour = 0.020;  // what the phone before a closure keeps
constexpr int kNormalWordsPerMinute = 165, kNormalPitch = 50, kNormalRange = 55;

struct Mark {
  int sample;
  std::string ipa;
};

struct Collected {
  std::vector<float> samples;
  std::vector<Mark> marks;
};

int collect(short* samples, int count, espeak_EVENT* events) {
  if (events == nullptr) return 0;
  auto* out = static_cast<Collected*>(events->user_data);
  if (out == nullptr) return 0;
  for (const auto* e = events; e->type != espeakEVENT_LIST_TERMINATED; ++e) {
    if (e->type != espeakEVENT_PHONEME) continue;
    char ipa[9] = {};  // the field has 8 bytes and need not end with a zero
    std::memcpy(ipa, e->id.string, 8);
    out->marks.push_back({e->sample, ipa});
  }
  if (samples != nullptr)
    for (int i = 0; i < count; ++i) out->samples.push_back(static_cast<float>(samples[i]) / 32768.0f);
  return 0;
}

bool is_pause(const std::string& ipa) { return ipa.empty() || ipa[0] == '_'; }

// p t k ʈ c q and the affricates that begin with them, whatever length, aspiration or palatalisation follows.
bool is_voiceless_stop(const std::string& ipa) {
  for (const char* stop : {"p", "t", "k", "ʈ", "c", "q"})
    if (ipa.starts_with(stop)) return true;
  return false;
}

std::string escape_ssml(const std::string& text) {
  std::string out = "<speak>";
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out + "</speak>";
}

// espeak places the silent closure of a voiceless stop inside the phone before it: move that boundary back.
void repair_closures(Sentence& u) {
  for (std::size_t i = 1; i < u.phones.size(); ++i) {
    auto& phone = u.phones[i];
    auto& before = u.phones[i - 1];
    if (!is_voiceless_stop(phone.label) || is_pause(before.label)) continue;
    const auto burst = static_cast<std::int64_t>(std::llround(phone.start * u.sample_rate_hz));
    const auto lowest = std::max<std::int64_t>(0, burst - std::llround(kLongestClosure * u.sample_rate_hz));
    std::int64_t start = burst;
    while (start > lowest && std::abs(u.samples[static_cast<std::size_t>(start - 1)]) < kSilence) --start;
    if (static_cast<double>(burst - start) <= kShortestClosure * u.sample_rate_hz) continue;
    const double moved =
        std::max(static_cast<double>(start) / u.sample_rate_hz, before.start + kShortestNeighbour);
    if (moved >= phone.start) continue;
    phone.burst = phone.start;
    phone.start = before.end = moved;
  }
}

class Espeak final : public Engine {
 public:
  explicit Espeak(int sample_rate_hz) : sample_rate_hz_(sample_rate_hz) {
    for (const auto** v = espeak_ListVoices(nullptr); *v != nullptr; ++v) files_.insert((*v)->identifier);
    espeak_VOICE only_variants{};
    only_variants.languages = "variant";
    for (const auto** v = espeak_ListVoices(&only_variants); *v != nullptr; ++v)
      if (std::strncmp((*v)->identifier, "!v/", 3) == 0) variants_.insert((*v)->identifier + 3);
  }

  EngineId id() const override { return EngineId::espeak; }
  std::string version() const override {
    const char* data_path = nullptr;
    const std::string text = espeak_Info(&data_path);
    return "espeak-ng " + text.substr(0, text.find(' '));
  }
  std::vector<std::string> voices() const override { return {files_.begin(), files_.end()}; }

  Result<Sentence> synthesise(const std::string& text, const std::string& voice, const Speaking& s) override {
    if (auto chosen = choose(voice); !chosen.has_value()) return chosen.error();
    const auto set = [](espeak_PARAMETER p, double value, int low, int high) {
      espeak_SetParameter(p, std::clamp(static_cast<int>(std::lround(value)), low, high), 0);
    };
    set(espeakRATE, kNormalWordsPerMinute * s.rate, 80, 450);
    set(espeakPITCH, kNormalPitch + 0.8 * s.pitch_percent, 0, 99);
    set(espeakRANGE, kNormalRange * s.range, 0, 99);
    set(espeakVOLUME, 100, 0, 200);
    seed_engine_noise(text, voice);
    Collected got;
    espeak_SetSynthCallback(&collect);
    const std::string ssml = escape_ssml(text);
    const unsigned flags = espeakCHARS_UTF8 | espeakSSML | espeakENDPAUSE;
    if (espeak_Synth(ssml.c_str(), ssml.size() + 1, 0, POS_CHARACTER, 0, flags, nullptr, &got) != EE_OK ||
        espeak_Synchronize() != EE_OK || got.samples.empty())
      return Error{Errc::failed, "espeak voice '" + voice + "'", "no sound for '" + text + "'", ""};
    return labelled(std::move(got));
  }

  std::vector<std::string> phones_of(const std::string& text, const std::string& voice) override {
    if (!choose(voice).has_value()) return {};
    std::vector<std::string> out;
    const void* rest = text.c_str();
    constexpr int kIpaSeparatedByUnderscore = 0x02 | ('_' << 8);
    while (rest != nullptr) {
      const char* ipa = espeak_TextToPhonemes(&rest, espeakCHARS_UTF8, kIpaSeparatedByUnderscore);
      if (ipa == nullptr) break;
      std::string phone;
      for (const char* c = ipa;; ++c) {
        if (*c != '_' && *c != ' ' && *c != '\0') {
          phone += *c;
          continue;
        }
        if (!phone.empty() && !phone.starts_with('(')) out.push_back(phone);
        phone.clear();
        if (*c == '\0') break;
      }
    }
    return out;
  }

 private:
  // After a failure espeak keeps the old voice, and it accepts unknown variants silently: check both names
  // first.
  Status choose(const std::string& voice) {
    if (!voice.empty() && voice == current_) return Done{};
    const auto plus = voice.find('+');
    const std::string file = voice.substr(0, plus);
    if (!files_.contains(file))
      return Error{Errc::usage, "espeak voice '" + voice + "'", "no voice file '" + file + "'",
                   "See mien-corpus list"};
    if (plus != std::string::npos && !variants_.contains(voice.substr(plus + 1)))
      return Error{Errc::usage, "espeak voice '" + voice + "'", "no variant '" + voice.substr(plus + 1) + "'",
                   ""};
    if (espeak_SetVoiceByName(voice.c_str()) != EE_OK)
      return Error{Errc::failed, "espeak voice '" + voice + "'", "the engine refuses it", ""};
    current_ = voice;
    return Done{};
  }

  Sentence labelled(Collected got) const {
    Sentence u{std::move(got.samples), sample_rate_hz_, {}};
    const auto total = static_cast<int>(u.samples.size());
    const auto seconds = [this](int sample) { return static_cast<double>(sample) / sample_rate_hz_; };
    const auto add = [&](int from, int to, const std::string& ipa) {
      if (to <= from) return;  // zero-length pauses
      u.phones.push_back({seconds(from), seconds(to), is_pause(ipa) ? "" : ipa, {}});
    };
    // There is no pause event at the start: what precedes the first event is one.
    int previous = 0;
    std::string label;
    for (const auto& mark : got.marks) {
      if (mark.ipa.starts_with('(')) continue;  // "(en)": the voice changes language for a word
      const int at = std::clamp(mark.sample, previous, total);
      add(previous, at, label);
      previous = at;
      label = mark.ipa;
    }
    add(previous, total, label);
    repair_closures(u);
    return u;
  }

  int sample_rate_hz_;
  std::set<std::string> files_, variants_;
  std::string current_;
};

}  // namespace

Result<std::unique_ptr<Engine>> make_espeak() {
  const int rate = espeak_Initialize(
      AUDIO_OUTPUT_SYNCHRONOUS, 0, nullptr,
      espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_PHONEME_IPA | espeakINITIALIZE_DONT_EXIT);
  if (rate <= 0)
    return Error{Errc::failed, "espeak", "it cannot be initialised", "Install the package espeak-ng-data"};
  return std::unique_ptr<Engine>(std::make_unique<Espeak>(rate));
}

}  // namespace mien

// flite through its C library. Corpus spec section 1.2.
extern "C" {
#include <flite/flite.h>
#include <flite/flite_version.h>
cst_voice* register_cmu_us_kal16(const char* voxdir);
cst_voice* register_cmu_us_slt(const char* voxdir);
cst_voice* register_cmu_us_awb(const char* voxdir);
cst_voice* register_cmu_us_rms(const char* voxdir);
}

#include <algorithm>
#include <map>

#include "engine.h"

namespace mien {
namespace {

constexpr double kSmallestStretch = 0.75;  // of duration_stretch; below it phones vanish

struct DeleteUtterance {
  void operator()(cst_utterance* u) const { delete_utterance(u); }
};

class Flite final : public Engine {
 public:
  Flite() {
    flite_init();
    voices_ = {{"kal16", register_cmu_us_kal16(nullptr)},
               {"slt", register_cmu_us_slt(nullptr)},
               {"awb", register_cmu_us_awb(nullptr)},
               {"rms", register_cmu_us_rms(nullptr)}};
    for (const auto& [name, voice] : voices_)
      if (voice != nullptr && feat_present(voice->features, "int_f0_target_stddev") != 0)
        f0_spread_[name] = flite_get_param_float(voice->features, "int_f0_target_stddev", 0.0f);
  }

  EngineId id() const override { return EngineId::flite; }
  std::string version() const override { return std::string("flite ") + FLITE_PROJECT_VERSION; }
  std::vector<std::string> voices() const override {
    std::vector<std::string> names;
    for (const auto& [name, voice] : voices_) names.push_back(name);
    return names;
  }

  Result<Sentence> synthesise(const std::string& text, const std::string& voice, const Speaking& s) override {
    const auto found = voices_.find(voice);
    if (found == voices_.end() || found->second == nullptr)
      return Error{Errc::usage, "flite voice '" + voice + "'", "unknown", "Use kal16, slt, awb or rms"};
    auto* features = found->second->features;
    flite_feat_set_float(features, "duration_stretch",
                         static_cast<float>(std::max(kSmallestStretch, 1.0 / s.rate)));
    flite_feat_set_float(features, "f0_shift", static_cast<float>(1.0 + s.pitch_percent / 100.0));
    // The spread of F0 belongs to the intonation model of kal16; the statistical voices ignore it.
    if (const auto spread = f0_spread_.find(voice); spread != f0_spread_.end())
      flite_feat_set_float(features, "int_f0_target_stddev", static_cast<float>(spread->second * s.range));
    seed_engine_noise(text, voice);
    const std::unique_ptr<cst_utterance, DeleteUtterance> utterance(
        flite_synth_text(text.c_str(), found->second));
    const cst_wave* wave = utterance ? utt_wave(utterance.get()) : nullptr;
    if (wave == nullptr || wave->num_samples <= 0)
      return Error{Errc::failed, "flite voice '" + voice + "'", "no sound for '" + text + "'", ""};
    return labelled(*utterance, *wave);
  }

 private:
  static Sentence labelled(cst_utterance& utterance, const cst_wave& wave) {
    Sentence u;
    u.sample_rate_hz = wave.sample_rate;
    u.samples.resize(static_cast<std::size_t>(wave.num_samples));
    for (std::size_t i = 0; i < u.samples.size(); ++i)
      u.samples[i] = static_cast<float>(wave.samples[i]) / 32768.0f;
    const double total = static_cast<double>(wave.num_samples) / wave.sample_rate;
    double start = 0.0;
    for (const auto* item = relation_head(utt_relation(&utterance, "Segment")); item != nullptr;
         item = item_next(item)) {
      // kal16 loses about 0.1 s of its last half pause: ends beyond the wave are clamped to it.
      const double end = std::clamp(static_cast<double>(item_feat_float(item, "end")), start, total);
      if (end > start) u.phones.push_back({start, end, item_feat_string(item, "name"), {}});
      start = end;
    }
    if (start < total) {
      if (!u.phones.empty() && u.phones.back().label == "pau")
        u.phones.back().end = total;
      else
        u.phones.push_back({start, total, "pau", {}});
    }
    return u;
  }

  std::map<std::string, cst_voice*> voices_;
  std::map<std::string, double> f0_spread_;  // Hz, of the voices that have one, as they come
};

}  // namespace

Result<std::unique_ptr<Engine>> make_flite() { return std::unique_ptr<Engine>(std::make_unique<Flite>()); }

}  // namespace mien

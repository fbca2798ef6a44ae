#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/result.h"

namespace mien {

/// How a sentence is spoken, in terms every engine understands in its own way. The defaults are the middle of
/// the corpus (spec section 11): espeak 165 words a minute, pitch 50, range 55; flite and festival as they
/// come.
struct Speaking {
  double rate = 1.0;           ///< speed, 1 = normal; 1.1 speaks 10 % faster
  double pitch_percent = 0.0;  ///< shift of the mean F0
  double range = 1.0;          ///< factor on the spread of F0
};

/// One phone as the engine reports it.
struct LabelledPhone {
  double start = 0.0;  ///< seconds
  double end = 0.0;    ///< seconds
  std::string label;   ///< IPA (espeak) or lower-case ARPABET (flite, festival); "" or "pau" is a pause
  std::optional<double>
      burst;  ///< espeak's voiceless stops: release, when a silent closure was found before it
};

/// What an engine makes of one sentence. Phones are contiguous from 0 to the end of the samples.
struct Sentence {
  std::vector<float> samples;  // [S] full scale 1
  int sample_rate_hz = 0;
  std::vector<LabelledPhone> phones;
};

enum class EngineId { espeak, flite, festival };
inline constexpr EngineId kAllEngines[] = {EngineId::espeak, EngineId::flite, EngineId::festival};
std::string_view engine_name(EngineId id);

/// A speech synthesiser. Engines keep global state: use them from one thread, and fork for parallel work.
class Engine {
 public:
  virtual ~Engine() = default;
  [[nodiscard]] virtual EngineId id() const = 0;
  [[nodiscard]] virtual std::string version() const = 0;
  /// Names for synthesise(); espeak: "gmw/en-US+f3" = voice file, plus, variant.
  [[nodiscard]] virtual std::vector<std::string> voices() const = 0;
  /// Errors: Errc::usage for an unknown voice, Errc::failed when the engine gives no sound. Engines take
  /// their noise from the C library's rand(), which is seeded here from voice and text.
  virtual Result<Sentence> synthesise(const std::string& text, const std::string& voice,
                                      const Speaking& speaking) = 0;
  /// Phones of a text without sound, for choosing sentences; empty when the engine cannot.
  virtual std::vector<std::string> phones_of(const std::string& text, const std::string& voice) {
    (void)text, (void)voice;
    return {};
  }
};

/// Seeds rand() for one sentence: what an engine says must not depend on what it said before.
void seed_engine_noise(const std::string& text, const std::string& voice);

/// The engines this program was built with and that answer on this machine. The same objects at every call.
/// Absent ones are explained in `missing`, one line each, when given.
std::vector<Engine*> available_engines(std::vector<std::string>* missing = nullptr);
/// The engine, or nullptr when it is absent.
Engine* find_engine(EngineId id);

// One maker per engine; an Error says why it is absent.
Result<std::unique_ptr<Engine>> make_espeak();
Result<std::unique_ptr<Engine>> make_flite();
Result<std::unique_ptr<Engine>> make_festival();

}  // namespace mien

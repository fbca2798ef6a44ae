#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "mien/base/result.h"
#include "mien/core/emotion.h"

namespace mien {

/// How a performance is directed at one instant: the strength of every emotion and who performs.
struct DirectionKey {
  double seconds = 0;
  /// 0 ... 1 per emotion; index 0 (neutral) is not used: neutral is what is left below intensity 0.35.
  std::array<float, kNumEmotions> intensities{};
  /// Index of a style of the model (0 = S00), or -1: of no one in particular.
  int style = -1;
};

/// Direction over time: keys in order of time, linear between them, constant outside. Emotions cross-fade;
/// styles too.
class Direction {
 public:
  /// Neutral, no style.
  Direction() : keys_(1) {}
  /// @pre at least one key; times strictly increase
  explicit Direction(std::vector<DirectionKey> keys);

  [[nodiscard]] const std::vector<DirectionKey>& keys() const { return keys_; }
  [[nodiscard]] bool is_constant() const { return keys_.size() == 1; }
  /// The two keys around an instant and the weight of the second.
  struct Between {
    const DirectionKey *first, *second;
    float weight;
  };
  [[nodiscard]] Between at(double seconds) const;
  /// Sum of the emotions' intensities at an instant, at most 1.
  [[nodiscard]] float strength(double seconds) const;

 private:
  std::vector<DirectionKey> keys_;
};

/// "angry", "angry:2" (level 1, 2, 3), "angry:0.4" (intensity 0 ... 1), "neutral".
/// Errors (Errc::usage): an unknown emotion (the message lists them), a bad intensity.
Result<std::array<float, kNumEmotions>> parse_emotion_intensity(std::string_view text);

/// "S05" -> 5. Errors (Errc::usage): not S00 ... S11.
Result<int> parse_style(std::string_view text);

/// Keys from CSV text: header "time,emotion,intensity,style" (style optional), one key a line; lines of equal
/// time blend. Errors (Errc::input): bad fields, each with its line.
Result<Direction> parse_direction_csv(std::string_view text);

/// The same from JSON: [{"time": 0.5, "emotion": "happy", "intensity": 0.8, "style": "S03"}, ...]; the numbers
/// 1, 2 and 3 without a dot are levels. Errors (Errc::input): another shape, bad members, each with its key.
Result<Direction> parse_direction_json(std::string_view text);

}  // namespace mien

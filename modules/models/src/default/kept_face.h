#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "mien/models/default/network.h"
#include "mien/models/runtime_parameters.h"
#include "mien/motion/blink.h"
#include "mien/motion/kept_values.h"

namespace mien::default_model {

/// A standardised past beyond this is off course; the network has never seen it.
inline constexpr float kLargestStandardised = 6;

/// What an edit keeps, as the paths of the default model see it (docs/editing.md): standardised upper numbers
/// without blinks and raises, and the blinks and raises as events.
class KeptFace {
 public:
  /// @param kept  [N, 55] arkit_and_head_channels() at 60 fps
  KeptFace(const KeptValues& kept, const Statistics<Tensor>& statistics);

  /// A chunk of upper numbers, [6 U] each. A number is known where all its frames are kept: a chunk with some
  /// samples held would leap to and from them, so what begins or ends inside a chunk is left to the join.
  struct Chunk {
    std::vector<float> samples;
    std::vector<bool> is_known;
    bool is_known_entirely = false, is_free = true;
  };
  [[nodiscard]] Chunk chunk(std::int64_t index) const;

  /// The class (EventKind) of what the kept lids or brows do in `count` frames from `first` on; nothing where
  /// one of these frames is free.
  [[nodiscard]] std::optional<int> blink_class(std::int64_t first, std::int64_t count) const {
    return event_class(blinks_, first, count);
  }
  [[nodiscard]] std::optional<int> raise_class(std::int64_t first, std::int64_t count) const {
    return event_class(raises_, first, count);
  }
  /// Whether an event may take place from one instant to another: no kept frame lies in it. Seconds.
  [[nodiscard]] bool may_blink(double from_s, double to_s) const { return is_free(blinks_, from_s, to_s); }
  [[nodiscard]] bool may_raise(double from_s, double to_s) const { return is_free(raises_, from_s, to_s); }
  /// The drawn closure of frame n, where one lid alone is kept: that of the kept lid for both.
  [[nodiscard]] LidClosure closure(std::int64_t n, LidClosure drawn) const;

 private:
  // One kind of event in the frames that are kept.
  struct Events {
    std::vector<bool> is_kept, begins;  // [N]
  };
  static std::optional<int> event_class(const Events& events, std::int64_t first, std::int64_t count);
  static bool is_free(const Events& events, double from_s, double to_s);

  std::int64_t num_frames_;
  std::vector<std::array<float, kNumUpper>> upper_;    // [N] standardised
  std::vector<std::array<bool, kNumUpper>> is_known_;  // [N]
  Events blinks_, raises_;
  std::vector<LidClosure> closures_;            // [N] of the kept lids
  std::vector<std::array<bool, 2>> keeps_lid_;  // [N] left, right
};

}  // namespace mien::default_model

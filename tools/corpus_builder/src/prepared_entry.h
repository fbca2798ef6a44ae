#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien {

/// One take of an entry.
struct PreparedTake {
  std::uint8_t style = 0;             ///< index of the speaker, 0 = S00
  std::array<float, 3> latents{};     ///< Take::latents
  std::vector<std::uint16_t> curves;  ///< [N, 55] halves, without blinks and raises of the brows
  std::vector<std::uint8_t> blink;    ///< [N] 1 where a blink starts to close
  std::vector<std::uint8_t> raise;    ///< [N] amplitude of a brow raise at the frame of its centre, in 1/255
};

/// One entry of a prepared training set: T mel frames, N motion frames, K takes.
struct PreparedEntry {
  std::vector<std::uint16_t> mel;     ///< [T, 64] halves
  std::vector<float> level;           ///< [T]
  std::vector<std::uint8_t> viseme;   ///< [N] 0 ... 27
  std::vector<std::uint8_t> closure;  ///< [N] 1 inside a bilabial closure
  std::vector<std::uint8_t> accent;   ///< [N] 1 at an accent
  std::vector<PreparedTake> takes;    ///< [K]
  std::uint8_t emotion = 0;
  float intensity = 1;
  std::uint8_t split = 0;  ///< 0 train, 1 valid
  double seconds = 0;      ///< of the sound as it is heard

  [[nodiscard]] std::int64_t num_mel() const { return static_cast<std::int64_t>(level.size()); }
  [[nodiscard]] std::int64_t num_frames() const { return static_cast<std::int64_t>(viseme.size()); }
};

/// Plain bytes and back, for the way between two processes of the same program. Error: the bytes are cut.
void append_entry(Bytes& bytes, const PreparedEntry& entry);
Result<std::vector<PreparedEntry>> parse_entries(std::span<const std::byte> bytes);

}  // namespace mien

#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/motion.h"

namespace mien {

/// Several takes of one item: the content of a .pcv file (specification, section 12).
struct CurveSet {
  double fps = 60;
  std::int64_t num_takes = 0;      // K
  std::int64_t num_frames = 0;     // N
  std::int64_t num_channels = 0;   // C: the first C of arkit_and_head_channels(), 1 ... 55
  bool first_is_mean = false;      ///< take 0 is the mean curve
  std::vector<float> values = {};  // [K, N, C]

  /// Take k as a motion. @pre 0 <= k < num_takes
  [[nodiscard]] Motion take(std::int64_t k) const;
};

/// Motions of equal shape put together. @pre all have the channels of the first, which are those of CurveSet
CurveSet curve_set(std::span<const Motion> takes, bool first_is_mean);

enum class CurvePrecision { half, single };

/// Little endian: "PCV1", u32 fps x 1000, u32 N, u32 C, u32 K, u32 flags (bit 0 half floats, bit 1 take 0 is
/// the mean), then K N C values.
Bytes encode_curves(const CurveSet& curves, CurvePrecision precision);
/// Errors (Errc::input): not such a file, unknown flags, sizes that do not fit the length, a value that is
/// not finite.
/// @param name  of the file, for messages
Result<CurveSet> decode_curves(std::span<const std::byte> bytes, std::string_view name);

Status write_curves(const std::filesystem::path& path, const CurveSet& curves, CurvePrecision precision);
Result<CurveSet> read_curves(const std::filesystem::path& path);

}  // namespace mien

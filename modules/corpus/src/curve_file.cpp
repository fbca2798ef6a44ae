#include "mien/corpus/curve_file.h"

#include <cmath>

#include "mien/base/contract.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

constexpr std::string_view kMagic = "PCV1";
constexpr std::size_t kHeaderBytes = 24;
constexpr std::uint32_t kHalfFlag = 1, kMeanFlag = 2;
constexpr std::uint32_t kMaxChannels = 55;

Error bad(std::string_view name, std::string why) {
  return {Errc::input, "curves '" + std::string(name) + "'", std::move(why), "Build the corpus again"};
}

}  // namespace

Motion CurveSet::take(std::int64_t k) const {
  contract(k >= 0 && k < num_takes, "CurveSet::take: no such take");
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), fps, {}};
  motion.channels.resize(static_cast<std::size_t>(num_channels));
  const auto first = values.begin() + k * num_frames * num_channels;
  motion.values.assign(first, first + num_frames * num_channels);
  return motion;
}

CurveSet curve_set(std::span<const Motion> takes, bool first_is_mean) {
  CurveSet set;
  set.first_is_mean = first_is_mean;
  if (takes.empty()) return set;
  const Motion& first = takes.front();
  const auto known = arkit_and_head_channels();
  contract(!first.channels.empty() && first.channels.size() <= known.size() &&
               std::equal(first.channels.begin(), first.channels.end(), known.begin()),
           "curve_set: the channels must be the first of arkit_and_head_channels()");
  set.fps = first.fps;
  set.num_takes = static_cast<std::int64_t>(takes.size());
  set.num_frames = first.num_frames();
  set.num_channels = first.num_channels();
  for (const Motion& take : takes) {
    contract(
        take.channels == first.channels && take.values.size() == first.values.size() && take.fps == first.fps,
        "curve_set: takes must have one shape");
    set.values.insert(set.values.end(), take.values.begin(), take.values.end());
  }
  return set;
}

Bytes encode_curves(const CurveSet& curves, CurvePrecision precision) {
  const bool is_half = precision == CurvePrecision::half;
  Bytes bytes;
  bytes.reserve(kHeaderBytes + curves.values.size() * (is_half ? 2 : 4));
  for (const char c : kMagic) append_le(bytes, c);
  append_le(bytes, static_cast<std::uint32_t>(std::lround(curves.fps * 1000)));
  for (const std::int64_t size : {curves.num_frames, curves.num_channels, curves.num_takes})
    append_le(bytes, static_cast<std::uint32_t>(size));
  append_le(bytes, (is_half ? kHalfFlag : 0u) | (curves.first_is_mean ? kMeanFlag : 0u));
  for (const float value : curves.values) {
    if (is_half)
      append_le(bytes, float_to_half(value));
    else
      append_le(bytes, value);
  }
  return bytes;
}

Result<CurveSet> decode_curves(std::span<const std::byte> bytes, std::string_view name) {
  if (bytes.size() < kHeaderBytes)
    return bad(name, "has " + std::to_string(bytes.size()) + " bytes, the header alone needs 24");
  if (as_text(bytes.first(kMagic.size())) != kMagic)
    return bad(name, "is not a .pcv file (does not start with PCV1)");
  const auto word = [&](std::size_t index) { return *read_le<std::uint32_t>(bytes, 4 * index); };
  const std::uint32_t milli_fps = word(1), num_frames = word(2), num_channels = word(3), num_takes = word(4);
  const std::uint32_t flags = word(5);
  if (milli_fps == 0) return bad(name, "has a frame rate of zero");
  if (num_channels == 0 || num_channels > kMaxChannels)
    return bad(name, "has " + std::to_string(num_channels) + " channels, expected 1 to 55");
  if ((flags & ~(kHalfFlag | kMeanFlag)) != 0) return bad(name, "has unknown flags " + std::to_string(flags));
  const std::size_t value_bytes = (flags & kHalfFlag) != 0 ? 2 : 4;
  const auto frames_and_takes = checked_multiply(num_frames, num_takes);
  const auto count = frames_and_takes ? checked_multiply(*frames_and_takes, num_channels) : std::nullopt;
  const auto size = count ? checked_multiply(*count, value_bytes) : std::nullopt;
  if (!size || *size != bytes.size() - kHeaderBytes)
    return bad(name, "has " + std::to_string(bytes.size() - kHeaderBytes) + " bytes of values, the header (" +
                         std::to_string(num_takes) + " takes of " + std::to_string(num_frames) +
                         " frames of " + std::to_string(num_channels) + " channels) does not fit");

  CurveSet set{milli_fps / 1000.0, num_takes, num_frames, num_channels, (flags & kMeanFlag) != 0, {}};
  set.values.resize(*count);
  for (std::size_t i = 0; i < *count; ++i) {
    const std::size_t offset = kHeaderBytes + i * value_bytes;
    set.values[i] = value_bytes == 2 ? half_to_float(*read_le<std::uint16_t>(bytes, offset))
                                     : *read_le<float>(bytes, offset);
    if (!std::isfinite(set.values[i]))
      return bad(name,
                 "value " + std::to_string(i) + " of " + std::to_string(*count) + " is not a finite number");
  }
  return set;
}

Status write_curves(const std::filesystem::path& path, const CurveSet& curves, CurvePrecision precision) {
  return write_file(path, encode_curves(curves, precision));
}

Result<CurveSet> read_curves(const std::filesystem::path& path) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  return decode_curves(bytes, path.string());
}

}  // namespace mien

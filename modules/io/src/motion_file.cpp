#include "mien/io/motion_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/core/flame_parameters.h"
#include "mien/core/rig_controls.h"
#include "mien/io/file_extension.h"
#include "mien/io/flame_csv.h"
#include "mien/io/live_link_csv.h"
#include "mien/io/motion_json.h"
#include "mien/io/motion_writer.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

constexpr std::size_t kMaxWidth = 3'000'000;  // numbers a frame: a mesh of a million vertices
constexpr std::size_t kLeastWidth = 300;      // of rows that are taken for x, y, z of vertices
constexpr std::array<std::string_view, 4> kExtensions = {".csv", ".glb", ".json", ".npy"};

Error unknown_extension(const std::filesystem::path& path) {
  std::string known;
  for (const auto extension : kExtensions) known += (known.empty() ? "" : ", ") + std::string(extension);
  return {Errc::usage, "'" + path.string() + "'",
          "no motion format has the extension '" + path.extension().string() + "'", "Use one of " + known};
}

Status write_glb_file(const std::filesystem::path& path, const Motion& motion, const MotionContext& context) {
  if (context.character_glb.empty())
    return Error{Errc::usage, "'" + path.string() + "'", "a .glb needs a character to animate", ""};
  auto bytes = animate_glb(context.character_glb, motion, context.audio_name, context.glb);
  if (!bytes) return bytes.error();
  Status status = write_file(path, std::span<const std::byte>(*bytes));
  status.warnings = std::move(bytes.warnings);
  return status;
}

// The papers' rates, where the width tells the data set.
double assumed_rate(std::size_t width) {
  if (width == kNumArkit - 1 || width == kNumUudamm) return 30;  // BEAT, UUDaMM
  if (width == kNumFlame) return 25;                             // 3DMEAD
  if (width % 3 != 0) return 60;
  const auto known = known_topology(static_cast<std::int64_t>(width / 3));
  return known ? known->fps : 60;
}

Result<Motion> motion_of_array(NpyArray array, double fps) {
  if (array.shape.empty())
    return Error{Errc::incompatible, ".npy file", "it is a single number, expected frames", ""};
  if (array.shape.size() == 3 && array.shape[0] == 1 && array.shape[2] == kNumFlame)  // ProbTalk3D's
    array.shape.erase(array.shape.begin());
  std::size_t width = 1;
  for (std::size_t i = 1; i < array.shape.size(); ++i)
    width = checked_multiply(width, static_cast<std::size_t>(array.shape[i])).value_or(kMaxWidth + 1);
  if (width == 0 || width > kMaxWidth)
    return Error{
        Errc::incompatible, ".npy file",
        "its frames hold " + std::to_string(width) + " numbers, expected 1 to " + std::to_string(kMaxWidth),
        ""};
  for (std::size_t i = 0; i < array.values.size(); ++i)
    if (!std::isfinite(array.values[i]))
      return Error{Errc::input, ".npy file", "frame " + std::to_string(i / width) + " is not finite", ""};
  Result<Motion> result{Motion{MotionSpace::arkit, {}, fps, std::move(array.values)}};
  auto& channels = result->channels;
  // An axis of three coordinates tells positions, however few.
  const bool is_points = array.shape.size() == 3 && array.shape[2] == 3;
  if (is_points || (width % 3 == 0 && width >= kLeastWidth)) {
    result->space = MotionSpace::vertices;
    result->topology = topology_of(static_cast<std::int64_t>(width / 3));
  } else if (width == kNumArkit) {
    channels = arkit_order(ArkitOrder::apple);
  } else if (width == kNumArkit + 3) {
    channels = arkit_and_head_channels();
  } else if (width == kNumArkit - 1) {
    channels = arkit_order(ArkitOrder::beat);
  } else if (width == 32) {
    channels = arkit_order(ArkitOrder::said);
  } else if (width == kNumUudamm) {
    result->space = MotionSpace::rig;
    channels = uudamm_controls();
  } else if (width == kNumFlame) {
    result->space = MotionSpace::flame;
    channels = flame_channels(kNumFlameShape, kNumFlameExpression);
  } else {
    result->space = MotionSpace::rig;
    for (std::size_t c = 0; c < width; ++c) channels.push_back("channel_" + std::to_string(c));
  }
  if (!(fps > 0)) result->fps = assumed_rate(width);
  if (result->space == MotionSpace::arkit || (result->space == MotionSpace::rig && width == kNumUudamm))
    result.warnings.push_back("the names of the " + std::to_string(width) +
                              " columns are assumed from their number");
  if (!(fps > 0))
    result.warnings.push_back("the file states no frame rate: " + std::to_string(std::lround(result->fps)) +
                              " is assumed");
  return result;
}

Result<Motion> read_known(const std::filesystem::path& path, const std::string& extension,
                          const MotionReadOptions& options) {
  if (extension == ".glb" || extension == ".gltf") return read_glb_motion(path);
  MIEN_TRY(const Bytes bytes, read_file(path));
  if (extension == ".csv" && is_flame_csv(as_text(bytes))) return read_flame_csv(as_text(bytes), options.fps);
  if (extension == ".csv") return read_live_link_csv(as_text(bytes), {.fps = options.fps});
  if (extension == ".json") return read_motion_json(as_text(bytes));
  MIEN_TRY(auto array, read_npy(bytes));
  return motion_of_array(std::move(array), options.fps);
}

}  // namespace

std::span<const std::string_view> motion_extensions() { return kExtensions; }

Status write_motion(const std::filesystem::path& path, const Motion& motion, const MotionContext& context) {
  if (MotionWriter::can_write(path)) {
    MIEN_TRY(MotionWriter writer, MotionWriter::create(path, motion, context.audio_name));
    MIEN_TRY([[maybe_unused]] const auto added, writer.add(motion.values));
    return writer.finish();
  }
  if (lower_extension(path) == ".glb") return write_glb_file(path, motion, context);
  return unknown_extension(path);
}

Result<Motion> read_motion(const std::filesystem::path& path, const MotionReadOptions& options) {
  const std::string extension = lower_extension(path);
  const bool known = std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
  if (!known && extension != ".gltf") return unknown_extension(path);
  auto motion = read_known(path, extension, options);
  const std::string name = "'" + path.string() + "'";
  if (!motion && !motion.error().what.starts_with(name)) return within(motion.error(), name);
  return motion;
}

}  // namespace mien

#include "mien/io/metahuman_csv.h"

#include <cctype>
#include <cmath>
#include <optional>

#include "even_motion.h"
#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "shape_names.h"

namespace mien {
namespace {

std::string padded(std::string text, std::size_t width) {
  return std::string(text.size() < width ? width - text.size() : 0, '0') + text;
}

}  // namespace

std::string metahuman_timecode(std::int64_t n, double fps) {
  contract(n >= 0 && fps > 0, "metahuman_timecode: a row and a rate expected");
  constexpr std::int64_t kSecond = 1'000'000;  // microseconds
  constexpr double kFieldsPerSecond = 60;
  const std::int64_t step = std::llrint(static_cast<double>(kSecond) / fps);
  const std::int64_t time = n * step, seconds = time / kSecond;
  const double part = static_cast<double>(time % kSecond) / static_cast<double>(kSecond) * kFieldsPerSecond;
  const auto two = [](std::int64_t value) { return padded(std::to_string(value), 2); };
  return two(seconds / 3600 % 24) + ":" + two(seconds / 60 % 60) + ":" + two(seconds % 60) + ":" +
         padded(fixed(part, 3), 6);
}

Status write_metahuman_csv(const Motion& motion, const TextSink& sink) {
  if (motion.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "MetaHuman CSV", "the motion is not made of ARKit coefficients", ""};
  MIEN_TRY([[maybe_unused]] const auto checked, io::check_motion(motion, "MetaHuman CSV"));
  std::vector<std::optional<std::int64_t>> columns;
  std::vector<bool> used(motion.channels.size());
  std::string line = "Timecode,BlendShapeCount";
  for (std::string name : arkit_order(ArkitOrder::beat)) {
    columns.push_back(motion.find(name));
    if (columns.back()) used[static_cast<std::size_t>(*columns.back())] = true;
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    line += "," + name;
  }
  MIEN_TRY([[maybe_unused]] const auto header, sink(line + "\n"));
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    line = metahuman_timecode(n, motion.fps) + "," + std::to_string(columns.size());
    for (const auto& column : columns)
      line +=
          "," + (column ? shortest(motion.frame(n)[static_cast<std::size_t>(*column)]) : std::string("0"));
    MIEN_TRY([[maybe_unused]] const auto row, sink(line + "\n"));
  }
  Status status{Done{}};
  std::vector<std::string> lost;
  for (std::size_t c = 0; c < used.size(); ++c)
    if (!used[c]) lost.push_back(motion.channels[c]);
  if (!lost.empty())
    status.warnings.push_back("channels that MetaHuman CSV has no column for: " + io::listed(lost));
  return status;
}

}  // namespace mien

#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>

#include "even_motion.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/io/live_link_csv.h"
#include "rotations.h"
#include "shape_names.h"
#include "timecode.h"

namespace mien {
namespace {

using namespace io;

constexpr int kDecimals = 8;

std::string capitalised(std::string name) {
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

void append_number(std::string& line, double value) {
  line += ',';
  line += fixed(std::abs(value) < 0.5e-8 ? 0.0 : value, kDecimals);  // no "-0.00000000"
}

}  // namespace

Status write_live_link_csv(const Motion& motion, const TextSink& sink) {
  if (motion.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "Live Link CSV", "the motion is not made of ARKit coefficients", ""};
  MIEN_TRY([[maybe_unused]] const auto checked, check_motion(motion, "Live Link CSV"));

  // Columns of the file: index in the motion and the factor that turns its unit into the file's.
  struct Column {
    std::optional<std::int64_t> channel;
    double factor = 1;
  };
  std::vector<Column> columns;
  std::vector<bool> used(motion.channels.size());
  std::string line = "Timecode,BlendShapeCount";
  const auto add = [&](const std::string& name, double factor) {
    const auto channel = motion.find(name);
    if (channel) used[static_cast<std::size_t>(*channel)] = true;
    columns.push_back({channel, factor});
    line += "," + capitalised(name);
  };
  for (const auto& name : arkit_order(ArkitOrder::live_link_csv)) add(name, 1);
  for (const auto name : kRotationNames) add(std::string(name), std::numbers::pi / 180);
  line += "\n";
  MIEN_TRY([[maybe_unused]] const auto header, sink(line));

  const std::string count = "," + std::to_string(columns.size());
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    line = timecode_text(n, motion.fps) + count;
    const auto frame = motion.frame(n);
    for (const Column& column : columns)
      append_number(line,
                    column.channel ? column.factor * frame[static_cast<std::size_t>(*column.channel)] : 0.0);
    line += "\n";
    MIEN_TRY([[maybe_unused]] const auto row, sink(line));
  }

  Status status{Done{}};
  std::vector<std::string> lost;
  for (std::size_t c = 0; c < used.size(); ++c)
    if (!used[c]) lost.push_back(motion.channels[c]);
  if (!lost.empty())
    status.warnings.push_back("channels that Live Link CSV has no column for: " + listed(lost));
  return status;
}

Result<std::string> live_link_csv(const Motion& motion) {
  std::string text;
  const auto status = write_live_link_csv(motion, [&](std::string_view piece) -> Status {
    text += piece;
    return Done{};
  });
  if (!status) return status.error();
  Result<std::string> result(std::move(text));
  result.warnings = status.warnings;
  return result;
}

}  // namespace mien

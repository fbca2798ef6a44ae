#include <algorithm>

#include "inspect.h"
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/io/motion_file.h"

namespace mien {
namespace {

std::string_view space_name(MotionSpace space) {
  switch (space) {
    case MotionSpace::arkit:
      return "arkit";
    case MotionSpace::flame:
      return "flame";
    case MotionSpace::vertices:
      return "vertices";
    case MotionSpace::rig:
      return "rig";
  }
  return "rig";
}

struct Range {
  double low = 0, mean = 0, high = 0;
};

Range range_of(const Motion& motion, std::size_t channel) {
  const std::size_t width = motion.channels.size();
  Range range{motion.values[channel], 0, motion.values[channel]};
  for (std::size_t i = channel; i < motion.values.size(); i += width) {
    const double v = motion.values[i];
    range.low = std::min(range.low, v);
    range.high = std::max(range.high, v);
    range.mean += v / static_cast<double>(motion.num_frames());
  }
  return range;
}

}  // namespace

void add_motion_facts(const Motion& motion, Facts& facts) {
  facts.add("space", space_name(motion.space));
  facts.add("fps", motion.fps, 3);
  facts.add("frames", motion.num_frames());
  facts.add("seconds", motion.seconds(), 3, "s");
  facts.add("channels", motion.num_channels());
  if (motion.num_frames() == 0) return;
  constexpr std::size_t kMostRows = 200;  // a mesh has thousands of channels
  const std::size_t rows = std::min(motion.channels.size(), kMostRows);
  std::size_t width = 0;
  for (std::size_t c = 0; c < rows; ++c) width = std::max(width, motion.channels[c].size());
  const auto right = [](const std::string& number) {
    return std::string(10 - std::min<std::size_t>(10, number.size()), ' ') + number;
  };
  std::string text =
      "  " + std::string(width, ' ') + right("lowest") + right("mean") + right("highest") + "\n";
  std::string json;
  for (std::size_t c = 0; c < rows; ++c) {
    const Range r = range_of(motion, c);
    const std::string& name = motion.channels[c];
    text += "  " + name + std::string(width - name.size(), ' ') + right(fixed(r.low, 3)) +
            right(fixed(r.mean, 3)) + right(fixed(r.high, 3)) + "\n";
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(name) +
            ",\"lowest\":" + fixed(r.low, 4) + ",\"mean\":" + fixed(r.mean, 4) +
            ",\"highest\":" + fixed(r.high, 4) + "}";
  }
  if (rows < motion.channels.size())
    text += "  and " + std::to_string(motion.channels.size() - rows) + " more channels\n";
  facts.add_table("ranges", std::move(text), "[" + json + "]");
}

Result<Facts> inspect_motion(const std::filesystem::path& path) {
  auto motion = read_motion(path);
  if (!motion) return motion.error();
  Facts facts;
  facts.add("kind", "motion");
  facts.add("file", path.string());
  add_motion_facts(*motion, facts);
  Result<Facts> result = std::move(facts);
  result.warnings = std::move(motion.warnings);
  return result;
}

}  // namespace mien

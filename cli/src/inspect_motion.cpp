#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

std::string point(const std::array<double, 3>& p) {
  return fixed(p[0], 4) + " " + fixed(p[1], 4) + " " + fixed(p[2], 4);
}

std::string point_json(const std::array<double, 3>& p) {
  return "[" + fixed(p[0], 6) + "," + fixed(p[1], 6) + "," + fixed(p[2], 6) + "]";
}

// Of tens of thousands of channels the box and what moves most say more than a table.
void add_vertex_facts(const Motion& motion, Facts& facts) {
  const auto known = known_topology(motion.topology.num_vertices);
  facts.add("topology", motion.topology.name.empty() ? "unknown" : motion.topology.name);
  facts.add("vertices", motion.topology.num_vertices);
  facts.add("units", known ? known->units : "unknown");
  if (motion.num_frames() == 0) return;
  std::array<double, 3> low, high;
  low.fill(std::numeric_limits<double>::infinity()), high.fill(-std::numeric_limits<double>::infinity());
  const auto num_frames = static_cast<double>(motion.num_frames());
  const auto width = static_cast<std::size_t>(motion.num_channels());
  double farthest = -1, mean_movement = 0;
  std::size_t most_moved = 0;
  for (std::size_t v = 0; v < width; v += 3) {
    double variance = 0;  // of the position, all three axes
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0, squares = 0;
      const double first = motion.values[v + axis];  // differences keep their digits far from the origin
      for (std::size_t i = v + axis; i < motion.values.size(); i += width) {
        low[axis] = std::min(low[axis], static_cast<double>(motion.values[i]));
        high[axis] = std::max(high[axis], static_cast<double>(motion.values[i]));
        const double d = motion.values[i] - first;
        sum += d, squares += d * d;
      }
      variance += std::max(0.0, squares / num_frames - sum / num_frames * (sum / num_frames));
    }
    const double movement = std::sqrt(variance);
    mean_movement += movement / static_cast<double>(motion.topology.num_vertices);
    if (movement > farthest) farthest = movement, most_moved = v / 3;
  }
  facts.add_table("box", "  lowest   " + point(low) + "\n  highest  " + point(high) + "\n",
                  "{\"lowest\":" + point_json(low) + ",\"highest\":" + point_json(high) + "}");
  facts.add("mean_movement", mean_movement, 6);
  facts.add("largest_movement", farthest, 6);
  facts.add("most_moved_vertex", static_cast<std::int64_t>(most_moved));
}

}  // namespace

void add_motion_facts(const Motion& motion, Facts& facts) {
  facts.add("space", space_name(motion.space));
  facts.add("fps", motion.fps, 3);
  facts.add("frames", motion.num_frames());
  facts.add("seconds", motion.seconds(), 3, "s");
  facts.add("channels", motion.num_channels());
  if (motion.space == MotionSpace::vertices) return add_vertex_facts(motion, facts);
  if (motion.num_frames() == 0) return;
  constexpr std::size_t kMostRows = 200;
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

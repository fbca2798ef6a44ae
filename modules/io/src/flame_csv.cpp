#include "mien/io/flame_csv.h"

#include <cmath>
#include <set>

#include "csv_text.h"
#include "even_motion.h"
#include "frame_text.h"
#include "mien/base/number_text.h"
#include "mien/core/flame_parameters.h"

namespace mien {
namespace {

constexpr std::string_view kTime = "time";
constexpr double kUsualFps = 25;  // of ProbTalk3D's data

Error bad(std::size_t line, const std::string& why) {
  return {Errc::input, "FLAME CSV, line " + std::to_string(line), why, ""};
}

// The text up to the next line end, which is taken off; without a carriage return.
std::string_view next_line(std::string_view& text) {
  const auto end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// Frames a second of rows at these times, which must lie evenly.
Result<double> rate_of(const std::vector<double>& times) {
  if (times.size() < 2) return kUsualFps;
  const double rate = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  const double fps = std::abs(rate - std::round(rate)) < 1e-3 * rate ? std::round(rate) : rate;
  if (!io::is_frame_rate(fps))
    return Error{Errc::input, "FLAME CSV", "its times do not rise by a usual frame", ""};
  for (std::size_t n = 0; n < times.size(); ++n)
    if (std::abs((times[n] - times.front()) * fps - static_cast<double>(n)) > 0.1)
      return bad(n + 2, "its time is not that of frame " + std::to_string(n) + ": rows must be even");
  return fps;
}

class FlameText final : public io::FrameText {
 public:
  explicit FlameText(const Motion& format) : fps_(format.fps), head_(kTime) {
    for (const auto& channel : format.channels) head_.append(1, ',').append(channel);
    head_ += '\n';
  }
  [[nodiscard]] std::string_view name() const override { return "FLAME CSV"; }
  [[nodiscard]] std::string head() const override { return head_; }
  void append(std::string& text, std::int64_t n, std::span<const float> frame) const override {
    text += fixed(static_cast<double>(n) / fps_, 6);
    for (const float value : frame) text.append(1, ',').append(shortest(value));
    text += '\n';
  }

 private:
  double fps_;
  std::string head_;
};

}  // namespace

Result<std::unique_ptr<io::FrameText>> io::flame_text(const Motion& format) {
  if (format.space != MotionSpace::flame)
    return Error{Errc::incompatible, "FLAME CSV", "the motion is not made of FLAME parameters", ""};
  return std::unique_ptr<FrameText>(std::make_unique<FlameText>(format));
}

Status write_flame_csv(const Motion& motion, const TextSink& sink) {
  MIEN_TRY(const auto text, io::flame_text(motion));
  return io::write_text(*text, motion, sink);
}

bool is_flame_csv(std::string_view text) {
  for (const auto field : io::split(next_line(text)))
    if (flame_column(field)) return true;
  return false;
}

Result<Motion> read_flame_csv(std::string_view text, double fps) {
  Motion motion{MotionSpace::flame, {}, kUsualFps, {}};
  const auto header = io::split(next_line(text));
  const bool has_time = header.front() == kTime;
  std::set<std::string_view> seen;
  for (std::size_t i = has_time ? 1 : 0; i < header.size(); ++i) {
    if (!flame_column(header[i])) return bad(1, "'" + std::string(header[i]) + "' is no FLAME parameter");
    if (!seen.insert(header[i]).second) return bad(1, "'" + std::string(header[i]) + "' comes twice");
    motion.channels.emplace_back(header[i]);
  }
  if (motion.channels.empty()) return bad(1, "names no FLAME parameter");
  std::vector<double> times;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view row = next_line(text);
    if (row.empty()) continue;
    const auto fields = io::split(row);
    if (fields.size() != header.size())
      return bad(line, "has " + std::to_string(fields.size()) + " fields, the header " +
                           std::to_string(header.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto number = parse_double(fields[i]);
      if (!number || !std::isfinite(static_cast<float>(*number)))
        return bad(line, "'" + std::string(fields[i]) + "' is no number");
      if (i == 0 && has_time)
        times.push_back(*number);
      else
        motion.values.push_back(static_cast<float>(*number));
    }
  }
  motion.fps = fps;
  if (!(fps > 0)) {
    MIEN_TRY(motion.fps, rate_of(times));
  }
  return motion;
}

}  // namespace mien

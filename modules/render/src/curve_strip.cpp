#include "mien/render/curve_strip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mien/render/heat_colors.h"
#include "mien/render/text.h"

namespace mien {
namespace {

constexpr Rgb8 kPaper{246, 246, 247}, kGrid{214, 214, 218}, kPlayhead{200, 30, 30}, kOutside{226, 226, 229};
constexpr std::array<Rgb8, 6> kPens = {
    {{30, 90, 180}, {200, 90, 20}, {30, 140, 70}, {150, 50, 150}, {90, 90, 90}, {170, 140, 0}}};
constexpr double kSpectrogramShare = 0.4;

// Rows of the strip that curves use.
struct Plot {
  int top, height;
};

void draw_spectrogram(Image& strip, int height, const Features& log_mel, const CurveStripOptions& options) {
  // The range of what is shown by the whole clip, so that it does not flicker while time runs.
  float low = 0, high = 0;
  bool any = false;
  for (const float v : log_mel.values) {
    if (!std::isfinite(v)) continue;
    low = any ? std::min(low, v) : v, high = any ? std::max(high, v) : v;
    any = true;
  }
  low = std::max(low, high - 9.2f);  // 40 dB of power: below it is room noise
  const float scale = high > low ? 1.0f / (high - low) : 0.0f;
  for (int i = 0; i < strip.width(); ++i) {
    const double time = options.start_seconds + (i + 0.5) * options.seconds / strip.width();
    const auto frame = std::llround(time * log_mel.frame_rate_hz);
    if (frame < 0 || frame >= log_mel.num_frames()) continue;
    const auto values = log_mel.frame(frame);
    for (int j = 0; j < height; ++j) {
      const auto band = static_cast<std::size_t>((height - 1 - j) * log_mel.width / height);
      strip.at(i, j) = heat_color((values[band] - low) * scale);
    }
  }
}

void draw_curve(Image& strip, const Plot& plot, const Motion& motion, std::size_t channel,
                const CurveStripOptions& options, Rgb8 pen) {
  const double pixels_per_frame = strip.width() / (options.seconds * motion.fps);
  const auto first = static_cast<std::int64_t>(std::floor(options.start_seconds * motion.fps));
  const auto last =
      static_cast<std::int64_t>(std::ceil((options.start_seconds + options.seconds) * motion.fps));
  float x0 = 0, y0 = 0;
  bool has_point = false;
  for (std::int64_t n = std::max<std::int64_t>(0, first); n <= std::min(last, motion.num_frames() - 1); ++n) {
    const double column = (static_cast<double>(n) - options.start_seconds * motion.fps) * pixels_per_frame;
    const float value = motion.frame(n)[channel];
    const float clamped = value > -0.1f ? std::min(value, 1.1f) : -0.1f;
    const auto x1 = static_cast<float>(column);
    const float y1 = static_cast<float>(plot.top) + (1.0f - clamped) * static_cast<float>(plot.height - 1);
    const bool inside = column >= 0 && column < strip.width() && std::isfinite(value);
    if (has_point && inside) draw_line(strip, x0, y0, x1, y1, 1.2f, pen);
    x0 = x1, y0 = y1, has_point = inside;
  }
}

}  // namespace

Image curve_strip(int width, int height, const Motion& motion, const Features* log_mel,
                  const CurveStripOptions& options) {
  if (width <= 0 || height <= 0 || !(options.seconds > 0)) return {};
  Image strip(width, height, kPaper);
  const auto column = [&](double time) {
    const double position = (time - options.start_seconds) * width / options.seconds;
    return static_cast<int>(std::clamp(position, 0.0, static_cast<double>(width)));
  };
  // Before the beginning and after the end.
  fill_rectangle(strip, 0, 0, column(0), height, kOutside);
  fill_rectangle(strip, column(motion.seconds()), 0, width - column(motion.seconds()), height, kOutside);

  int top = 0;
  if (log_mel != nullptr && log_mel->num_frames() > 0 && log_mel->frame_rate_hz > 0) {
    top = static_cast<int>(height * kSpectrogramShare);
    draw_spectrogram(strip, top, *log_mel, options);
  }
  const Plot plot{top + kTextHeight, std::max(1, height - top - kTextHeight - 3)};
  for (const int line : {plot.top, plot.top + (plot.height - 1) / 2, plot.top + plot.height - 1})
    fill_rectangle(strip, 0, line, width, 1, kGrid);
  int text_x = 3;
  std::size_t pen = 0;
  for (const std::string& name : options.channels) {
    const auto channel = motion.find(name);
    if (!channel) continue;
    const Rgb8 color = kPens[pen++ % kPens.size()];
    draw_curve(strip, plot, motion, static_cast<std::size_t>(*channel), options, color);
    if (text_x + text_width(name) <= width) draw_text(strip, text_x, top, name, {color, 1});
    text_x += text_width(name) + kTextAdvance;
  }
  if (options.playhead_seconds >= options.start_seconds &&
      options.playhead_seconds < options.start_seconds + options.seconds)
    fill_rectangle(strip, column(options.playhead_seconds), 0, 1, height, kPlayhead);
  return strip;
}

}  // namespace mien

#include "mien/io/coefficient_csv.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "frame_text.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "shape_names.h"

namespace mien {
namespace {

// A float32 as numpy prints it: decimal from 1e-4 on and below 1e16, always with a dot, else with an
// exponent.
std::string numpy_text(float value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0.0";
  char buffer[64];
  const auto written = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::scientific);
  std::string_view text(buffer, static_cast<std::size_t>(written.ptr - buffer));
  std::string out;
  if (text.front() == '-') {
    out = "-";
    text.remove_prefix(1);
  }
  const auto e = text.find('e');
  const int exponent = std::atoi(std::string(text.substr(e + 1)).c_str());
  if (exponent < -4 || exponent >= 16) return out + std::string(text);
  std::string digits(text.substr(0, e));
  std::erase(digits, '.');
  if (exponent < 0) return out + "0." + std::string(static_cast<std::size_t>(-exponent - 1), '0') + digits;
  const auto whole = static_cast<std::size_t>(exponent) + 1;
  if (digits.size() < whole) digits.append(whole - digits.size(), '0');
  if (digits.size() == whole) digits += '0';
  return out + digits.substr(0, whole) + "." + digits.substr(whole);
}

class CoefficientText final : public io::FrameText {
 public:
  explicit CoefficientText(const Motion& format) : fps_(format.fps) {
    std::vector<bool> used(format.channels.size());
    for (const std::string& name : arkit_order(ArkitOrder::said)) {
      columns_.push_back(format.find(name));
      if (columns_.back()) used[static_cast<std::size_t>(*columns_.back())] = true;
      head_ += (head_.empty() ? "" : ",") + name;
    }
    head_ += "\n";
    for (std::size_t c = 0; c < used.size(); ++c)
      if (!used[c]) lost_.push_back(format.channels[c]);
  }
  [[nodiscard]] std::string_view name() const override { return "coefficient CSV"; }
  [[nodiscard]] std::string head() const override { return head_; }
  void append(std::string& text, std::int64_t /*n*/, std::span<const float> frame) const override {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (c > 0) text += ',';
      text += columns_[c] ? numpy_text(frame[static_cast<std::size_t>(*columns_[c])]) : "0.0";
    }
    text += '\n';
  }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    constexpr double kFps = 60;
    std::vector<std::string> all;
    if (!lost_.empty()) all.push_back("channels that SAiD's CSV has no column for: " + io::listed(lost_));
    if (fps_ != kFps)
      all.push_back("SAiD's CSV states no rate and is taken for 60 frames a second; the motion has " +
                    fixed(fps_, 2));
    return all;
  }

 private:
  double fps_;
  std::string head_;
  std::vector<std::optional<std::int64_t>> columns_;  // of the file, by index in the motion
  std::vector<std::string> lost_;
};

}  // namespace

Result<std::unique_ptr<io::FrameText>> io::coefficient_text(const Motion& format) {
  if (format.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "coefficient CSV", "the motion is not made of ARKit coefficients", ""};
  return std::unique_ptr<FrameText>(std::make_unique<CoefficientText>(format));
}

Status write_coefficient_csv(const Motion& motion, const TextSink& sink) {
  MIEN_TRY(const auto text, io::coefficient_text(motion));
  return io::write_text(*text, motion, sink);
}

}  // namespace mien

#include "mien/io/metahuman_csv.h"

#include <cctype>
#include <cmath>
#include <optional>

#include "frame_text.h"
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

namespace {

class MetahumanText final : public io::FrameText {
 public:
  explicit MetahumanText(const Motion& format) : fps_(format.fps), head_("Timecode,BlendShapeCount") {
    std::vector<bool> used(format.channels.size());
    for (std::string name : arkit_order(ArkitOrder::beat)) {
      columns_.push_back(format.find(name));
      if (columns_.back()) used[static_cast<std::size_t>(*columns_.back())] = true;
      name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
      head_ += "," + name;
    }
    head_ += "\n";
    for (std::size_t c = 0; c < used.size(); ++c)
      if (!used[c]) lost_.push_back(format.channels[c]);
  }
  [[nodiscard]] std::string_view name() const override { return "MetaHuman CSV"; }
  [[nodiscard]] std::string head() const override { return head_; }
  void append(std::string& text, std::int64_t n, std::span<const float> frame) const override {
    text += metahuman_timecode(n, fps_) + "," + std::to_string(columns_.size());
    for (const auto& column : columns_)
      text += "," + (column ? shortest(frame[static_cast<std::size_t>(*column)]) : std::string("0"));
    text += "\n";
  }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    if (lost_.empty()) return {};
    return {"channels that MetaHuman CSV has no column for: " + io::listed(lost_)};
  }

 private:
  double fps_;
  std::string head_;
  std::vector<std::optional<std::int64_t>> columns_;  // of the file, by index in the motion
  std::vector<std::string> lost_;
};

}  // namespace

Result<std::unique_ptr<io::FrameText>> io::metahuman_text(const Motion& format) {
  if (format.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "MetaHuman CSV", "the motion is not made of ARKit coefficients", ""};
  return std::unique_ptr<FrameText>(std::make_unique<MetahumanText>(format));
}

Status write_metahuman_csv(const Motion& motion, const TextSink& sink) {
  MIEN_TRY(const auto text, io::metahuman_text(motion));
  return io::write_text(*text, motion, sink);
}

}  // namespace mien

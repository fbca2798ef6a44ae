#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>

#include "capitalised.h"
#include "frame_text.h"
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

void append_number(std::string& line, double value) {
  line += ',';
  line += fixed(std::abs(value) < 0.5e-8 ? 0.0 : value, kDecimals);  // no "-0.00000000"
}

class LiveLinkText final : public FrameText {
 public:
  explicit LiveLinkText(const Motion& format) : fps_(format.fps), head_("Timecode,BlendShapeCount") {
    std::vector<bool> used(format.channels.size());
    const auto add = [&](const std::string& name, double factor) {
      const auto channel = format.find(name);
      if (channel) used[static_cast<std::size_t>(*channel)] = true;
      columns_.push_back({channel, factor});
      head_ += "," + capitalised(name);
    };
    for (const auto& name : arkit_order(ArkitOrder::live_link_csv)) add(name, 1);
    for (const auto name : kRotationNames) add(std::string(name), std::numbers::pi / 180);
    head_ += "\n";
    for (std::size_t c = 0; c < used.size(); ++c)
      if (!used[c]) lost_.push_back(format.channels[c]);
  }
  [[nodiscard]] std::string_view name() const override { return "Live Link CSV"; }
  [[nodiscard]] std::string head() const override { return head_; }
  void append(std::string& text, std::int64_t n, std::span<const float> frame) const override {
    text += timecode_text(n, fps_) + "," + std::to_string(columns_.size());
    for (const Column& column : columns_)
      append_number(text,
                    column.channel ? column.factor * frame[static_cast<std::size_t>(*column.channel)] : 0.0);
    text += "\n";
  }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    if (lost_.empty()) return {};
    return {"channels that Live Link CSV has no column for: " + listed(lost_)};
  }

 private:
  // Index in the motion and the factor that turns its unit into the file's.
  struct Column {
    std::optional<std::int64_t> channel;
    double factor = 1;
  };
  double fps_;
  std::string head_;
  std::vector<Column> columns_;
  std::vector<std::string> lost_;
};

}  // namespace

Result<std::unique_ptr<io::FrameText>> io::live_link_text(const Motion& format) {
  if (format.space != MotionSpace::arkit)
    return Error{Errc::incompatible, "Live Link CSV", "the motion is not made of ARKit coefficients", ""};
  return std::unique_ptr<FrameText>(std::make_unique<LiveLinkText>(format));
}

Status write_live_link_csv(const Motion& motion, const TextSink& sink) {
  MIEN_TRY(const auto text, live_link_text(motion));
  return write_text(*text, motion, sink);
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

#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien::io {

/// A text format of motion that can be written while frames arrive.
class FrameText {
 public:
  virtual ~FrameText() = default;
  /// What errors call it.
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string head() const = 0;
  /// Appends frame n, [C].
  virtual void append(std::string& text, std::int64_t n, std::span<const float> frame) const = 0;
  [[nodiscard]] virtual std::string_view tail() const { return ""; }
  /// What the format cannot hold.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
};

// The formats of live_link_csv.h, metahuman_csv.h, coefficient_csv.h, flame_csv.h and motion_json.h for
// motion with the space, channels, rate and topology of `format`, whose frames are not looked at. Errors:
// Errc::incompatible for a space that the format does not have.
Result<std::unique_ptr<FrameText>> live_link_text(const Motion& format);
Result<std::unique_ptr<FrameText>> metahuman_text(const Motion& format);
Result<std::unique_ptr<FrameText>> coefficient_text(const Motion& format);
Result<std::unique_ptr<FrameText>> flame_text(const Motion& format);
std::unique_ptr<FrameText> motion_json_text(const Motion& format, std::string_view audio_name);

/// A whole motion, frame by frame. Errors: those of check_motion() and of the sink.
Status write_text(const FrameText& text, const Motion& motion, const TextSink& sink);

}  // namespace mien::io

#include "frame_text.h"

#include "even_motion.h"

namespace mien::io {

Status write_text(const FrameText& text, const Motion& motion, const TextSink& sink) {
  MIEN_TRY([[maybe_unused]] const auto checked, check_motion(motion, text.name()));
  MIEN_TRY([[maybe_unused]] const auto head, sink(text.head()));
  std::string row;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    row.clear();
    text.append(row, n, motion.frame(n));
    MIEN_TRY([[maybe_unused]] const auto sent, sink(row));
  }
  if (!text.tail().empty()) {
    MIEN_TRY([[maybe_unused]] const auto tail, sink(text.tail()));
  }
  Status status{Done{}};
  status.warnings = text.warnings();
  return status;
}

}  // namespace mien::io

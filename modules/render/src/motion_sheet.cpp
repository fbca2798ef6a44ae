#include "mien/render/motion_sheet.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/render/text.h"

namespace mien {
namespace {

constexpr int kMaxSide = 16384, kGap = 2, kMargin = 6;
constexpr int kPixelsPerScale = 128;  // of a picture's height: letters of 14 pixels beside one of 256

}  // namespace

Result<Image> motion_sheet(std::span<const MotionPicture> rows, std::span<const std::string> labels,
                           std::span<const double> times, int num_threads) {
  contract(!rows.empty() && rows.size() == labels.size(), "motion_sheet: one label for each row expected");
  const int width = rows.front().width(), height = rows.front().height();
  for (const MotionPicture& row : rows)
    contract(row.width() == width && row.height() == height, "motion_sheet: pictures of one size expected");
  if (times.empty()) return Error{Errc::usage, "sheet", "there is no instant to show", ""};
  const int scale = std::max(1, height / kPixelsPerScale);
  int label_width = 0;
  for (const std::string& label : labels) label_width = std::max(label_width, text_width(label, scale));
  const int left = std::min(label_width, width) + 2 * kMargin, top = kTextHeight * scale + 2;
  const std::int64_t wide = left + static_cast<std::int64_t>(times.size()) * (width + kGap),
                     high = top + static_cast<std::int64_t>(rows.size()) * (height + kGap);
  if (wide > kMaxSide || high > kMaxSide)
    return Error{Errc::usage, "sheet",
                 "would be larger than " + std::to_string(kMaxSide) + " pixels on a side",
                 "Choose fewer instants, fewer motions or a smaller picture"};
  Image sheet(static_cast<int>(wide), static_cast<int>(high), {255, 255, 255});
  const auto num_times = static_cast<std::int64_t>(times.size());
  const TextStyle style{.scale = scale};
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::string text = fit_text(fixed(times[i], 2) + " s", width, scale);
    draw_text(sheet, left + static_cast<int>(i) * (width + kGap) + (width - text_width(text, scale)) / 2, 0,
              text, style);
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    draw_text(sheet, kMargin,
              top + static_cast<int>(i) * (height + kGap) + (height - kTextHeight * scale) / 2,
              fit_text(labels[i], width, scale), style);
  // Pictures lie apart, so each can be put in its place at once.
  parallel_for(num_threads, static_cast<std::int64_t>(rows.size()) * num_times, [&](std::int64_t i) {
    const std::int64_t row = i / num_times, column = i % num_times;
    blit(sheet, rows[static_cast<std::size_t>(row)].at(times[static_cast<std::size_t>(column)]),
         left + static_cast<int>(column) * (width + kGap), top + static_cast<int>(row) * (height + kGap));
  });
  return sheet;
}

}  // namespace mien

#include "pictures.h"

#include "mien/base/number_text.h"
#include "mien/render/motion_picture.h"
#include "mien/render/motion_sheet.h"
#include "mien/render/motion_video.h"
#include "mien/render/png.h"

namespace mien {
namespace {

constexpr int kSheetCells = 12, kSheetColumns = 6;  // instants of one motion, and of several

Result<Image> draw_sheet(const Character& character, const std::vector<const Motion*>& motions,
                         const MotionPicture& all, MotionPictureOptions look, const PictureOptions& options) {
  std::vector<double> times = options.times;
  const int count = motions.size() > 1 ? kSheetColumns : kSheetCells;
  if (times.empty())
    for (int i = 0; i < count; ++i) times.push_back(all.seconds() * (i + 0.5) / count);
  if (motions.size() == 1 || times.size() == 1) {
    std::vector<SheetCell> cells;
    for (const double t : times) cells.push_back({t, ""});
    return contact_sheet(all, cells, options.columns, options.threads);
  }
  look.labels.clear();
  std::vector<MotionPicture> rows;
  for (const Motion* motion : motions) {
    MIEN_TRY(MotionPicture row, MotionPicture::create(character, {motion}, look));
    rows.push_back(std::move(row));
  }
  std::vector<std::string> labels = options.labels;
  labels.resize(motions.size());
  return motion_sheet(rows, labels, times, options.threads);
}

}  // namespace

Result<std::pair<int, int>> parse_size(const std::string& text) {
  const auto cross = text.find('x');
  const auto width = parse_int(text.substr(0, cross));
  const auto height = cross == std::string::npos ? width : parse_int(text.substr(cross + 1));
  if (!width || !height || *width < 16 || *width > 8192 || *height < 16 || *height > 8192)
    return Error{Errc::usage, "--size '" + text + "'", "is not a size of 16 to 8192 pixels",
                 "For example --size 512 or --size 640x480"};
  return std::pair(static_cast<int>(*width), static_cast<int>(*height));
}

Status check_view(const std::string& name) {
  const auto view = parse_view(name);
  if (!view) return within(view.error(), "--view");
  return Done{};
}

Result<std::vector<double>> parse_times(const std::string& text) {
  std::vector<double> times;
  for (std::size_t at = 0; at <= text.size();) {
    const auto end = std::min(text.find(',', at), text.size());
    const auto time = parse_double(std::string_view(text).substr(at, end - at));
    if (!time || !(*time >= 0 && *time < 1e6))
      return Error{Errc::usage, "--times '" + text + "'",
                   "'" + text.substr(at, end - at) + "' is not a time in seconds",
                   "For example --times 0.5,1.25,2"};
    times.push_back(*time);
    at = end + 1;
  }
  return times;
}

Status write_pictures(const Output& output, const std::vector<const Motion*>& motions,
                      const Character& character, const AudioClip* sound, const PictureOptions& options,
                      Progress& progress) {
  MotionPictureOptions look;
  look.shading.width = options.width;
  look.shading.height = options.height;
  look.labels = options.labels;
  look.columns = options.columns;
  MIEN_TRY(look.view, parse_view(options.view));
  auto picture = MotionPicture::create(character, motions, look);
  if (!picture) return picture.error();
  const FilmOptions film{.fps = options.fps, .num_threads = options.threads};
  Status status = Done{};
  if (output.kind == OutputKind::sheet) {
    MIEN_TRY(const Image sheet, draw_sheet(character, motions, *picture, look, options));
    status = write_png(output.path, sheet);
  } else if (output.kind == OutputKind::frames) {
    status = write_motion_frames(output.path, *picture, film, progress);
  } else {
    status = write_motion_video(output.path, *picture, sound, film, progress);
  }
  if (status)
    status.warnings.insert(status.warnings.begin(), picture.warnings.begin(), picture.warnings.end());
  return status;
}

Status write_pictures(const Output& output, const Motion& motion, const Character& character,
                      const AudioClip* sound, const PictureOptions& options, Progress& progress) {
  return write_pictures(output, std::vector{&motion}, character, sound, options, progress);
}

}  // namespace mien

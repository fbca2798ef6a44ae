#include "pictures.h"

#include "mien/base/number_text.h"
#include "mien/render/motion_picture.h"
#include "mien/render/motion_video.h"
#include "mien/render/png.h"

namespace mien {
namespace {

constexpr int kSheetCells = 12;

Status write_sheet(const std::filesystem::path& path, const MotionPicture& picture,
                   const PictureOptions& options) {
  std::vector<SheetCell> cells;
  for (const double t : options.times) cells.push_back({t, ""});
  if (cells.empty())
    for (int i = 0; i < kSheetCells; ++i) cells.push_back({picture.seconds() * (i + 0.5) / kSheetCells, ""});
  MIEN_TRY(const Image sheet, contact_sheet(picture, cells, options.columns, options.threads));
  return write_png(path, sheet);
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
  MIEN_TRY(look.view, parse_view(options.view));
  auto picture = MotionPicture::create(character, motions, look);
  if (!picture) return picture.error();
  const FilmOptions film{.fps = options.fps, .num_threads = options.threads};
  Status status = output.kind == OutputKind::sheet ? write_sheet(output.path, *picture, options)
                  : output.kind == OutputKind::frames
                      ? write_motion_frames(output.path, *picture, film, progress)
                      : write_motion_video(output.path, *picture, sound, film, progress);
  if (status)
    status.warnings.insert(status.warnings.begin(), picture.warnings.begin(), picture.warnings.end());
  return status;
}

Status write_pictures(const Output& output, const Motion& motion, const Character& character,
                      const AudioClip* sound, const PictureOptions& options, Progress& progress) {
  return write_pictures(output, std::vector{&motion}, character, sound, options, progress);
}

}  // namespace mien

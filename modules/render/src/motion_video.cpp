#include "mien/render/motion_video.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/render/png.h"
#include "mien/render/text.h"
#include "mien/render/video.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr int kPicturesPerThread = 3;  // in memory at a time: one batch being drawn and one being written
constexpr int kMaxSheetSide = 16384;

Error cancelled_error() { return {Errc::cancelled, "rendering", "cancelled", ""}; }

Result<std::int64_t> count_frames(const MotionPicture& picture, const FilmOptions& options) {
  if (!(options.fps >= 1 && options.fps <= 240))
    return Error{Errc::usage, "frame rate", "expected 1 to 240 frames a second", ""};
  const std::int64_t count = num_motion_frames(picture.seconds(), options.fps);
  if (count == 0) return Error{Errc::failed, "motion", "is too short: there is no frame to show", ""};
  return count;
}

std::string frame_name(std::int64_t n) {
  std::string digits = std::to_string(n);
  return "frame_" + std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + ".png";
}

}  // namespace

Status write_motion_video(const fs::path& path, const MotionPicture& picture, const AudioClip* sound,
                          const FilmOptions& options, Progress& progress) {
  MIEN_TRY(const std::int64_t num_frames, count_frames(picture, options));
  VideoOptions video;
  video.width = picture.width(), video.height = picture.height();
  video.fps = options.fps;
  if (sound != nullptr) video.sound_rate_hz = sound->sample_rate_hz;
  MIEN_TRY(VideoWriter writer, VideoWriter::create(path, video));
  progress.stage("rendering", num_frames);

  // Sound of frame n: what is heard from n / fps to (n + 1) / fps.
  const auto samples_until = [&](std::int64_t n) {
    const double end = static_cast<double>(n) / options.fps * sound->sample_rate_hz;
    return std::min(static_cast<std::size_t>(std::llround(end)), sound->samples.size());
  };
  std::int64_t num_written = 0;
  const auto write = [&](const std::vector<Image>& pictures) -> Status {
    for (const Image& image : pictures) {
      if (sound != nullptr) {
        const std::size_t begin = samples_until(num_written), end = samples_until(num_written + 1);
        MIEN_TRY([[maybe_unused]] const auto heard,
                 writer.add_sound(std::span(sound->samples).subspan(begin, end - begin)));
      }
      MIEN_TRY([[maybe_unused]] const auto shown, writer.add_frame(image));
      ++num_written;
    }
    return Done{};
  };

  // One item of the parallel loop encodes the last batch while the others draw the next one.
  const std::int64_t batch_size =
      static_cast<std::int64_t>(std::max(1, options.num_threads)) * kPicturesPerThread;
  std::vector<Image> drawn, next;
  for (std::int64_t first = 0; first < num_frames || !drawn.empty(); first += batch_size) {
    if (progress.cancelled()) return cancelled_error();
    next.assign(static_cast<std::size_t>(std::clamp<std::int64_t>(num_frames - first, 0, batch_size)),
                Image());
    Status written = Done{};
    parallel_for(options.num_threads, static_cast<std::int64_t>(next.size()) + 1, [&](std::int64_t i) {
      if (i == 0)
        written = write(drawn);
      else
        next[static_cast<std::size_t>(i - 1)] = picture.at(static_cast<double>(first + i - 1) / options.fps);
    });
    if (!written) return written.error();
    progress.update(num_written);
    drawn.swap(next);
  }
  return writer.finish();
}

Status write_motion_frames(const fs::path& folder, const MotionPicture& picture, const FilmOptions& options,
                           Progress& progress) {
  MIEN_TRY(const std::int64_t num_frames, count_frames(picture, options));
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (!fs::is_directory(folder, ec))
    return Error{Errc::failed, "'" + folder.string() + "'", "the folder cannot be made",
                 "Check that the name is not taken by a file and that the place may be written to"};
  progress.stage("rendering", num_frames);
  const std::int64_t batch_size = std::max(1, options.num_threads) * std::int64_t{kPicturesPerThread};
  for (std::int64_t first = 0; first < num_frames; first += batch_size) {
    if (progress.cancelled()) return cancelled_error();
    const std::int64_t count = std::min(batch_size, num_frames - first);
    std::vector<std::optional<Error>> errors(static_cast<std::size_t>(count));
    parallel_for(options.num_threads, count, [&](std::int64_t i) {
      const std::int64_t n = first + i;
      const Status status =
          write_png(folder / frame_name(n), picture.at(static_cast<double>(n) / options.fps));
      if (!status) errors[static_cast<std::size_t>(i)] = status.error();
    });
    for (const auto& error : errors)
      if (error) return *error;
    progress.update(first + count);
  }
  Status result = Done{};
  if (fs::exists(folder / frame_name(num_frames), ec))
    result.warnings.push_back("'" + folder.string() + "' still holds later frames of an earlier film, from " +
                              frame_name(num_frames) + " on");
  return result;
}

Image make_grid(std::span<const Image> pictures, int columns, int gap) {
  contract(columns > 0 && gap >= 0, "make_grid: at least one column expected");
  int width = 0, height = 0;
  for (const Image& picture : pictures) {
    width = std::max(width, picture.width());
    height = std::max(height, picture.height());
  }
  const int count = static_cast<int>(pictures.size());
  const int wide = std::min(columns, count), high = (count + columns - 1) / columns;
  Image sheet(std::max(0, wide * (width + gap) - gap), std::max(0, high * (height + gap) - gap),
              {255, 255, 255});
  for (int i = 0; i < count; ++i)
    blit(sheet, pictures[static_cast<std::size_t>(i)], i % columns * (width + gap),
         i / columns * (height + gap));
  return sheet;
}

Result<Image> contact_sheet(const MotionPicture& picture, std::span<const SheetCell> cells, int columns,
                            int num_threads) {
  contract(columns > 0, "contact_sheet: at least one column expected");
  const auto count = static_cast<std::int64_t>(cells.size());
  const std::int64_t wide = std::min<std::int64_t>(columns, count), high = (count + columns - 1) / columns;
  if (count == 0) return Error{Errc::usage, "contact sheet", "there is no instant to show", ""};
  if (wide * (picture.width() + 2) > kMaxSheetSide || high * (picture.height() + 2) > kMaxSheetSide)
    return Error{Errc::usage, "contact sheet",
                 "would be larger than " + std::to_string(kMaxSheetSide) + " pixels on a side",
                 "Choose fewer instants or a smaller picture"};
  std::vector<Image> pictures(cells.size());
  parallel_for(num_threads, count, [&](std::int64_t i) {
    const SheetCell& cell = cells[static_cast<std::size_t>(i)];
    Image& image = pictures[static_cast<std::size_t>(i)];
    image = picture.at(cell.seconds);
    const std::string label = cell.label.empty() ? fixed(cell.seconds, 2) + " s" : cell.label;
    const std::string text = fit_text(label, image.width() - 12);
    draw_text(image, image.width() - 6 - text_width(text), 4, text);
  });
  return make_grid(pictures, columns);
}

}  // namespace mien

#include "mien/io/motion_writer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

#include "even_motion.h"
#include "frame_text.h"
#include "mien/base/file.h"
#include "mien/core/flame_parameters.h"
#include "mien/io/npy.h"

namespace mien {
namespace {

constexpr std::size_t kBlock = 1 << 20;  // of text for the disk

enum class Form { none, live_link, metahuman, coefficients, json, npy };

Form form_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (path.filename().string().ends_with(".metahuman.csv")) return Form::metahuman;
  if (path.filename().string().ends_with(".said.csv")) return Form::coefficients;
  return extension == ".csv"    ? Form::live_link
         : extension == ".json" ? Form::json
         : extension == ".npy"  ? Form::npy
                                : Form::none;
}

Result<std::unique_ptr<io::FrameText>> text_of(Form form, const Motion& format, std::string_view audio_name) {
  switch (form) {
    case Form::live_link:
      return format.space == MotionSpace::flame ? io::flame_text(format) : io::live_link_text(format);
    case Form::metahuman:
      return io::metahuman_text(format);
    case Form::coefficients:
      return io::coefficient_text(format);
    case Form::json:
      return io::motion_json_text(format, audio_name);
    default:
      return std::unique_ptr<io::FrameText>();
  }
}

// The same number of bytes for any number of frames. FLAME parameters as ProbTalk3D's programs write them.
Bytes array_header(std::int64_t num_frames, const Motion& format) {
  if (format.space == MotionSpace::flame)
    return npy_header(std::array<std::int64_t, 3>{1, num_frames, kNumFlame}, sizeof(double), /*growing=*/1);
  return npy_header(std::array<std::int64_t, 2>{num_frames, format.num_channels()});
}

// All of FLAME's parameters in double; those that the motion lacks are 0.
Status write_flame_rows(AtomicFile& file, const std::vector<std::optional<std::size_t>>& columns,
                        std::span<const float> frames) {
  const std::size_t width = columns.size();
  for (std::size_t first = 0; first < frames.size(); first += width) {
    std::array<double, kNumFlame> row{};
    for (std::size_t c = 0; c < width; ++c)
      if (columns[c]) row[*columns[c]] = static_cast<double>(frames[first + c]);
    MIEN_TRY([[maybe_unused]] const auto written, file.write(std::as_bytes(std::span(row))));
  }
  return Done{};
}

}  // namespace

struct MotionWriter::State {
  Motion format;
  std::unique_ptr<io::FrameText> text;  // none: .npy
  AtomicFile file;
  std::vector<std::optional<std::size_t>> flame_columns{};
  std::string block{};
  std::int64_t num_frames = 0;

  [[nodiscard]] std::string_view name() const { return text ? text->name() : ".npy file"; }
  Status flush() {
    Status written = file.write(as_bytes(block));
    block.clear();
    return written;
  }
};

MotionWriter::MotionWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
MotionWriter::MotionWriter(MotionWriter&&) noexcept = default;
MotionWriter& MotionWriter::operator=(MotionWriter&&) noexcept = default;
MotionWriter::~MotionWriter() = default;

bool MotionWriter::can_write(const std::filesystem::path& path) { return form_of(path) != Form::none; }

Result<MotionWriter> MotionWriter::create(const std::filesystem::path& path, const Motion& format,
                                          std::string_view audio_name) {
  contract(can_write(path), "MotionWriter: another format, see can_write()");
  Motion without_frames{format.space, format.channels, format.fps, {}, format.topology};
  MIEN_TRY(auto text, text_of(form_of(path), without_frames, audio_name));
  const std::string_view name = text ? text->name() : ".npy file";
  MIEN_TRY([[maybe_unused]] const auto checked, io::check_motion(without_frames, name));
  MIEN_TRY(auto file, AtomicFile::create(path));
  auto state = std::make_unique<State>(State{std::move(without_frames), std::move(text), std::move(file)});
  if (state->format.space == MotionSpace::flame) state->flame_columns = flame_columns(state->format);
  if (state->text) {
    state->block = state->text->head();
  } else {
    MIEN_TRY([[maybe_unused]] const auto header, state->file.write(array_header(0, state->format)));
  }
  return MotionWriter(std::move(state));
}

Status MotionWriter::add(std::span<const float> frames) {
  State& s = *state_;
  const auto width = static_cast<std::size_t>(s.format.num_channels());
  MIEN_TRY([[maybe_unused]] const auto checked, io::check_frames(s.format, s.num_frames, frames, s.name()));
  if (width == 0) return Done{};
  const auto count = static_cast<std::int64_t>(frames.size() / width);
  if (!s.text) {
    s.num_frames += count;
    if (s.format.space == MotionSpace::flame) return write_flame_rows(s.file, s.flame_columns, frames);
    return s.file.write(std::as_bytes(frames));
  }
  for (std::int64_t i = 0; i < count; ++i, ++s.num_frames) {
    s.text->append(s.block, s.num_frames, frames.subspan(static_cast<std::size_t>(i) * width, width));
    if (s.block.size() < kBlock) continue;
    MIEN_TRY([[maybe_unused]] const auto written, s.flush());
  }
  return Done{};
}

Status MotionWriter::finish() {
  State& s = *state_;
  if (s.text) {
    s.block += s.text->tail();
    MIEN_TRY([[maybe_unused]] const auto written, s.flush());
  } else {
    MIEN_TRY([[maybe_unused]] const auto header, s.file.write_at(0, array_header(s.num_frames, s.format)));
  }
  Status status = s.file.commit();
  if (status && s.text) status.warnings = s.text->warnings();
  return status;
}

}  // namespace mien

#include "tiny_data.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "mien/datasets/prepared_files.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/datasets/templates.h"
#include "mien/io/npy.h"
#include "mien/io/vl.h"

namespace mien::tiny {

namespace fs = std::filesystem;

void write_sound(const fs::path& path, double seconds) {
  AudioClip clip;
  for (int i = 0; i < static_cast<int>(seconds * clip.sample_rate_hz); ++i)
    clip.samples.push_back(static_cast<float>(0.1 * std::sin(0.1 * i)));
  fs::create_directories(path.parent_path());
  const fs::path work = path.parent_path() / "tiny_sound";
  fs::create_directories(work / "wav");
  ASSERT_TRUE(datasets::write_sound(work, "sound", clip));
  fs::rename(work / "wav" / "sound.wav", path);
  fs::remove_all(work);
}

void write_ramp(const fs::path& path, std::int64_t num_frames, std::int64_t width, bool is_batch) {
  NpyArray array{{num_frames, width}, {}};
  if (is_batch) array.shape.insert(array.shape.begin(), 1);
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::int64_t c = 0; c < width; ++c)
      array.values.push_back(static_cast<float>(n) + static_cast<float>(c) / 1000);
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, std::span<const std::byte>(write_npy(array))));
}

void write_prepared(DatasetKind kind, const fs::path& folder, const std::vector<std::string>& names,
                    std::int64_t num_vertices) {
  const DatasetLayout& layout = dataset_layout(kind);
  const std::int64_t width = layout.space == MotionSpace::vertices ? 3 * num_vertices : layout.width;
  Templates templates;
  for (const auto& name : names) {
    write_sound(folder / "wav" / (name + ".wav"), 1);
    write_ramp(folder / layout.motion_folder / (name + ".npy"),
               static_cast<std::int64_t>(layout.fps) * layout.keep_every, width,
               layout.space == MotionSpace::flame);
    if (const auto parts = parse_sequence_name(kind, name))
      templates[parts->subject] = std::vector<float>(static_cast<std::size_t>(width), 0.5f);
  }
  if (layout.has_templates && !templates.empty()) {
    ASSERT_TRUE(write_templates(folder / "templates.safetensors", templates));
  }
}

void write_vl_frames(const fs::path& folder, int num_frames) {
  fs::create_directories(folder);
  for (int n = 1; n <= num_frames; ++n) {
    const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {0, static_cast<float>(n), 4}};
    const std::string number = std::to_string(n);
    ASSERT_TRUE(write_file(
        folder / ("frame_" + std::string(3 - std::min<std::size_t>(3, number.size()), '0') + number + ".vl"),
        std::span<const std::byte>(write_vl(points))));
  }
}

void write_beat_json(const fs::path& path, int num_frames, int width) {
  std::string text = "{\"names\": [], \"frames\": [";
  for (int n = 0; n < num_frames; ++n) {
    text += n == 0 ? "{\"weights\": [" : ",{\"weights\": [";
    for (int c = 0; c < width; ++c) text += (c == 0 ? "" : ",") + fixed(n / 1000.0, 3);
    text += "], \"time\": " + fixed(n / 60.0, 4) + "}";
  }
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, std::string_view(text + "]}")));
}

}  // namespace mien::tiny

#include "small_mead.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/file.h"
#include "mien/core/flame_parameters.h"
#include "mien/datasets/templates.h"
#include "mien/io/npy.h"
#include "small_encoder.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr int kNumFrames = 12, kNumSamples = 8000;

void write_motion(const fs::path& folder, const std::vector<std::string>& names, const char* motion_folder,
                  const std::vector<std::int64_t>& shape) {
  fs::create_directories(folder / motion_folder);
  for (std::size_t i = 0; i < names.size(); ++i) {
    write_wav(folder / "wav" / (names[i] + ".wav"), kNumSamples);
    NpyArray array{shape, {}};
    const std::int64_t width = shape.back();
    for (std::int64_t n = 0; n < kNumFrames; ++n)
      for (std::int64_t c = 0; c < width; ++c)
        array.values.push_back(static_cast<float>(
            0.3 * std::sin(0.4 * static_cast<double>(n) + static_cast<double>(c) + static_cast<double>(i))));
    ASSERT_TRUE(write_file(folder / motion_folder / (names[i] + ".npy"),
                           std::span<const std::byte>(write_npy(array))));
  }
}

}  // namespace

void write_mead_parameters(const fs::path& folder, const std::vector<std::string>& names) {
  write_motion(folder, names, "param", {1, kNumFrames, static_cast<std::int64_t>(kNumFlame)});
}

void write_mead_meshes(const fs::path& folder, const std::vector<std::string>& names) {
  constexpr std::int64_t kWidth = 12;
  write_motion(folder, names, "vertices_npy", {kNumFrames, kWidth});
  Templates templates;
  for (const auto& name : names) templates[name.substr(0, name.find('_'))].assign(kWidth, 0.1f);
  ASSERT_TRUE(write_templates(folder / "templates.safetensors", templates));
}

}  // namespace mien

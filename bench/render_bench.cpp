// Pictures and films of the default head, 512 x 512. Films go to the folder for temporary files.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "mien/face/default_head.h"
#include "mien/render/motion_picture.h"
#include "mien/render/video.h"

namespace mien {
namespace {

constexpr int kSide = 512;

const Character& head() {
  static const Character character = default_head();
  return character;
}

// Two seconds of a mouth that opens and closes while the head turns.
const Motion& talk() {
  static const Motion motion = [] {
    Motion m{
        MotionSpace::arkit, {"jawOpen", "mouthFunnel", "eyeBlinkLeft", "eyeBlinkRight", "headYaw"}, 60, {}};
    for (int n = 0; n < 120; ++n) {
      const double t = n / 60.0;
      for (const double v : {0.3 - 0.3 * std::cos(25 * t), 0.2 + 0.2 * std::sin(9 * t),
                             n % 60 < 9 ? 0.8 : 0.0, n % 60 < 9 ? 0.8 : 0.0, 10 * std::sin(2 * t)})
        m.values.push_back(static_cast<float>(v));
    }
    return m;
  }();
  return motion;
}

MotionPicture picture(int supersampling) {
  MotionPictureOptions options;
  options.shading.width = options.shading.height = kSide;
  options.shading.supersampling = supersampling;
  return MotionPicture::create(head(), {&talk()}, options).value();
}

void draw(benchmark::State& state) {
  const MotionPicture film = picture(static_cast<int>(state.range(0)));
  int n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(film.at(n++ % 60 / 30.0));
}
BENCHMARK(draw)->Name("render/picture/supersampling")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

void encode(benchmark::State& state, const char* extension) {
  std::vector<Image> frames;
  for (int n = 0; n < 30; ++n) frames.push_back(picture(1).at(n / 30.0));
  const auto path = std::filesystem::temp_directory_path() / (std::string("mien_bench") + extension);
  VideoOptions options;
  options.width = options.height = kSide;
  std::int64_t count = 0;
  for (auto _ : state) {
    auto writer = VideoWriter::create(path, options);
    if (!writer) {
      state.SkipWithError(writer.error().message().c_str());
      return;
    }
    for (const Image& frame : frames) benchmark::DoNotOptimize(writer->add_frame(frame).has_value());
    benchmark::DoNotOptimize(writer->finish().has_value());
    count += static_cast<std::int64_t>(frames.size());
  }
  std::filesystem::remove(path);
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(encode, mp4, ".mp4")->Name("render/encode/mp4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(encode, webm, ".webm")->Name("render/encode/webm")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mien

// consumer SPEECH MODEL OUTPUT: the library in ten lines.
#include <cstdio>

#include "mien/audio/load_audio.h"
#include "mien/io/motion_file.h"
#include "mien/models/animate.h"

namespace {

mien::Status animate_file(const char* speech, const char* model_path, const char* output) {
  MIEN_TRY(const auto model, mien::DefaultModel::load(model_path));
  MIEN_TRY(const auto clip, mien::load_audio(speech));
  mien::PerformOptions options;
  options.seed = 7;
  mien::Progress progress;
  MIEN_TRY(const auto motion, mien::animate(model, clip, options, progress));
  return mien::write_motion(output, motion);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto done = animate_file(argv[1], argv[2], argv[3]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 1;
}

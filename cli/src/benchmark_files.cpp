#include "benchmark_files.h"

#include <memory>

#include "mien/audio/load_audio.h"
#include "mien/datasets/prepared_files.h"
#include "mien/io/motion_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

std::string sentence(int number) {
  return std::string("sentence") + (number < 10 ? "0" : "") + std::to_string(number);
}

}  // namespace

Result<std::function<Status(const SyntheticPerformances&)>> benchmark_files(const fs::path& folder) {
  for (const char* name : {"truth", "takes", "wav"}) {
    const fs::path place = folder / name;
    std::error_code ec;
    if (fs::exists(place, ec))
      return Error{Errc::usage, "--keep '" + folder.string() + "'",
                   "has a folder '" + std::string(name) + "' already, of another evaluation",
                   "Name a new folder"};
    fs::create_directories(place, ec);
    if (ec) return Error{Errc::failed, "'" + place.string() + "'", "cannot be made: " + ec.message(), ""};
  }
  return std::function<Status(const SyntheticPerformances&)>(
      [folder, count = std::make_shared<int>(0)](const SyntheticPerformances& item) -> Status {
        const std::string name = sentence(++*count);
        MIEN_TRY(const AudioClip clip, load_audio(item.audio));
        MIEN_TRY([[maybe_unused]] const auto heard, datasets::write_sound(folder, name, clip));
        MIEN_TRY([[maybe_unused]] const auto seen,
                 write_motion(folder / "truth" / (name + ".csv"), item.truth));
        int take = 0;
        for (const Motion& motion : item.generated) {
          const fs::path path = folder / "takes" / (name + "-" + std::to_string(++take) + ".csv");
          MIEN_TRY([[maybe_unused]] const auto written, write_motion(path, motion));
        }
        return Done{};
      });
}

}  // namespace mien

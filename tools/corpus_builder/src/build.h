#pragma once
#include <filesystem>
#include <optional>

#include "augment.h"
#include "build_plan.h"
#include "mien/base/progress.h"

namespace mien {

/// How much of a corpus is stored; the rest is drawn again from the phones by CorpusReader.
enum class Store {
  items,   ///< index, phones and accents
  audio,   ///< and the sound
  curves,  ///< and the performances
};

struct BuildOptions {
  BuildPlanOptions plan;
  Store store = Store::audio;
  int takes = 4;                        ///< stored performances, besides the mean of 64 others
  double limit_seconds = 0;             ///< stop before the clips together get longer; 0 = no limit
  bool flac = false;                    ///< sound as FLAC instead of WAV
  std::optional<double> reverb_rt60_s;  ///< worsen all clips by reverberation
  std::optional<double> noise_snr_db;   ///< and by white noise
  int jobs = 1;
};

struct BuildSummary {
  std::int64_t clips = 0, skipped = 0;
  double seconds = 0;
};

/// Writes a corpus folder (docs/corpus.md) that CorpusReader opens. It is made under a temporary name beside
/// `folder` and appears when complete. Clips have 16-bit sound at an active RMS of 0.06. Errors: those of
/// plan_build(); Errc::usage: the folder exists; Errc::failed: the disk.
Result<BuildSummary> build_corpus(const std::filesystem::path& folder, const BuildOptions& options,
                                  Progress& progress);

}  // namespace mien

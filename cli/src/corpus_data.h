#pragma once
#include "mien/base/progress.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/datasets/prepare.h"

namespace mien {

/// Writes a corpus with sound as a data set of the layout `beat`: the first take of every item, 51
/// coefficients at 30 frames a second, named <speaker>_<emotion as BEAT numbers it>_<running index>. `out` is
/// made when missing; files of the same names are replaced. Warnings: items whose sound is shorter than a
/// frame. Errors: those of CorpusReader; of sound that cannot be read (Errc::input); Errc::cancelled.
Result<PrepareReport> prepare_corpus(const std::filesystem::path& folder, const std::filesystem::path& out,
                                     Progress& progress);

}  // namespace mien

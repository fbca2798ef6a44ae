#pragma once
#include <filesystem>
#include <string_view>

#include "mien/metrics/synthetic_benchmark.h"

namespace mien {

/// Whether a model's name stands for one of the two systems below, which know the truth of a corpus.
bool is_corpus_reference(std::string_view name);

/// "truth": other performances by the generator of the corpus, what a perfect model reaches. "mean": the mean
/// of 32 of them, the same in every take, what a perfect regression reaches. Errors: those of CorpusReader.
/// @pre is_corpus_reference(name)
Result<SyntheticSystem> corpus_reference(std::string_view name, const std::filesystem::path& corpus);

}  // namespace mien

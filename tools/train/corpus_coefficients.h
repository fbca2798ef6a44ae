#pragma once
#include "coefficient_data.h"
#include "config_fields.h"

namespace mien::train {

/// The same of a corpus folder (docs/corpus.md): SAiD's 32 coefficients of its performances, which have 52.
/// @param hears  with the sound of each
/// Errors: those of corpus_data(), Errc::cancelled.
Result<CoefficientData> read_corpus_coefficients(const std::filesystem::path& folder,
                                                 const CorpusFields& corpus, bool hears,
                                                 ConsoleProgress& progress);

}  // namespace mien::train

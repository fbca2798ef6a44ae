#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "encoder_source.h"
#include "mien/motion/diffusion_process.h"
#include "table_reader.h"

// Fields that the configurations of several systems have.
namespace mien::train {

/// [run] encoder, or the table [encoder] with the sizes of a new one. Complains when there is neither, or
/// both.
void read_encoder_choice(TomlFile& file, EncoderChoice& choice);

/// What a configuration says of a corpus folder (docs/corpus.md) as its data.
struct CorpusFields {
  std::filesystem::path validation;  ///< a second corpus folder, all of which validates; empty: none
  std::int64_t num_takes = 1;        ///< performances of each clip that are learnt from
};
/// [run] validation and takes.
void read_corpus_fields(TomlFile& file, CorpusFields& corpus);

/// [model] diffusion_steps and schedule. Complains of a schedule that so few steps cannot have.
void read_diffusion(TomlFile& file, BetaSchedule& schedule, std::int64_t& num_steps);

/// [training] loss: "squared", or `other`, which is the published one.
void read_is_squared(TomlFile& file, bool& is_squared, const std::string& other);

}  // namespace mien::train

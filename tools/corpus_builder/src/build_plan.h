#pragma once
#include <optional>
#include <string>
#include <vector>

#include "mien/base/result.h"
#include "plan.h"

namespace mien {

/// Parts of the corpus (spec section 11).
enum class CorpusSplit {
  train,          ///< sentences and voices of training
  valid,          ///< unseen sentences, seen voices
  test_sentence,  ///< test sentences, seen voices
  test_voice,     ///< test sentences; espeak's held-out variants and flite slt
  test_engine,    ///< test sentences; festival ked and slt_hts
};
/// "train", "valid", "test-sentence", "test-voice", "test-engine".
std::string split_name(CorpusSplit split);
std::optional<CorpusSplit> parse_split(const std::string& name);
std::vector<std::string> split_names();

struct BuildPlanOptions {
  CorpusSplit split = CorpusSplit::test_sentence;
  int clips = 40;
  double clip_seconds = 0;               ///< sentences are joined until a clip is this long; 0 = one sentence
  double emotional_share = 0.5;          ///< of the clips
  std::vector<std::string> voices = {};  ///< only these: "espeak", "flite:slt" ...; empty = all of the split
  bool training_styles = false;          ///< speakers S00 ... S11 in test_voice too
  std::uint64_t seed = 1;
};

/// A clip before it is spoken, with what the index of a corpus tells about it.
struct BuildItem {
  ItemPlan plan;
  std::string speaker;  ///< S00 ... S11; S12 ... S15 in test_voice
  std::string language;
};

/// Errors (Errc::usage): a voice filter that fits no voice of the split; (Errc::failed): all its engines are
/// absent.
Result<std::vector<BuildItem>> plan_build(const BuildPlanOptions& options);

}  // namespace mien

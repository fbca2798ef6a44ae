#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "animate_clip.h"
#include "animate_plan.h"
#include "mien/corpus/corpus_files.h"
#include "mien/models/model_file.h"

namespace mien {

/// A model of any kind as a benchmark asks it to perform: motions of arkit_and_head_channels() at 60 frames a
/// second, as long as the sound. What a model does not move rests; a slower one is interpolated.
class BenchmarkPerformer {
 public:
  /// The model and the words of how it performs. Errors: those of plan_performer() and load_performer();
  /// a model of vertices or FLAME parameters (Errc::incompatible).
  static Result<BenchmarkPerformer> load(const AnimateArguments& arguments);

  /// One performance per seed. Errors: those of animate().
  [[nodiscard]] Result<std::vector<Motion>> perform(const AudioClip& clip,
                                                    std::span<const std::uint64_t> seeds) const;
  /// In the style, emotion and level of an item of a corpus, as far as the model knows them.
  [[nodiscard]] Result<std::vector<Motion>> perform(const CorpusItem& item, const AudioClip& clip,
                                                    std::span<const std::uint64_t> seeds) const;

 private:
  BenchmarkPerformer(AnimateArguments arguments, AnimatePlan plan, ModelFile model, Performer performer)
      : arguments_(std::move(arguments)),
        plan_(std::move(plan)),
        model_(std::move(model)),
        performer_(std::make_unique<Performer>(std::move(performer))) {}
  [[nodiscard]] Result<AnimatePlan> directed(const CorpusItem& item) const;
  [[nodiscard]] Result<std::vector<Motion>> perform(const AnimatePlan& plan, const AudioClip& clip,
                                                    std::span<const std::uint64_t> seeds) const;

  AnimateArguments arguments_;
  AnimatePlan plan_;
  ModelFile model_;
  std::unique_ptr<Performer> performer_;
};

}  // namespace mien

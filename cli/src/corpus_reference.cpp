#include "corpus_reference.h"

#include <memory>

#include "mien/base/contract.h"
#include "mien/corpus/corpus_reader.h"
#include "mien/corpus/take.h"

namespace mien {
namespace {

constexpr std::string_view kTruth = "truth", kMean = "mean";

}  // namespace

bool is_corpus_reference(std::string_view name) { return name == kTruth || name == kMean; }

Result<SyntheticSystem> corpus_reference(std::string_view name, const std::filesystem::path& folder) {
  contract(is_corpus_reference(name), "corpus_reference: no such reference");
  MIEN_TRY(CorpusReader opened, CorpusReader::open(folder));
  const auto corpus = std::make_shared<const CorpusReader>(std::move(opened));
  return SyntheticSystem(
      [corpus, is_mean = name == kMean](const SyntheticRequest& request) -> Result<std::vector<Motion>> {
        const CorpusItem& item = request.item;
        const Speaker* speaker = find_speaker(item.speaker);
        if (speaker == nullptr)
          return Error{Errc::incompatible, "speaker '" + item.speaker + "'", "is none of S00 ... S15", ""};
        MIEN_TRY(const Utterance said, corpus->utterance(item));
        constexpr int kMany = 32;
        if (is_mean)
          return std::vector<Motion>(request.take_seeds.size(),
                                     mean_performance(said, *speaker, item.emotion, item.intensity(),
                                                      request.take_seeds.front(), kMany));
        std::vector<Motion> takes;
        for (const std::uint64_t seed : request.take_seeds)
          takes.push_back(draw_take(said, *speaker, item.emotion, item.intensity(), seed).motion);
        return takes;
      });
}

}  // namespace mien

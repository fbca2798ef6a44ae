#include "probtalk3d_description.h"

#include <array>
#include <optional>

#include "mien/models/probtalk3d/conventions.h"
#include "system_subjects.h"
#include "training_options.h"

namespace mien {
namespace {

constexpr double kFps = 25;  // of 3DMEAD

std::string file_of(const ImportOptions& options) { return "'" + options.sources[0].string() + "'"; }

// Columns of identities, emotions and intensities, where the checkpoint says them.
std::optional<std::array<std::int64_t, 3>> saved_counts(const WeightsSource& weights,
                                                        std::int64_t num_styles) {
  const auto saved = weights.training_options();
  const auto counts = saved ? find_option_list(*saved, "one_hot_dim") : std::nullopt;
  if (!counts || counts->size() != 3) return std::nullopt;
  std::int64_t sum = 0;
  for (const std::int64_t count : *counts) {
    if (count < 1 || count > num_styles) return std::nullopt;
    sum += count;
  }
  if (sum != num_styles) return std::nullopt;
  return std::array{(*counts)[0], (*counts)[1], (*counts)[2]};
}

// The published names when there are as many, else numbers.
std::vector<std::string> names_for(std::vector<std::string> published, std::int64_t count) {
  if (static_cast<std::int64_t>(published.size()) == count) return published;
  std::vector<std::string> numbers;
  for (std::int64_t i = 0; i < count; ++i) numbers.push_back(std::to_string(i));
  return numbers;
}

}  // namespace

bool is_probtalk3d(Architecture architecture) {
  return architecture == Architecture::probtalk3d || architecture == Architecture::probtalk3d_prior;
}

Result<std::int64_t> probtalk3d_heads(const ImportOptions& options, const WeightsSource& weights,
                                      Architecture architecture) {
  if (!is_probtalk3d(architecture)) {
    if (options.heads) return Error{Errc::usage, "--heads", "does not apply: it is for ProbTalk3D", ""};
    return std::int64_t{0};
  }
  if (options.heads) return *options.heads;
  if (const auto saved = weights.training_options())
    if (const auto heads = find_option(*saved, "num_heads")) return *heads;
  Result<std::int64_t> published(probtalk3d::kNumHeads);
  published.warnings.push_back("the weights do not say how many attention heads they have: " +
                               std::to_string(probtalk3d::kNumHeads) + " are assumed (--heads)");
  return published;
}

Status name_style_columns(const ImportOptions& options, const WeightsSource& weights, std::int64_t num_styles,
                          ModelFile& m) {
  const auto emotions = probtalk3d::published_emotions();
  const auto intensities = probtalk3d::published_intensities();
  const auto num_emotions = static_cast<std::int64_t>(emotions.size());
  const auto num_intensities = static_cast<std::int64_t>(intensities.size());
  std::array counts{num_styles - num_emotions - num_intensities, num_emotions, num_intensities};
  if (const auto saved = saved_counts(weights, num_styles)) counts = *saved;
  if (counts[0] < 1)
    return Error{Errc::incompatible, file_of(options),
                 "has a style of " + std::to_string(num_styles) +
                     " columns, too few for an identity, 8 emotions and 3 intensities",
                 ""};
  m.emotions = names_for(emotions, counts[1]);
  m.intensities = names_for(intensities, counts[2]);
  auto subjects = subject_names(options.subjects, counts[0], m.architecture, m.output.topology);
  if (!subjects) return subjects.error();
  m.subjects = std::move(*subjects);
  Status named{Done{}};
  named.warnings = std::move(subjects.warnings);
  return named;
}

Status describe_probtalk3d(const ImportOptions& options, const SystemFacts& facts,
                           const WeightsSource& weights, ModelFile& m) {
  if (options.steps) return Error{Errc::usage, "--steps", "does not apply: ProbTalk3D has no diffusion", ""};
  if (options.fps && *options.fps != kFps)
    return Error{Errc::usage, "--fps", "must be 25: ProbTalk3D hears two speech features a frame", ""};
  m.output = {.space = "flame", .channels = facts.channels, .fps = kFps, .topology = "flame"};
  m.scaler = probtalk3d::published_scaler(facts.channels);
  if (m.architecture == Architecture::probtalk3d_prior) {
    if (!options.subjects.empty())
      return Error{Errc::usage, "--subjects", "does not apply: a motion prior has no styles", ""};
    return Done{};
  }
  if (facts.condition != 2 * m.encoder->hidden_size)
    return Error{Errc::incompatible, file_of(options),
                 "takes " + std::to_string(facts.condition) + " speech features a frame, the encoder gives " +
                     std::to_string(2 * m.encoder->hidden_size),
                 "Check the encoder's configuration"};
  return name_style_columns(options, weights, facts.num_styles, m);
}

}  // namespace mien

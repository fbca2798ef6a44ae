#include "mien/models/probtalk3d/network.h"

namespace mien::probtalk3d {
namespace {

using Shapes = std::map<std::string, Shape>;

// Axis `axis` of a stored tensor of a given rank; 0 when there is none such.
std::int64_t size_of(const Shapes& shapes, const std::string& name, std::size_t rank, std::size_t axis) {
  const auto stored = shapes.find(name);
  return stored != shapes.end() && stored->second.size() == rank ? stored->second[axis] : 0;
}

// Blocks of a stack: each has an attention (even numbers) and a feed-forward part.
std::int64_t count_blocks(const Shapes& shapes, const std::string& transformer) {
  std::int64_t count = 0;
  while (shapes.contains(transformer + std::to_string(2 * count) + ".fn.fn.to_qkv.weight")) ++count;
  return count;
}

}  // namespace

Result<Sizes> sizes_of(const Shapes& shapes, std::int64_t heads) {
  const bool has_predictor = shapes.contains("feature_predictor.audio_feature_map.weight");
  const std::string prior = has_predictor ? std::string(kPriorPrefix) : "";
  const std::string predictor(kPredictorPrefix);
  Sizes s;
  s.heads = heads;
  s.channels = size_of(shapes, prior + "motion_decoder.feature_mapping_reverse.weight", 2, 0);
  s.width = size_of(shapes, prior + "motion_decoder.feature_mapping_reverse.weight", 2, 1);
  s.inner = size_of(shapes, prior + "motion_decoder.decoder_transformer.net.1.fn.fn.l1.weight", 2, 0);
  s.prior_blocks = count_blocks(shapes, prior + "motion_decoder.decoder_transformer.net.");
  s.num_codes = size_of(shapes, prior + "quantize.embedding.weight", 2, 0);
  s.code_width = size_of(shapes, prior + "quantize.embedding.weight", 2, 1);
  if (has_predictor) {
    s.condition = size_of(shapes, predictor + "audio_feature_map.weight", 2, 1);
    s.style = size_of(shapes, predictor + "style_embedding.weight", 2, 1);
    s.predictor_blocks = count_blocks(shapes, predictor + "encoder_transformer.net.");
  }
  const bool has_latent = (s.num_codes > 0 && s.code_width > 0) || shapes.contains(prior + "mean.weight");
  if (s.channels <= 0 || s.width <= 0 || s.inner <= 0 || s.prior_blocks <= 0 || !has_latent ||
      (has_predictor && (s.condition <= 0 || s.style <= 0 || s.predictor_blocks <= 0)))
    return Error{
        Errc::incompatible, "weights", "are not those of ProbTalk3D",
        "Expected are motion_encoder, motion_decoder and quantize (or mean and logvar), in stage 2 behind "
        "motion_prior and with feature_predictor"};
  if (heads < 1 || s.width % heads != 0)
    return Error{
        Errc::incompatible, "weights",
        std::to_string(heads) + " attention heads do not divide the width " + std::to_string(s.width),
        "Say how many heads they were trained with: --heads N"};
  return s;
}

}  // namespace mien::probtalk3d

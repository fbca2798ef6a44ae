#include "system_weights.h"

#include <algorithm>
#include <set>

#include "mien/models/facediffuser/network.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/models/said/network.h"
#include "mien/models/said/vae.h"
#include "mien/nn/runtime_operations.h"

namespace mien {
namespace {

using Shapes = std::map<std::string, Shape>;

Shapes shapes_of(const std::vector<ImportedTensor>& tensors) {
  Shapes shapes;
  for (const auto& tensor : tensors) shapes.emplace(tensor.name, tensor.shape);
  return shapes;
}

std::optional<Architecture> recognise(const Shapes& shapes) {
  const auto has = [&](const char* name) { return shapes.contains(name); };
  if (has("motion_prior.motion_decoder.feature_mapping_reverse.weight")) return Architecture::probtalk3d;
  if (has("motion_decoder.feature_mapping_reverse.weight")) return Architecture::probtalk3d_prior;
  if (has("gru.weight_ih_l0") && has("emo_vector.weight") && has("obj_vector.weight") && has("fc.weight"))
    return Architecture::facexhubert;
  if (has("gru.weight_ih_l0") && has("input_projection.0.weight") && has("final_layer.weight")) {
    const auto sizes = facediffuser::sizes_of(shapes);
    return sizes && sizes->styles_speech ? Architecture::facediffuser_emotion : Architecture::facediffuser_v;
  }
  if (has("gru.weight_ih_l0") && has("norm_cond.weight") && has("final_layer.weight"))
    return Architecture::facediffuser_beat;
  if (has("rnn.weight_ih_l0") && has("out.weight") && has("embed_timestep.time_embed.0.weight"))
    return Architecture::facediffuser_damm;
  if (has("encoder.conv_layers.0.weight") && has("encoder.fc_mu.weight")) return Architecture::said_vae;
  if (has("null_cond_emb") && has("denoiser.model.input_blocks.0.0.weight")) return Architecture::said;
  return std::nullopt;
}

// What needs no warning when it is left out: of ProbTalk3D's checkpoints sums of losses, and tables of
// positions, which are computed; a batch norm's counter.
bool is_bookkeeping(const std::string& name) {
  return name.find("_losses.losses_") != std::string::npos || name.ends_with("_pos_embedding.pe") ||
         name.ends_with(".num_batches_tracked");
}

template <class Network>
Result<std::vector<ImportedTensor>> tensors_of(Network network, const FoundSystem& found,
                                               const std::string& file) {
  ListParameters list;
  network.visit(list);
  return matching_tensors(list.entries, found.tensors, found.prefix, file);
}

}  // namespace

Result<FoundSystem> find_system(const WeightsSource& weights, const std::optional<FoundEncoder>& encoder,
                                const std::string& wanted, const std::string& file) {
  FoundSystem found;
  constexpr std::string_view kEncoder = ModelFile::kEncoderPrefix;
  if (encoder && encoder->prefix.ends_with(kEncoder))
    found.prefix = encoder->prefix.substr(0, encoder->prefix.size() - kEncoder.size());
  else if (!weights.tensors().empty() && weights.tensors().front().name.starts_with("module."))
    found.prefix = "module.";
  for (const auto& tensor : weights.tensors()) {
    const bool of_encoder = encoder && tensor.name.starts_with(encoder->prefix) && !encoder->prefix.empty();
    if (!of_encoder && tensor.name.starts_with(found.prefix))
      found.tensors.push_back({tensor.name.substr(found.prefix.size()), tensor.shape, tensor.name});
  }
  const Shapes shapes = shapes_of(found.tensors);
  if (!wanted.empty()) {
    for (const auto architecture :
         {Architecture::speech_encoder, Architecture::facexhubert, Architecture::facediffuser_v,
          Architecture::facediffuser_beat, Architecture::facediffuser_damm,
          Architecture::facediffuser_emotion, Architecture::probtalk3d, Architecture::probtalk3d_prior,
          Architecture::said_vae, Architecture::said})
      if (wanted == architecture_name(architecture)) {
        found.architecture = architecture;
        return found;
      }
    return Error{Errc::usage, "--system", "'" + wanted + "' is not known",
                 "Known: speech_encoder, facexhubert, facediffuser_v, facediffuser_beat, facediffuser_damm, "
                 "facediffuser_emotion, probtalk3d, probtalk3d_prior, said_vae, said"};
  }
  if (const auto architecture = recognise(shapes)) {
    found.architecture = *architecture;
  } else if (!encoder) {
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(weights.tensors().size(), 6); ++i)
      names += (i == 0 ? "'" : ", '") + weights.tensors()[i].name + "'";
    return Error{
        Errc::incompatible, file, "holds no network that Mien knows; its tensors are " + names + " ...",
        "Mien imports HuBERT, wav2vec 2.0, FaceXHuBERT, FaceDiffuser, ProbTalk3D, SAiD and its motion codec "
        "(docs/import.md)"};
  }
  return found;
}

Result<SystemFacts> system_facts(const FoundSystem& found, const std::string& file, std::int64_t heads) {
  const Shapes shapes = shapes_of(found.tensors);
  SystemFacts facts;
  Result<std::vector<ImportedTensor>> tensors = std::vector<ImportedTensor>();
  if (found.architecture == Architecture::facexhubert) {
    const auto sizes = facexhubert::sizes_of(shapes);
    if (!sizes) return within(sizes.error(), file);
    facts.channels = sizes->num_channels;
    facts.num_subjects = sizes->num_subjects;
    facts.condition = sizes->input;
    tensors = tensors_of(facexhubert::Network<Tensor>(*sizes), found, file);
  } else if (found.architecture == Architecture::said_vae) {
    const auto sizes = said::vae_sizes_of(shapes);
    if (!sizes) return within(sizes.error(), file);
    facts.channels = sizes->channels;
    tensors = tensors_of(said::Vae<Tensor>(*sizes), found, file);
  } else if (found.architecture == Architecture::said) {
    const auto sizes = said::sizes_of(shapes);
    if (!sizes) return within(sizes.error(), file);
    facts.channels = sizes->num_channels;
    facts.condition = sizes->speech;
    tensors = tensors_of(said::Network<Tensor>(*sizes), found, file);
  } else if (found.architecture == Architecture::probtalk3d ||
             found.architecture == Architecture::probtalk3d_prior) {
    const auto sizes = probtalk3d::sizes_of(shapes, heads);
    if (!sizes) return within(sizes.error(), file);
    facts.channels = sizes->channels;
    facts.condition = sizes->condition;
    facts.num_styles = sizes->style;
    tensors = found.architecture == Architecture::probtalk3d
                  ? tensors_of(probtalk3d::Network<Tensor>(*sizes), found, file)
                  : tensors_of(probtalk3d::MotionPrior<Tensor>(*sizes), found, file);
  } else {
    using facediffuser::Variant;
    const bool has_emotions = found.architecture == Architecture::facediffuser_emotion;
    const auto sizes = facediffuser::sizes_of(shapes, has_emotions);
    if (!sizes) return within(sizes.error(), file);
    const auto variant = found.architecture == Architecture::facediffuser_v || has_emotions
                             ? Variant::vertices
                         : found.architecture == Architecture::facediffuser_beat ? Variant::beat
                                                                                 : Variant::damm;
    if (sizes->variant != variant)
      return Error{Errc::incompatible, file,
                   "is not " + std::string(architecture_name(found.architecture)) + " but another variant",
                   ""};
    facts.channels = sizes->num_channels;
    (has_emotions ? facts.num_styles : facts.num_subjects) = sizes->num_subjects;
    facts.num_steps = variant == Variant::damm ? 0 : sizes->num_steps;
    facts.condition = sizes->condition;
    if (variant == Variant::vertices)
      tensors = tensors_of(facediffuser::VertexDenoiser<Tensor>(*sizes), found, file);
    else if (variant == Variant::beat)
      tensors = tensors_of(facediffuser::BeatDenoiser<Tensor>(*sizes), found, file);
    else
      tensors = tensors_of(facediffuser::DammDenoiser<Tensor>(*sizes), found, file);
  }
  if (!tensors) return tensors.error();
  facts.tensors = std::move(*tensors);
  Result<SystemFacts> result(std::move(facts));
  std::set<std::string_view> used;
  for (const auto& tensor : result->tensors) used.insert(tensor.source);
  for (const auto& tensor : found.tensors)
    if (!used.contains(tensor.source) && !is_bookkeeping(tensor.name))
      result.warnings.push_back("left out tensor '" + tensor.source + "'");
  return result;
}

}  // namespace mien

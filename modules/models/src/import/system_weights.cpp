#include "system_weights.h"

#include <algorithm>
#include <set>

#include "mien/models/facediffuser/network.h"
#include "mien/models/facexhubert/network.h"
#include "mien/models/said/network.h"
#include "mien/models/said/vae.h"
#include "mien/nn/runtime_operations.h"

namespace mien {
namespace {

// The width of the style that ProbTalk3D's emotional variant of FaceDiffuser takes: 32 subjects, 8 emotions,
// 3 intensities. Its tensors have the names of FaceDiffuser's own.
constexpr std::int64_t kEmotionalStyle = 43;

using Shapes = std::map<std::string, Shape>;

Shapes shapes_of(const std::vector<ImportedTensor>& tensors) {
  Shapes shapes;
  for (const auto& tensor : tensors) shapes.emplace(tensor.name, tensor.shape);
  return shapes;
}

std::optional<Architecture> recognise(const Shapes& shapes) {
  const auto has = [&](const char* name) { return shapes.contains(name); };
  if (has("gru.weight_ih_l0") && has("emo_vector.weight") && has("obj_vector.weight") && has("fc.weight"))
    return Architecture::facexhubert;
  if (has("gru.weight_ih_l0") && has("input_projection.0.weight") && has("final_layer.weight"))
    return Architecture::facediffuser_v;
  if (has("gru.weight_ih_l0") && has("norm_cond.weight") && has("final_layer.weight"))
    return Architecture::facediffuser_beat;
  if (has("rnn.weight_ih_l0") && has("out.weight") && has("embed_timestep.time_embed.0.weight"))
    return Architecture::facediffuser_damm;
  if (has("encoder.conv_layers.0.weight") && has("encoder.fc_mu.weight")) return Architecture::said_vae;
  if (has("null_cond_emb") && has("denoiser.model.input_blocks.0.0.weight")) return Architecture::said;
  return std::nullopt;
}

// Systems whose tensors are known but which are not imported.
std::optional<std::string> other_system(const Shapes& shapes) {
  const auto any = [&](std::string_view start) {
    return std::ranges::any_of(shapes, [&](const auto& entry) { return entry.first.starts_with(start); });
  };
  if (any("motion_prior.")) return "ProbTalk3D";
  const auto style = shapes.find("obj_vector.weight");
  if (style != shapes.end() && style->second.size() == 2 && style->second[1] == kEmotionalStyle &&
      !shapes.contains("emo_vector.weight"))
    return "the emotional FaceDiffuser of ProbTalk3D";
  return std::nullopt;
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
          Architecture::facediffuser_beat, Architecture::facediffuser_damm, Architecture::said_vae,
          Architecture::said})
      if (wanted == architecture_name(architecture)) {
        found.architecture = architecture;
        return found;
      }
    return Error{Errc::usage, "--system", "'" + wanted + "' is not known",
                 "Known: speech_encoder, facexhubert, facediffuser_v, facediffuser_beat, facediffuser_damm, "
                 "said_vae, said"};
  }
  if (const auto other = other_system(shapes))
    return Error{Errc::incompatible, file, "holds " + *other + ", which this version does not import",
                 encoder ? "Its speech encoder alone: --system speech_encoder" : ""};
  if (const auto architecture = recognise(shapes)) {
    found.architecture = *architecture;
  } else if (!encoder) {
    std::string names;
    for (std::size_t i = 0; i < std::min<std::size_t>(weights.tensors().size(), 6); ++i)
      names += (i == 0 ? "'" : ", '") + weights.tensors()[i].name + "'";
    return Error{Errc::incompatible, file,
                 "holds no network that Mien knows; its tensors are " + names + " ...",
                 "Mien imports HuBERT, wav2vec 2.0, FaceXHuBERT, FaceDiffuser, SAiD and its motion codec "
                 "(docs/import.md)"};
  }
  return found;
}

Result<SystemFacts> system_facts(const FoundSystem& found, const std::string& file) {
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
  } else {
    using facediffuser::Variant;
    const auto sizes = facediffuser::sizes_of(shapes);
    if (!sizes) return within(sizes.error(), file);
    const auto variant = found.architecture == Architecture::facediffuser_v      ? Variant::vertices
                         : found.architecture == Architecture::facediffuser_beat ? Variant::beat
                                                                                 : Variant::damm;
    if (sizes->variant != variant)
      return Error{Errc::incompatible, file,
                   "is not " + std::string(architecture_name(found.architecture)) + " but another variant",
                   ""};
    facts.channels = sizes->num_channels;
    facts.num_subjects = sizes->num_subjects;
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
  for (const auto& tensor : found.tensors)  // a batch norm's counter is no weight: its loss needs no warning
    if (!used.contains(tensor.source) && !tensor.name.ends_with(".num_batches_tracked"))
      result.warnings.push_back("left out tensor '" + tensor.source + "'");
  return result;
}

}  // namespace mien

// Names and shapes of all tensors of the published checkpoints, at full size: what the networks ask for is
// what they hold. Networks are described, never filled: no weight is allocated.
#include <gmock/gmock.h>

#include <fstream>
#include <map>

#include "fixture.h"
#include "import/parameter_list.h"
#include "mien/models/facediffuser/network.h"
#include "mien/models/probtalk3d/network.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien::parity {
namespace {

using Shapes = std::map<std::string, Shape>;

constexpr std::int64_t kPublishedHeads = 8;  // no tensor tells

template <class Network>
void add_parameters(Network network, const std::string& prefix, Shapes& all) {
  ListParameters list;
  network.visit(list);
  for (const auto& entry : list.entries)
    EXPECT_TRUE(all.emplace(prefix + entry.name, entry.shape).second) << entry.name << " comes twice";
}

// What a checkpoint holds besides weights: sums of losses, and tables of positions, which are computed.
bool is_sum_of_losses(const std::string& name) { return name.find("_losses.losses_") != std::string::npos; }
bool is_table(const std::string& name) { return name.ends_with("_pos_embedding.pe"); }

// The prefix of a speech encoder among the names; nothing when there is none.
std::optional<std::string> encoder_prefix(const Shapes& recorded) {
  for (const auto& [name, shape] : recorded)
    if (const auto at = name.find("feature_extractor.conv_layers.0.conv.weight"); at != std::string::npos)
      return name.substr(0, at);
  return std::nullopt;
}

// The tensors that the networks of these sizes have.
Shapes wanted(const Shapes& recorded) {
  Shapes all;
  if (const auto prefix = encoder_prefix(recorded)) {
    Shapes own;
    for (const auto& [name, shape] : recorded)
      if (name.starts_with(*prefix)) own.emplace(name.substr(prefix->size()), shape);
    const auto config = encoder_config_from_shapes(own);
    EXPECT_TRUE(config) << config.error().message();
    if (config) add_parameters(SpeechEncoder<Tensor>(*config), *prefix, all);
  }
  if (recorded.contains("final_layer.weight")) {
    const auto sizes = facediffuser::sizes_of(recorded, true);
    EXPECT_TRUE(sizes) << sizes.error().message();
    if (sizes) add_parameters(facediffuser::VertexDenoiser<Tensor>(*sizes), "", all);
    return all;
  }
  const auto sizes = probtalk3d::sizes_of(recorded, kPublishedHeads);
  EXPECT_TRUE(sizes) << sizes.error().message();
  if (!sizes) return all;
  if (recorded.contains("feature_predictor.audio_feature_map.weight"))
    add_parameters(probtalk3d::Network<Tensor>(*sizes), "", all);
  else
    add_parameters(probtalk3d::MotionPrior<Tensor>(*sizes), "", all);
  return all;
}

TEST(ProbTalk3DShapes, NetworksHaveTheTensorsOfThePublishedFiles) {
  for_each_case("probtalk3d", "", "_tensor_shapes.json", [](const std::string& name) {
    std::ifstream file(fixture_root() / "probtalk3d" / (name + "_tensor_shapes.json"));
    const auto checkpoints = nlohmann::json::parse(file);
    ASSERT_FALSE(checkpoints.empty());
    for (const auto& [checkpoint, tensors] : checkpoints.items()) {
      SCOPED_TRACE(checkpoint);
      Shapes recorded;
      std::vector<Shape> tables;
      for (const auto& [tensor, shape] : tensors.items()) {
        if (is_sum_of_losses(tensor)) continue;
        if (is_table(tensor))
          tables.push_back(shape.get<Shape>());
        else
          recorded.emplace(tensor, shape.get<Shape>());
      }
      EXPECT_GT(recorded.size(), 100u);
      const Shapes ours = wanted(recorded);
      for (const auto& [tensor, shape] : recorded) {
        const auto found = ours.find(tensor);
        ASSERT_NE(found, ours.end()) << "no network asks for " << tensor;
        EXPECT_EQ(found->second, shape) << tensor;
      }
      for (const auto& [tensor, shape] : ours)
        EXPECT_TRUE(recorded.contains(tensor)) << tensor << " is not in the file";
      // Tables of positions are as wide as the codes' latent and longer than any clip that is heard.
      for (const Shape& table : tables) {
        ASSERT_EQ(table.size(), 3u);
        const auto sizes = probtalk3d::sizes_of(recorded, kPublishedHeads);
        ASSERT_TRUE(sizes) << sizes.error().message();
        EXPECT_EQ(table[2], sizes->width);
      }
    }
  });
}

}  // namespace
}  // namespace mien::parity

#pragma once
#include <gtest/gtest.h>

#include <filesystem>

#include "import/parameter_list.h"
#include "mien/base/hash.h"
#include "mien/base/random.h"
#include "mien/models/facediffuser/network.h"
#include "mien/models/model_file.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"

namespace mien {

// Published systems small enough for a test, with random weights.

inline EncoderConfig small_face_encoder() {
  EncoderConfig c;
  c.hidden_size = 16;
  c.num_hidden_layers = 1;
  c.num_attention_heads = 2;
  c.intermediate_size = 24;
  c.conv_dim = std::vector<std::int64_t>(7, 8);
  c.num_conv_pos_embeddings = 8;
  c.num_conv_pos_embedding_groups = 2;
  return c;
}

inline ModelFile face_description(Architecture architecture) {
  ModelFile m;
  m.architecture = architecture;
  m.name = "small";
  m.encoder = small_face_encoder();
  const bool is_mesh =
      architecture == Architecture::facediffuser_v || architecture == Architecture::facexhubert;
  m.output = {.space = is_mesh ? "vertices" : "rig",
              .channels = is_mesh ? 60 : 7,
              .fps = is_mesh ? 25.0 : 30.0,
              .topology = ""};
  if (is_mesh) m.subjects = {"F1", "M2"};
  if (architecture == Architecture::facexhubert)
    m.emotions = {"neutral", "expressive"};
  else
    m.diffusion = ModelDiffusion{"cosine", 12};
  return m;
}

inline facediffuser::Sizes small_mesh_sizes() {
  return {.variant = facediffuser::Variant::vertices,
          .num_channels = 60,
          .latent = 6,
          .hidden = 6,
          .num_steps = 12,
          .condition = 32,
          .num_subjects = 2};
}

/// Random weights for every parameter that the networks name, and a neutral face for M2.
template <class Network>
void write_face_model(const std::filesystem::path& path, const ModelFile& m, Network network) {
  SpeechEncoder<Tensor> encoder(*m.encoder);
  ListParameters list;
  list.scope("audio_encoder", encoder);
  network.visit(list);
  if (m.output.space == "vertices") list.entries.push_back({"template.M2", {m.output.channels}});
  std::vector<StoredTensor> tensors;
  for (const auto& e : list.entries) tensors.push_back({e.name, Dtype::f32, e.shape});
  auto writer = SafetensorsWriter::create(path, tensors, to_metadata(m));
  EXPECT_TRUE(writer) << writer.error().message();
  for (const auto& t : tensors) {
    std::vector<float> values(static_cast<std::size_t>(t.count()));
    NoiseField(hash64(t.name), 0).normal(0, 0, values);
    const bool is_scale = t.name.find("norm") != std::string::npos && t.name.ends_with("weight");
    for (float& v : values) v = (is_scale ? 1.0f : 0.0f) + 0.3f * v;
    EXPECT_TRUE(writer->write_float(t.name, values));
  }
  EXPECT_TRUE(writer->finish());
}

}  // namespace mien

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mien/models/speech_encoder/network.h"
#include "mien/nn/plain_weights.h"

namespace mien {
namespace {

using testing::HasSubstr;

TEST(EncoderConfig, DefaultsAreTheBaseModel) {
  const auto config = encoder_config_from_json("{}");
  ASSERT_TRUE(config) << config.error().message();
  EXPECT_EQ(*config, EncoderConfig{});
  EXPECT_EQ(config->receptive_field(), 400);
  EXPECT_EQ(config->hop(), 320);
  for (const auto& [samples, frames] :
       {std::pair<std::int64_t, std::int64_t>{0, 0}, {399, 0}, {400, 1}, {719, 1}, {720, 2}, {16000, 49}})
    EXPECT_EQ(config->num_frames(samples), frames) << samples;
}

TEST(EncoderConfig, EachWrongFieldIsNamedAlone) {
  const std::pair<const char*, const char*> wrong[] = {{"model_type", R"("wavlm")"},
                                                       {"hidden_size", "0"},
                                                       {"hidden_size", "\"768\""},
                                                       {"hidden_size", "1e300"},
                                                       {"num_hidden_layers", "100000"},
                                                       {"num_attention_heads", "7"},
                                                       {"intermediate_size", "-3"},
                                                       {"feat_extract_norm", R"("batch")"},
                                                       {"hidden_act", R"("relu")"},
                                                       {"feat_extract_activation", R"("silu")"},
                                                       {"conv_dim", "[]"},
                                                       {"conv_dim", "[512, 512, 512, 512, 512, 512, -1]"},
                                                       {"conv_dim", "512"},
                                                       {"conv_kernel", "[10, 3, 3, 3, 3, 2]"},
                                                       {"conv_stride", "[11, 2, 2, 2, 2, 2, 2]"},
                                                       {"conv_bias", "1"},
                                                       {"num_conv_pos_embeddings", "0"},
                                                       {"num_conv_pos_embedding_groups", "5"},
                                                       {"conv_pos_batch_norm", "true"},
                                                       {"add_adapter", "true"},
                                                       {"adapter_attn_dim", "16"},
                                                       {"layer_norm_eps", "-1"},
                                                       {"layerdrop", "1.5"},
                                                       {"mask_time_length", "0"},
                                                       {"mask_time_min_masks", "-1"},
                                                       {"normalise_eps", "2"}};
  for (const auto& [field, value] : wrong) {
    const auto config = encoder_config_from_json(std::string("{\"") + field + "\": " + value + "}");
    ASSERT_FALSE(config) << field << ' ' << value;
    EXPECT_EQ(config.error().code, Errc::incompatible);
    EXPECT_THAT(config.error().what, HasSubstr(field));
  }
  for (const char* text : {"", "[1]", "{\"hidden_size\": ", "\xff"})
    EXPECT_FALSE(encoder_config_from_json(text)) << text;
}

TEST(EncoderConfig, PreprocessorSaysWhetherToNormalise) {
  EncoderConfig config;
  ASSERT_TRUE(read_preprocessor_config(R"({"do_normalize": false, "sampling_rate": 16000})", config));
  EXPECT_FALSE(config.do_normalize);
  EXPECT_FALSE(read_preprocessor_config(R"({"sampling_rate": 8000})", config));
  EXPECT_FALSE(read_preprocessor_config(R"({"feature_size": 2})", config));
  EXPECT_FALSE(read_preprocessor_config("nonsense", config));
}

/// Collects names and shapes, as a file would list them.
class ListShapes : public ParameterVisitor<ListShapes> {
 public:
  template <class M>
  void matrix(std::string_view name, M&, std::int64_t out, std::int64_t in, Init) {
    shapes[full_name(name)] = {out, in};
  }
  template <class M>
  void convolution(std::string_view name, M&, std::int64_t out, std::int64_t in, std::int64_t kernel, Init) {
    shapes[full_name(name)] = {out, in, kernel};
  }
  template <class T>
  void tensor(std::string_view name, T&, const Shape& shape, Init) {
    shapes[full_name(name)] = shape;
  }
  std::map<std::string, Shape> shapes;
};

TEST(EncoderConfig, FollowsFromTheShapesOfTheFamily) {
  EncoderConfig base, large, distilled;
  large.hidden_size = 1024;
  large.num_hidden_layers = 24;
  large.num_attention_heads = 16;
  large.intermediate_size = 4096;
  large.conv_layer_norm = large.conv_bias = large.do_stable_layer_norm = true;
  distilled.num_hidden_layers = 2;
  distilled.feat_proj_layer_norm = false;
  for (const EncoderConfig& want : {base, large, distilled}) {
    SpeechEncoder<PlainWeights> encoder(want);
    ListShapes list;
    encoder.visit(list);
    const auto got = encoder_config_from_shapes(list.shapes);
    ASSERT_TRUE(got) << got.error().message();
    EXPECT_EQ(*got, want);
  }
  EXPECT_FALSE(encoder_config_from_shapes({}));
}

TEST(Waveform, NormalisesToMeanZeroAndVarianceOne) {
  std::vector<float> samples = {1, 2, 3, 6};
  normalise_waveform(samples, 1e-5);
  double sum = 0, squares = 0;
  for (const float x : samples) sum += x, squares += static_cast<double>(x) * x;
  EXPECT_NEAR(sum, 0, 1e-6);
  EXPECT_NEAR(squares / 4, 1, 1e-5);
  std::vector<float> constant(100, 0.25f), none, one = {0.5f};
  for (auto* x : {&constant, &none, &one}) {
    normalise_waveform(*x, 1e-7);
    EXPECT_THAT(*x, testing::Each(0.0f));
  }
}

}  // namespace
}  // namespace mien

#include "mien/models/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mien {
namespace {

using testing::HasSubstr;

ModelFile vertex_model() {
  ModelFile m;
  m.architecture = Architecture::facediffuser_v;
  m.name = "biwi";
  m.output = {.space = "vertices", .channels = 180, .fps = 29.97, .topology = "biwi"};
  m.encoder = EncoderConfig{.hidden_size = 48, .num_attention_heads = 4, .do_normalize = false};
  m.diffusion = ModelDiffusion{"linear", 500};
  m.subjects = {"F2", "M3"};
  m.emotions = {"neutral", "expressive"};
  m.licence = "that of the weights";
  m.source = "a.pth";
  return m;
}

TEST(ModelFile, ComesBackAsItWas) {
  const auto read = read_model_file(to_metadata(vertex_model()));
  ASSERT_TRUE(read) << read.error().message();
  const ModelFile made = vertex_model();
  EXPECT_EQ(read->architecture, made.architecture);
  EXPECT_EQ(read->name, made.name);
  EXPECT_EQ(read->output.space, made.output.space);
  EXPECT_EQ(read->output.channels, made.output.channels);
  EXPECT_EQ(read->output.fps, made.output.fps);
  EXPECT_EQ(read->output.topology, made.output.topology);
  EXPECT_EQ(read->encoder, made.encoder);
  EXPECT_EQ(read->diffusion->schedule, "linear");
  EXPECT_EQ(read->diffusion->steps, 500);
  EXPECT_EQ(read->subjects, made.subjects);
  EXPECT_EQ(read->emotions, made.emotions);
  EXPECT_EQ(read->source, made.source);
  EXPECT_FALSE(read->scaler);

  ModelFile rig = made;
  rig.architecture = Architecture::facediffuser_damm;
  rig.output = {.space = "rig", .channels = 2, .fps = 30, .topology = ""};
  rig.scaler = ModelScaler{{0.1, 1.0 / 3}, {-0.7, 1e-17}};
  const auto read_rig = read_model_file(to_metadata(rig));
  ASSERT_TRUE(read_rig) << read_rig.error().message();
  EXPECT_EQ(read_rig->scaler->scale, rig.scaler->scale);
  EXPECT_EQ(read_rig->scaler->min, rig.scaler->min);

  ModelFile encoder;
  encoder.architecture = Architecture::speech_encoder;
  encoder.encoder = EncoderConfig{};
  EXPECT_TRUE(read_model_file(to_metadata(encoder)));
}

TEST(ModelFile, RefusesWhatDoesNotFit) {
  const auto rejection = [](const auto& change) {
    ModelFile m = vertex_model();
    change(m);
    const auto read = read_model_file(to_metadata(m));
    return read ? std::string("accepted") : read.error().message();
  };
  EXPECT_THAT(rejection([](auto& m) { m.output.channels = 0; }), HasSubstr("channels"));
  EXPECT_THAT(rejection([](auto& m) { m.output.channels = 181; }), HasSubstr("multiple of 3"));
  EXPECT_THAT(rejection([](auto& m) { m.output.channels = std::int64_t{1} << 60; }), HasSubstr("30 million"));
  EXPECT_THAT(rejection([](auto& m) { m.output.fps = 0; }), HasSubstr("frame rate"));
  EXPECT_THAT(rejection([](auto& m) { m.diffusion->steps = 0; }), HasSubstr("steps"));
  EXPECT_THAT(rejection([](auto& m) { m.diffusion->schedule = "square"; }), HasSubstr("'square'"));
  EXPECT_THAT(rejection([](auto& m) { m.scaler = ModelScaler{{1}, {0}}; }), HasSubstr("scaler"));
  EXPECT_THAT(rejection([](auto& m) { m.format_version = 99; }), HasSubstr("newer Mien"));
  EXPECT_THAT(rejection([](auto& m) { m.encoder->num_attention_heads = 5; }),
              HasSubstr("num_attention_heads"));
}

TEST(ModelFile, RefusesDamagedDescriptions) {
  EXPECT_THAT(read_model_file({}).error().message(), HasSubstr("no description of a Mien model"));
  const std::string whole = to_metadata(vertex_model()).at("mien.model");
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_FALSE(read_model_file({{"mien.model", whole.substr(0, n)}})) << n;
  for (const char* text : {"[]", "null", "{}", R"({"format_version":"2"})",
                           R"({"format_version":2,"architecture":"said","name":""})",
                           R"({"format_version":2,"architecture":"facexhubert","name":""})"}) {
    const auto read = read_model_file({{"mien.model", text}});
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, Errc::incompatible) << text;
  }
}

}  // namespace
}  // namespace mien

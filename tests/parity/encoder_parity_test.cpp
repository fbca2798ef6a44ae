// Speech encoders: every stage of every recorded pass, on the runtime.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "closeness.h"
#include "encoder_fixture.h"
#include "mien/base/file.h"
#include "mien/models/runtime_parameters.h"

namespace mien::parity {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  EXPECT_TRUE(bytes) << path;
  return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : std::string();
}

/// Runs body(model, file) for all recorded passes of all models.
template <class Body>
void for_each_pass(Body&& body) {
  const auto models = encoder_models();
  if (models.empty()) GTEST_SKIP() << "no recorded encoders in " << fixture_root();
  for (const auto& model : models) {
    for (const auto& file : model.files) {
      SCOPED_TRACE(model.folder + "/" + file);
      try {
        body(model, file);
      } catch (const std::exception& problem) {
        ADD_FAILURE() << problem.what();
      }
    }
  }
}

SafetensorsFile weights_of(const EncoderModel& model) {
  auto file = SafetensorsFile::open(fixture_root() / model.folder / "model.safetensors");
  if (!file) throw std::runtime_error(file.error().message());
  return std::move(*file);
}

SpeechEncoder<Tensor> plain_encoder(const EncoderModel& model) {
  SpeechEncoder<Tensor> encoder(model.config);
  const SafetensorsFile weights = weights_of(model);
  // Heads for other tasks lie beside an encoder whose names have no prefix.
  LoadRuntime load(weights, model.prefix);
  encoder.visit(load);
  const auto loaded = load.finish();
  EXPECT_TRUE(loaded) << loaded.error().message();
  return encoder;
}

TEST(Encoder, EqualsEveryRecordedStage) {
  std::set<std::string> seen;
  for_each_pass([&](const EncoderModel& model, const std::string& file) {
    const EncoderCase given(model, file);
    const auto encoder = plain_encoder(model);
    std::vector<std::pair<std::string, Tensor>> stages;
    RecordStages<Tensor> hooks;
    hooks.stages = &stages;
    stages.emplace_back("final", encoder(given.waveform, given.call(), hooks));
    std::size_t num_compared = 0;
    for (const auto& [name, value] : stages) {
      if (!given.recorded.has(name)) continue;
      SCOPED_TRACE(name);
      MIEN_EXPECT_CLOSE(value, given.recorded.tensor(name), "encoder");
      seen.insert(name.substr(0, name.find('.')));
      ++num_compared;
    }
    for (const auto& stored : given.recorded.file().tensors()) {  // nothing recorded goes uncompared
      const bool is_input = stored.name == "raw" || stored.name == "input_values" ||
                            stored.name == "num_frames" || stored.name == "mask_time_indices" ||
                            stored.name == "attention_mask_samples";
      if (!is_input) --num_compared;
    }
    EXPECT_EQ(num_compared, 0u) << "a recorded stage has no counterpart";
  });
  if (testing::Test::IsSkipped()) return;
  EXPECT_TRUE(seen.contains("final"));
}

TEST(Encoder, NormalisesTheWaveformAsRecorded) {
  for_each_pass([&](const EncoderModel& model, const std::string& file) {
    const EncoderCase given(model, file);
    if (!given.recorded.has("raw") || !given.recorded.has_metadata("eps")) return;
    Tensor samples = given.recorded.tensor("raw");
    const std::string& text = given.recorded.metadata("eps");
    double eps = -1;
    std::from_chars(text.data(), text.data() + text.size(), eps);
    if (eps > 0) normalise_waveform(samples.values(), eps);
    MIEN_EXPECT_CLOSE(samples, given.recorded.tensor("input_values"), "encoder waveform");
  });
}

TEST(Encoder, ReadsTheSizesFromTheWeights) {
  for (const auto& model : encoder_models()) {
    SCOPED_TRACE(model.folder);
    const SafetensorsFile weights = weights_of(model);
    std::map<std::string, Shape> shapes;
    for (const auto& t : weights.tensors())
      if (t.name.starts_with(model.prefix)) shapes[t.name.substr(model.prefix.size())] = t.shape;
    const auto config = encoder_config_from_shapes(shapes);
    ASSERT_FALSE(config);  // the number of heads of a tiny model cannot be known
    EXPECT_NE(config.error().what.find("num_attention_heads"), std::string::npos) << config.error().message();
  }
}

TEST(Encoder, AcceptsAndRefusesConfigurations) {
  const fs::path folder = fixture_root() / "encoders/checkpoint-variants/configs";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string(), text = text_of(entry.path());
    SCOPED_TRACE(name);
    const auto config = encoder_config_from_json(text);
    if (name.starts_with("accept_")) {
      ASSERT_TRUE(config) << config.error().message();
      const auto again = encoder_config_from_json(to_json(*config));
      ASSERT_TRUE(again) << again.error().message();
      EXPECT_EQ(*again, *config);
      continue;
    }
    ASSERT_FALSE(config);
    const std::string& what = config.error().what;
    const std::string field = what.substr(what.rfind(' ') + 1);
    EXPECT_TRUE(nlohmann::json::parse(text).contains(field)) << "'" << field << "' is not in the file";
  }
}

// ---- Full size, weights by recipe
// ----------------------------------------------------------------------------------

class FullSizeEncoder : public testing::Test {
 protected:
  static constexpr const char* kFolder = "encoders/hubert-base-fullsize";
  void SetUp() override {
    if (!fs::exists(fixture_root() / kFolder / "expected.json"))
      GTEST_SKIP() << "no recorded " << kFolder << " in " << fixture_root();
    expected_ = nlohmann::json::parse(text_of(fixture_root() / kFolder / "expected.json"));
    salt_ = std::stoull(expected_.at("salt_hex").get<std::string>(), nullptr, 16);
  }
  nlohmann::json expected_;
  std::uint64_t salt_ = 0;
};

TEST_F(FullSizeEncoder, RecipeGivesTheRecordedWeights) {
  for (const auto& [name, want] : expected_.at("weights").items()) {
    SCOPED_TRACE(name);
    const auto values = recipe_values(name, want.at("shape").get<Shape>(), salt_);
    double sum = 0;
    for (const float v : values) sum += v;
    EXPECT_NEAR(sum, want.at("sum").get<double>(), 1e-4 * std::sqrt(static_cast<double>(values.size())));
    for (std::size_t i = 0; i < want.at("first").size(); ++i)
      EXPECT_EQ(values[i], want.at("first")[i].get<float>()) << i;
    EXPECT_EQ(values.back(), want.at("last").get<float>());
  }
}

/// Compares a stage with recorded statistics: eight elements, and the length as a check of all others.
void expect_statistics(const Tensor& got, const nlohmann::json& want) {
  ASSERT_EQ(got.count(), want.at("count").get<std::int64_t>());
  double squares = 0;
  for (const float v : got.values()) squares += static_cast<double>(v) * v;
  EXPECT_NEAR(std::sqrt(squares) / want.at("l2").get<double>(), 1.0, 1e-5);
  const auto& index = want.at("probe_index");
  std::vector<double> values, probes;
  for (std::size_t i = 0; i < index.size(); ++i) {
    values.push_back(got.values()[index[i].get<std::size_t>()]);
    probes.push_back(want.at("probe_value")[i].get<double>());
  }
  MIEN_EXPECT_CLOSE(values, probes, "encoder");
}

TEST_F(FullSizeEncoder, EqualsTheRecordedPass) {
  // "inputs/speech_2000ms.wav (32000 samples), normalised with eps 1e-5": 16 bit, one channel
  const std::string input = expected_.at("input").get<std::string>();
  const std::string wav = text_of(fixture_root() / "encoders" / input.substr(0, input.find(' ')));
  const std::size_t data = wav.find("data");
  ASSERT_NE(data, std::string::npos);
  Tensor samples({static_cast<std::int64_t>((wav.size() - data - 8) / 2), 1});
  for (std::size_t i = 0; i < samples.values().size(); ++i) {
    const auto low = static_cast<unsigned char>(wav[data + 8 + 2 * i]),
               high = static_cast<unsigned char>(wav[data + 9 + 2 * i]);
    samples.values()[i] = static_cast<float>(static_cast<std::int16_t>(low | high << 8)) / 32768.0f;
  }
  normalise_waveform(samples.values(), 1e-5);

  SpeechEncoder<Tensor> encoder{EncoderConfig{}};
  FillByRecipe fill(salt_);
  encoder.visit(fill);
  EXPECT_EQ(fill.num_tensors, expected_.at("tensor_count").get<std::int64_t>());
  EXPECT_EQ(fill.num_values, expected_.at("parameter_count").get<std::int64_t>());

  std::vector<std::pair<std::string, Tensor>> stages;
  RecordStages<Tensor> hooks;
  hooks.stages = &stages;
  const Tensor final = encoder(samples, {}, hooks);
  for (const auto& [name, value] : stages) {
    if (!expected_.at("stats").contains(name)) continue;
    SCOPED_TRACE(name);
    expect_statistics(value, expected_["stats"][name]);
  }
  const Fixture recorded(kFolder, "expected.ref.safetensors");
  MIEN_EXPECT_CLOSE(rows(final, 16, 64), recorded.tensor("final_rows_16_to_79"), "encoder");
}

}  // namespace
}  // namespace mien::parity

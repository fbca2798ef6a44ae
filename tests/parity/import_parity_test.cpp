// Files as people have them, imported: every form of a checkpoint gives the tensors of the plain one, bit for
// bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "closeness.h"
#include "fixture.h"
#include "mien/base/file.h"
#include "mien/models/face_model.h"
#include "mien/models/import/import_model.h"

namespace mien::parity {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::string_view kEncoder = ModelFile::kEncoderPrefix;

class ImportParity : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("mien_import_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Imports into out.safetensors and opens it.
  Result<SafetensorsFile> import(const ImportOptions& options) {
    Progress progress;
    auto imported = import_model(options, out(), progress);
    if (!imported) return imported.error();
    imported_ = std::move(*imported);
    return SafetensorsFile::open(out());
  }
  [[nodiscard]] fs::path out() const { return folder_ / "out.safetensors"; }

  /// The configuration that a fixture's tiny HuBERT needs beyond its shapes, as a Hugging Face config.json.
  fs::path write_config(const nlohmann::json& config) {
    const auto& tiny = config.at("hubert");
    const nlohmann::json hugging_face = {{"model_type", "hubert"},
                                         {"hidden_size", tiny.at("hidden")},
                                         {"num_hidden_layers", tiny.at("layers")},
                                         {"num_attention_heads", tiny.at("heads")},
                                         {"intermediate_size", tiny.at("inter")},
                                         {"conv_dim", std::vector<int>(7, tiny.at("conv").get<int>())}};
    EXPECT_TRUE(write_file(folder_ / "config.json", hugging_face.dump()));
    return folder_ / "config.json";
  }

  fs::path folder_;
  ImportedModel imported_;
};

float through_bfloat(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return std::bit_cast<float>(
      static_cast<std::uint32_t>((bits + 0x7fffu + ((bits >> 16) & 1u)) & 0xffff0000u));
}

// What a file whose name says so stores of a float32.
float as_stored(float value, const std::string& file) {
  if (file.find("bf16") != file.npos) return through_bfloat(value);
  if (file.find("f16") != file.npos) return half_to_float(float_to_half(value));
  return value;
}

std::string first_difference(const std::vector<float>& got, const std::vector<float>& want) {
  if (got.size() != want.size()) return "sizes differ";
  for (std::size_t i = 0; i < got.size(); ++i)
    if (got[i] != want[i])
      return "element " + std::to_string(i) + ": " + std::to_string(got[i]) + ", expected " +
             std::to_string(want[i]);
  return "";
}

std::string without_prefix(const std::string& name, std::string_view anchor) {
  const auto at = name.find(anchor);
  return at == name.npos ? name : name.substr(at);
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> all;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(folder, ec)) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  return all;
}

// Weight norm taken apart and put together: g v / |v|, in double.
std::vector<double> positional_weight(const SafetensorsFile& file, const std::string& prefix) {
  const auto g = file.read_float(prefix + "weight_g").value(),
             v = file.read_float(prefix + "weight_v").value();
  std::vector<double> squares(g.size(), 0.0), weight(v.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    squares[i % g.size()] += static_cast<double>(v[i]) * static_cast<double>(v[i]);
  for (std::size_t i = 0; i < v.size(); ++i)
    weight[i] =
        static_cast<double>(g[i % g.size()]) * static_cast<double>(v[i]) / std::sqrt(squares[i % g.size()]);
  return weight;
}

TEST_F(ImportParity, EveryFormOfACheckpoint) {
  const fs::path folder = fixture_root() / "encoders/checkpoint-variants";
  const auto plain = SafetensorsFile::open(folder / "01_plain.safetensors");
  if (!plain) GTEST_SKIP() << "no recorded encoders/checkpoint-variants in " << fixture_root();
  int count = 0;
  for (const auto& path : files_in(folder)) {
    const std::string file = path.filename().string();
    if (file.empty() || std::isdigit(static_cast<unsigned char>(file[0])) == 0) continue;
    SCOPED_TRACE(file);
    ++count;
    ImportOptions options{.sources = {path}};
    options.encoder = folder / "config.json";
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_EQ(imported_.description.architecture, Architecture::speech_encoder);
    const bool folded = file.find("weight_norm_removed") != file.npos;
    std::size_t compared = 0;
    for (const auto& tensor : plain->tensors()) {
      if (folded && tensor.name.find("pos_conv_embed.conv.weight") != tensor.name.npos) continue;
      auto want = plain->read_float(tensor.name).value();
      for (float& value : want) value = as_stored(value, file);
      const std::string name = std::string(kEncoder) + tensor.name;
      if (tensor.name == "masked_spec_embed" && model->find(name) == nullptr) continue;
      const auto got = model->read_float(name);
      ASSERT_TRUE(got) << got.error().message();
      EXPECT_EQ(model->find(name)->shape, tensor.shape) << tensor.name;
      EXPECT_EQ(first_difference(*got, want), "") << tensor.name;
      ++compared;
    }
    EXPECT_GT(compared, 20u);
    EXPECT_LE(model->tensors().size(), plain->tensors().size()) << "nothing of anybody else";
    if (!folded) continue;
    const std::string positions = "encoder.pos_conv_embed.conv.";
    const auto got = positional_weight(*model, std::string(kEncoder) + positions);
    const auto want = positional_weight(*plain, positions);
    for (std::size_t i = 0; i < want.size(); ++i) ASSERT_NEAR(got[i], want[i], 1e-6) << i;
  }
  EXPECT_GT(count, 0);
}

TEST_F(ImportParity, RefusesEveryDamagedFileByName) {
  const fs::path folder = fixture_root() / "encoders/checkpoint-variants";
  const auto files = files_in(folder / "reject");
  if (files.empty()) GTEST_SKIP() << "no recorded encoders/checkpoint-variants/reject in " << fixture_root();
  for (const auto& path : files) {
    SCOPED_TRACE(path.filename().string());
    ImportOptions options{.sources = {path}};
    options.encoder = folder / "config.json";
    const auto model = import(options);
    ASSERT_FALSE(model);
    EXPECT_THAT(model.error().message(), HasSubstr(path.filename().string()));
    EXPECT_FALSE(model.error().why.empty());
    EXPECT_FALSE(fs::exists(out()));
  }
}

TEST_F(ImportParity, HuggingFaceFolders) {
  constexpr std::string_view kAnchors[] = {"feature_extractor.", "feature_projection.", "encoder.",
                                           "masked_spec_embed"};
  int count = 0;
  for (const auto& folder : files_in(fixture_root() / "encoders")) {
    if (!fs::exists(folder / "config.json") || !fs::exists(folder / "model.safetensors")) continue;
    SCOPED_TRACE(folder.filename().string());
    ++count;
    const auto stored = SafetensorsFile::open(folder / "model.safetensors");
    ASSERT_TRUE(stored);
    const auto model = import({.sources = {folder}});
    ASSERT_TRUE(model) << model.error().message();
    std::size_t compared = 0;
    for (const auto& tensor : stored->tensors()) {
      std::string name = tensor.name;
      for (const auto anchor : kAnchors)
        if (name == tensor.name) name = without_prefix(tensor.name, anchor);
      if (model->find(std::string(kEncoder) + name) == nullptr) continue;  // heads
      EXPECT_EQ(first_difference(model->read_float(std::string(kEncoder) + name).value(),
                                 stored->read_float(tensor.name).value()),
                "")
          << name;
      ++compared;
    }
    EXPECT_EQ(compared, model->tensors().size());
    const auto& config = *imported_.description.encoder;
    EXPECT_EQ(config.normalise_eps, config.model_type == "wav2vec2" ? 1e-7 : 1e-5);
    if (!fs::exists(folder / "pytorch_model.bin")) continue;
    const Bytes from_safetensors = read_file(out()).value();
    const fs::path copy = folder_ / folder.filename();
    fs::create_directories(copy);
    for (const char* name : {"config.json", "preprocessor_config.json", "pytorch_model.bin"})
      if (fs::exists(folder / name)) fs::copy_file(folder / name, copy / name);
    ASSERT_TRUE(import({.sources = {copy}}));
    EXPECT_EQ(read_file(out()).value(), from_safetensors);
  }
  if (count == 0) GTEST_SKIP() << "no recorded encoders in " << fixture_root();
}

/// All NAME.weights.safetensors of a system's folder, with the .pth beside them where there is one.
void for_each_system(const std::function<void(const std::string&, const Fixture&, const fs::path&)>& body) {
  int count = 0;
  for (const char* folder : {"facediffuser", "facexhubert"})
    for (const std::string& name : cases(folder, "", ".weights.safetensors")) {
      SCOPED_TRACE(name);
      const Fixture weights(folder, name + ".weights.safetensors");
      for (const char* ending : {".weights.safetensors", ".weights.pth"}) {
        const fs::path file = fixture_root() / folder / (name + ending);
        if (!fs::exists(file)) continue;
        SCOPED_TRACE(ending);
        ++count;
        body(name, weights, file);
      }
    }
  if (count == 0) GTEST_SKIP() << "no recorded systems in " << fixture_root();
}

TEST_F(ImportParity, AuthorsCheckpoints) {
  for_each_system([&](const std::string&, const Fixture& weights, const fs::path& file) {
    const auto config = weights.config();
    ImportOptions options{.sources = {file}};
    options.encoder = write_config(config);
    options.fps = config.at("fps").get<double>();
    const bool is_damm = config.value("kind", "") == "damm";
    if (is_damm) options.steps = config.at("steps").get<std::int64_t>();
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    const auto& m = imported_.description;
    EXPECT_EQ(architecture_name(m.architecture),
              config.contains("kind") ? "facediffuser_" + config["kind"].get<std::string>() : "facexhubert");
    EXPECT_EQ(m.output.channels, config.at("dim").get<std::int64_t>());
    EXPECT_EQ(static_cast<std::int64_t>(m.subjects.size()), config.value("subj", 0));
    if (config.contains("steps")) {
      EXPECT_EQ(m.diffusion->steps, config["steps"].get<std::int64_t>());
      EXPECT_EQ(m.diffusion->schedule, "cosine");
    }
    EXPECT_EQ(m.encoder->num_attention_heads, config["hubert"]["heads"].get<std::int64_t>());
    EXPECT_EQ(model->tensors().size(), weights.file().tensors().size());
    for (const auto& tensor : weights.file().tensors()) {
      const auto got = model->read_float(tensor.name);
      ASSERT_TRUE(got) << got.error().message();
      EXPECT_EQ(model->find(tensor.name)->shape, tensor.shape);
      EXPECT_EQ(first_difference(*got, weights.file().read_float(tensor.name).value()), "") << tensor.name;
    }
    const auto read = read_model_file(model->metadata());
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->encoder, m.encoder);
    EXPECT_EQ(read->subjects, m.subjects);
  });
}

TEST_F(ImportParity, HalfPrecisionRoundsToNearest) {
  for_each_system([&](const std::string&, const Fixture& weights, const fs::path& file) {
    if (file.extension() != ".pth") return;
    ImportOptions options{.sources = {file}, .half = true};
    options.encoder = write_config(weights.config());
    options.fps = weights.config().at("fps").get<double>();
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    for (const auto& tensor : weights.file().tensors()) {
      auto want = weights.file().read_float(tensor.name).value();
      for (float& value : want) value = half_to_float(float_to_half(value));
      EXPECT_EQ(first_difference(model->read_float(tensor.name).value(), want), "") << tensor.name;
    }
  });
}

TEST_F(ImportParity, TemplatesOfEveryProtocol) {
  const fs::path folder = fixture_root() / "facediffuser";
  const auto recorded = SafetensorsFile::open(folder / "templates.safetensors");
  if (!recorded) GTEST_SKIP() << "no recorded facediffuser/templates.safetensors in " << fixture_root();
  const std::int64_t channels = recorded->tensors().front().count();
  int num_checkpoints = 0, count = 0;
  for_each_system([&](const std::string&, const Fixture& weights, const fs::path& file) {
    num_checkpoints += file.extension() == ".pth";
    if (file.extension() != ".pth" || weights.config().at("dim") != channels) return;
    for (const auto& pickle : files_in(folder)) {
      if (pickle.extension() != ".pkl" || !pickle.filename().string().starts_with("templates")) continue;
      SCOPED_TRACE(pickle.filename().string());
      ++count;
      ImportOptions options{.sources = {file, pickle}};  // told by its content
      options.encoder = write_config(weights.config());
      options.fps = weights.config().at("fps").get<double>();
      const auto model = import(options);
      ASSERT_TRUE(model) << model.error().message();
      EXPECT_EQ(template_subjects(*model).size(), recorded->tensors().size());
      for (const auto& tensor : recorded->tensors()) {
        const std::string subject = tensor.name.substr(tensor.name.find('.') + 1);
        const auto got = read_template(*model, subject);
        ASSERT_TRUE(got) << got.error().message();
        EXPECT_EQ(first_difference(*got, recorded->read_float(tensor.name).value()), "") << subject;
      }
    }
  });
  if (num_checkpoints == 0) GTEST_SKIP() << "no recorded .pth in " << fixture_root();
  EXPECT_GT(count, 0);
}

TEST_F(ImportParity, ScalerOfTheRig) {
  int count = 0;
  for (const std::string& name : cases("facediffuser", "", ".scaler.safetensors")) {
    SCOPED_TRACE(name);
    ++count;
    const Fixture recorded("facediffuser", name + ".scaler.safetensors");
    const Fixture weights("facediffuser", name + ".weights.safetensors");
    const fs::path folder = fixture_root() / "facediffuser";
    ImportOptions options{.sources = {folder / (name + ".weights.pth"), folder / (name + ".scaler.pkl")}};
    options.encoder = write_config(weights.config());
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    const auto read = read_model_file(model->metadata());
    ASSERT_TRUE(read && read->scaler);
    EXPECT_EQ(read->scaler->scale, recorded.doubles("scale_")) << "through JSON and back";
    EXPECT_EQ(read->scaler->min, recorded.doubles("min_"));
    const auto scaled = recorded.file().read_float("scaled").value();
    const auto want = recorded.file().read_float("expected.inverse").value();
    const std::size_t channels = read->scaler->min.size();
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      const double inverse = (static_cast<double>(scaled[i]) - read->scaler->min[i % channels]) /
                             read->scaler->scale[i % channels];
      EXPECT_NEAR(inverse, want[i], 1e-5 * std::max(1.0, std::abs(inverse)));
    }
  }
  if (count == 0) GTEST_SKIP() << "no recorded scalers in " << fixture_root();
}

// Sixteen-bit samples at 16 kHz as a clip.
AudioClip clip_of(const Fixture& recorded) {
  const Tensor samples = recorded.tensor("in.audio_float");
  AudioClip clip;
  clip.samples.assign(samples.values().begin(), samples.values().end());
  return clip;
}

// From a Lightning checkpoint with everything that a trainer leaves in it to the recorded parameters.
TEST_F(ImportParity, ProbTalk3DFromItsCheckpoint) {
  const fs::path folder = fixture_root() / "probtalk3d";
  if (!fs::exists(folder / "stage2_last.ckpt"))
    GTEST_SKIP() << "no recorded probtalk3d in " << fixture_root();
  const Fixture recorded("probtalk3d", "stage2_last_expected.safetensors");
  ImportOptions options{.sources = {folder / "stage2_last.ckpt"}};
  options.encoder = folder_ / "config.json";
  ASSERT_TRUE(write_file(options.encoder, std::string_view(recorded.metadata("hubert"))));
  const auto model = import(options);
  ASSERT_TRUE(model) << model.error().message();
  const ModelFile& m = imported_.description;
  EXPECT_EQ(m.architecture, Architecture::probtalk3d);
  EXPECT_EQ(m.output.space, "flame");
  EXPECT_EQ(m.output.fps, 25);
  EXPECT_EQ(m.encoder->normalise_eps, 1e-5);
  EXPECT_EQ(m.subjects.size() + m.emotions.size() + m.intensities.size(),
            static_cast<std::size_t>(recorded.tensor("in.style_onehot").count()));
  EXPECT_EQ(m.subjects.front(), "M003");
  EXPECT_EQ(m.emotions.back(), "contempt");
  // Every tensor of the file is one of the checkpoint's, and the buffers were left out.
  const Fixture stage2("probtalk3d", "stage2_audio.safetensors");
  const int heads = std::stoi(stage2.metadata("heads"));
  EXPECT_EQ(m.sizes.at("heads"), heads) << "of the checkpoint's own options";
  int num_equal = 0;
  for (const auto& tensor : model->tensors()) {
    const bool is_encoder = tensor.name.starts_with(kEncoder);
    const std::string name =
        is_encoder ? "feature_extractor.audiomodel." + tensor.name.substr(kEncoder.size()) : tensor.name;
    ASSERT_TRUE(stage2.has(name)) << name;
    EXPECT_EQ(
        first_difference(model->read_float(tensor.name).value(), stage2.file().read_float(name).value()), "")
        << name;
    ++num_equal;
  }
  EXPECT_GT(num_equal, 100);

  const auto face = FaceModel::load(out());
  ASSERT_TRUE(face) << face.error().message();
  const std::string key = recorded.metadata("keyid");  // identity, x, emotion, intensity
  FaceOptions words;
  words.style = key.substr(0, key.find('_'));
  words.emotion = m.emotions.at(static_cast<std::size_t>(key.at(key.size() - 3) - '0')) + ":" +
                  m.intensities.at(static_cast<std::size_t>(key.back() - '0'));
  words.draw.temperature = 0;
  Progress progress;
  const auto takes = animate(*face, clip_of(recorded), words, 2, 2, progress);
  ASSERT_TRUE(takes) << takes.error().message();
  const Tensor want = recorded.tensor("out.motion");
  std::vector<float> normalised = takes->front().values;
  apply_scaler(*m.scaler, normalised);
  ASSERT_EQ(takes->front().num_frames(), want.num_rows());
  MIEN_EXPECT_CLOSE(Tensor(want.shape(), normalised), want, "motion");
  EXPECT_EQ(takes->front().values, takes->back().values) << "the nearest codes are the same in every take";
}

// Stage 1 alone, from weights without a trainer's options.
TEST_F(ImportParity, ProbTalk3DMotionPriors) {
  for (const char* name : {"vqvae_stage1", "vae_stage1"}) {
    const fs::path file = fixture_root() / "probtalk3d" / (std::string(name) + ".safetensors");
    if (!fs::exists(file)) GTEST_SKIP() << "no recorded " << file;
    const Fixture recorded("probtalk3d", std::string(name) + ".safetensors");
    ImportOptions options{.sources = {file}};
    options.heads = std::stoll(recorded.metadata("heads"));
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_EQ(imported_.description.architecture, Architecture::probtalk3d_prior);
    EXPECT_EQ(imported_.description.sizes.at("heads"), *options.heads);
    EXPECT_EQ(model->find("quantize.embedding.weight") != nullptr, recorded.has("quantize.embedding.weight"));
    const auto read = read_model_file(model->metadata());
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_FALSE(FaceModel::load(out())) << "it cannot hear";
  }
}

// Both layouts of the archive give the same model, which is told from FaceDiffuser V by its style.
TEST_F(ImportParity, EmotionalFaceDiffuserFromItsStateDict) {
  const fs::path folder = fixture_root() / "probtalk3d";
  if (!fs::exists(folder / "facediffuser_emo.safetensors"))
    GTEST_SKIP() << "no recorded probtalk3d in " << fixture_root();
  const Fixture recorded("probtalk3d", "facediffuser_emo.safetensors");
  ImportOptions options;
  options.encoder = folder_ / "config.json";
  ASSERT_TRUE(write_file(options.encoder, std::string_view(recorded.metadata("hubert"))));
  for (const char* file : {"facediffuser_emo_state_dict.pth", "facediffuser_emo_state_dict_newzip.pth"}) {
    SCOPED_TRACE(file);
    options.sources = {folder / file};
    const auto model = import(options);
    ASSERT_TRUE(model) << model.error().message();
    const ModelFile& m = imported_.description;
    EXPECT_EQ(m.architecture, Architecture::facediffuser_emotion);
    EXPECT_EQ(m.output.space, "vertices");
    EXPECT_EQ(m.output.fps, 25);
    EXPECT_EQ(m.diffusion->steps, 1000);
    EXPECT_EQ(m.subjects.size() + m.emotions.size() + m.intensities.size(),
              static_cast<std::size_t>(recorded.tensor("in.style_onehot").count()));
    for (const auto& tensor : model->tensors())
      EXPECT_EQ(first_difference(model->read_float(tensor.name).value(),
                                 recorded.file().read_float(tensor.name).value()),
                "")
          << tensor.name;
  }
  const auto face = FaceModel::load(out());
  ASSERT_TRUE(face) << face.error().message();
  FaceOptions words = published_options(face->description());
  EXPECT_EQ(words.skip, 900);
  AudioClip clip;
  const auto pcm = recorded.file().as<std::int32_t>("in.pcm16");
  ASSERT_TRUE(pcm) << pcm.error().message();
  for (const std::int32_t sample : *pcm) clip.samples.push_back(static_cast<float>(sample) / 32768.0f);
  Progress progress;
  words.emotion = "angry:3";
  const auto angry = animate(*face, clip, words, 1, 1, progress);
  ASSERT_TRUE(angry) << angry.error().message();
  EXPECT_EQ(angry->front().num_frames(), std::stoll(recorded.metadata("num_frames")));
  words.emotion = "sad:1";
  EXPECT_NE(animate(*face, clip, words, 1, 1, progress)->front().values, angry->front().values);
}

}  // namespace
}  // namespace mien::parity

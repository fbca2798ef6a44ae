// SAiD from the waveform to the coefficients: every recorded stage of the speech, every recorded walk and
// edit, on the tensor library of the program that includes this.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "closeness.h"
#include "encoder_fixture.h"
#include "mien/models/said/sampling.h"
#include "said_fixture.h"

namespace mien::parity {

/// Floats of a recorded tensor of any rank, and a part of it: block i of [blocks, rows, width].
struct RecordedBlocks {
  RecordedBlocks(const Fixture& recorded, const std::string& name)
      : values(recorded.file().read_float(name).value()), shape(recorded.file().find(name)->shape) {
    num_blocks = 1;
    for (std::size_t i = 0; i + 2 < shape.size(); ++i) num_blocks *= shape[i];
  }
  [[nodiscard]] Tensor block(std::int64_t i) const {
    const std::int64_t rows = shape[shape.size() - 2], width = shape.back();
    const auto count = static_cast<std::size_t>(rows * width);
    return Tensor({rows, width}, std::span(values).subspan(static_cast<std::size_t>(i) * count, count));
  }
  std::vector<float> values;
  Shape shape;
  std::int64_t num_blocks = 0;
};

/// Recorded noise of one take: where a walk starts, [B, N, K], and of its steps, [steps, B, N, K] if any.
class SaidNoise final : public FrameNoise {
 public:
  SaidNoise(const Fixture& recorded, const std::string& start, const std::string& steps, std::int64_t take)
      : start_(recorded, start), take_(take) {
    if (recorded.has(steps)) steps_.emplace(recorded, steps);
  }
  void start(std::int64_t frame, std::span<float> out) const override {
    std::ranges::copy(start_.block(take_).row(frame), out.begin());
  }
  void step(int step, std::int64_t frame, std::span<float> out) const override {
    std::ranges::copy(steps_.value().block(step * start_.num_blocks + take_).row(frame), out.begin());
  }

 private:
  RecordedBlocks start_;
  std::optional<RecordedBlocks> steps_;
  std::int64_t take_;
};

/// The encoder of the recorded weights.
inline EncoderConfig said_encoder_config(const Fixture& recorded) {
  auto json = nlohmann::json::parse(recorded.metadata("audio"));
  json["model_type"] = "wav2vec2";
  json["normalise_eps"] = 1e-7;
  const auto config = encoder_config_from_json(json.dump());
  if (!config) throw std::runtime_error(config.error().message());
  return *config;
}

template <class T>
SpeechEncoder<T> said_encoder(const Fixture& weights) {
  return Backend<T>::load(weights, SpeechEncoder<T>(said_encoder_config(weights)), "audio_encoder.");
}

/// What the parameters of the recorded calls mean.
inline said::SamplingOptions said_options(const nlohmann::json& call) {
  said::SamplingOptions options;
  options.num_steps = call.at("num_inference_steps").get<std::int64_t>();
  options.guidance.scale = call.at("guidance_scale").get<double>();
  options.guidance.rescale = call.value("guidance_rescale", 0.0);
  options.sampler.eta = call.value("eta", 0.0);
  options.strength = call.value("strength", 1.0);
  return options;
}

/// A denoiser and one recorded waveform [S] for each take, encoded to as many frames as recorded.
template <class T>
class SaidPerformer {
 public:
  explicit SaidPerformer(const Fixture& weights)
      : network_(said_network<T>(weights)),
        encoder_(said_encoder<T>(weights)),
        eps_(said_encoder_config(weights).normalise_eps) {}

  [[nodiscard]] T encode(std::span<const float> waveform, std::int64_t num_frames) const {
    std::vector<float> samples(waveform.begin(), waveform.end());
    normalise_waveform(samples, eps_);
    const Tensor rows({static_cast<std::int64_t>(samples.size()), 1}, samples);
    return encoder_(Backend<T>::given(rows), EncoderCall{num_frames, {}, {}, {}});
  }
  void hear(std::vector<T> features) {
    contexts_.clear();
    for (T& f : features) contexts_.push_back(network_.context(f));
  }
  [[nodiscard]] said::NoiseNetwork network(std::int64_t num_frames) const {
    return [this, num_frames](std::int64_t step, std::span<const float> x_t, std::span<float> with,
                              std::span<float> without) {
      const std::int64_t steps[] = {step};
      const auto size = x_t.size() / contexts_.size();
      for (std::size_t take = 0; take < contexts_.size(); ++take) {
        const T x = Backend<T>::given(
            Tensor({num_frames, network_.sizes.num_channels}, x_t.subspan(take * size, size)));
        const auto keep = [&](const T& noise, std::span<float> out) {
          std::ranges::copy(Backend<T>::values(noise).values(), out.subspan(take * size, size).begin());
        };
        keep(network_.denoiser(x, steps, contexts_[take]), with);
        if (!without.empty())
          keep(network_.denoiser(x, steps, network_.null_context(contexts_[take])), without);
      }
    };
  }
  [[nodiscard]] std::int64_t num_channels() const { return network_.sizes.num_channels; }

 private:
  said::Network<T> network_;
  SpeechEncoder<T> encoder_;
  double eps_;
  std::vector<T> contexts_;
};

template <class T>
class SaidSampling : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_said("ddim.safetensors") || !has_said("edit.safetensors") ||
        !has_said("audio_features.safetensors"))
      GTEST_SKIP() << "no recorded said in " << fixture_root();
  }
};
TYPED_TEST_SUITE_P(SaidSampling);

/// Waveforms [B, S] or [S] of a case.
inline std::vector<std::vector<float>> said_waveforms(const Fixture& recorded, const std::string& name) {
  const auto values = recorded.file().read_float(name).value();
  const Shape& shape = recorded.file().find(name)->shape;
  const auto length = static_cast<std::size_t>(shape.back());
  std::vector<std::vector<float>> waveforms;
  for (std::size_t at = 0; at < values.size(); at += length)
    waveforms.emplace_back(values.begin() + std::ptrdiff_t(at), values.begin() + std::ptrdiff_t(at + length));
  return waveforms;
}

inline Tensor clamped(Tensor x) {
  for (float& v : x.values()) v = std::clamp(v, 0.0f, 1.0f);
  return x;
}

TYPED_TEST_P(SaidSampling, SpeechEqualsEveryRecordedStage) {
  using T = TypeParam;
  const Fixture weights("said", kSaidWeights), recorded("said", "audio_features.safetensors");
  const auto encoder = said_encoder<T>(weights);
  const auto cases = nlohmann::json::parse(recorded.metadata("cases"));
  std::size_t num_compared = 0, index = 0;
  const int count = for_each_said_case(recorded, "waveform", [&](const std::string& prefix) {
    const auto frames = cases.at(index++).at("num_frames");
    auto samples = said_waveforms(recorded, prefix + "waveform").at(0);
    normalise_waveform(samples, encoder.config.normalise_eps);
    const Tensor waveform({static_cast<std::int64_t>(samples.size()), 1}, samples);
    MIEN_EXPECT_CLOSE(waveform.reshaped({1, waveform.count()}),
                      recorded.tensor(prefix + "input_values").reshaped({1, waveform.count()}),
                      "encoder waveform");
    std::vector<std::pair<std::string, T>> stages;
    RecordStages<T> hooks;
    hooks.stages = &stages;
    const EncoderCall call{frames.is_null() ? 0 : frames.template get<std::int64_t>(), {}, {}, {}};
    stages.emplace_back("embedding", encoder(Backend<T>::given(waveform), call, hooks));
    const std::string last = "conv." + std::to_string(encoder.config.conv_dim.size() - 1);
    for (const auto& [stage, value] : stages) {
      const std::string name = stage == last                   ? "conv_features"
                               : stage == "projection"         ? "projected"
                               : stage == "encoder_layer_norm" ? "encoder_input"
                               : stage.starts_with("layer.")   ? "layer" + stage.substr(6)
                                                               : stage;
      if (!recorded.has(prefix + name)) continue;
      SCOPED_TRACE(name);
      Tensor want = recorded.slice(prefix + name, 0);
      if (name == "conv_features") {  // channels first
        Tensor rows_first({want.width(), want.num_rows()});
        for (std::int64_t r = 0; r < want.num_rows(); ++r)
          for (std::int64_t c = 0; c < want.width(); ++c)
            rows_first.row(c)[static_cast<std::size_t>(r)] = want.row(r)[static_cast<std::size_t>(c)];
        want = rows_first;
      }
      MIEN_EXPECT_CLOSE(Backend<T>::values(value), want, "speech features");
      ++num_compared;
    }
  });
  // Everything but the inputs; without interpolation its stage is recorded too, and is the convolutions'.
  EXPECT_GE(num_compared, static_cast<std::size_t>(count) * 7);
  EXPECT_GT(count, 0);
}

/// @param performer  encodes, hears and estimates as SaidPerformer does
template <class T, class Performer>
void expect_recorded_walks(Performer& performer) {
  const Fixture recorded("said", "ddim.safetensors");
  const auto cases = nlohmann::json::parse(recorded.metadata("cases"));
  const auto process = said::training_process();
  std::size_t index = 0;
  const int count = for_each_said_case(recorded, "init_noise", [&](const std::string& prefix) {
    const auto& own = cases.at(index++);
    const RecordedBlocks embedding(recorded, prefix + "audio_embedding"), result(recorded, prefix + "result");
    const std::int64_t num_takes = embedding.num_blocks, num_frames = embedding.shape.at(1);
    std::vector<T> features;
    for (const auto& waveform : said_waveforms(recorded, prefix + "waveform")) {
      features.push_back(performer.encode(waveform, num_frames));
      MIEN_EXPECT_CLOSE(Backend<T>::values(features.back()),
                        embedding.block(static_cast<std::int64_t>(features.size()) - 1), "speech features");
    }
    performer.hear(std::move(features));
    std::vector<SaidNoise> noise;
    for (std::int64_t take = 0; take < num_takes; ++take)
      noise.emplace_back(recorded, prefix + "init_noise", prefix + "variance_noise", take);
    said::Walk walk{.num_frames = num_frames, .num_channels = performer.num_channels()};
    for (const auto& n : noise) walk.takes.push_back(&n);
    const auto options = said_options(own.at("kw"));
    const bool has_steps = recorded.has(prefix + "latents");
    const auto expect_block = [&](std::span<const float> got, const std::string& name, std::int64_t step,
                                  const char* stage) {
      const RecordedBlocks want(recorded, prefix + name);
      const auto size = got.size() / static_cast<std::size_t>(num_takes);
      for (std::int64_t take = 0; take < num_takes; ++take)
        MIEN_EXPECT_CLOSE(
            Tensor({num_frames, walk.num_channels}, got.subspan(static_cast<std::size_t>(take) * size, size)),
            want.block(step * num_takes + take), stage);
    };
    walk.observe = [&](int step, std::span<const float> x_t, std::span<const float> guided) {
      SCOPED_TRACE(step);
      if (has_steps && step > 0) expect_block(x_t, "latents", step - 1, "said latents");
      if (step == 0 && recorded.has(prefix + "noise_pred_first"))
        expect_block(guided, "noise_pred_first", 0, "said latents");
      if (step + 1 == options.num_steps && recorded.has(prefix + "noise_pred_last"))
        expect_block(guided, "noise_pred_last", 0, "said latents");
      if (step == 0 && recorded.has(prefix + "x0_first")) {
        const auto steps = said::walked_steps(options.num_steps, process.size()).value();
        std::vector<float> x0(guided.begin(), guided.end());
        to_x0(Prediction::epsilon, process.level(steps.front()), x_t, x0);
        for (float& v : x0) v = std::clamp(v, -1.0f, 1.0f);
        expect_block(x0, "x0_first", 0, "said first x0");
      }
    };
    Progress progress;
    const auto got = said::sample(performer.network(num_frames), process, options, walk, progress);
    ASSERT_TRUE(got) << got.error().message();
    expect_block(got->values(), has_steps ? "latents" : "final_latent", has_steps ? options.num_steps - 1 : 0,
                 "said latents");
    expect_block(clamped(*got).values(), "result", 0, "said result");
  });
  EXPECT_GT(count, 0);
}

template <class T, class Performer>
void expect_recorded_edits(Performer& performer) {
  const Fixture recorded("said", "edit.safetensors");
  const auto cases = nlohmann::json::parse(recorded.metadata("cases"));
  const auto process = said::training_process();
  std::size_t index = 0;
  const int count = for_each_said_case(recorded, "init_samples", [&](const std::string& prefix) {
    const auto& own = cases.at(index++);
    const auto samples = said_waveforms(recorded, prefix + "waveform").at(0);
    const std::int64_t context_frames =
        static_cast<std::int64_t>(static_cast<double>(samples.size()) / 16000.0 * 60);
    std::vector<T> features;
    features.push_back(performer.encode(samples, context_frames));
    performer.hear(std::move(features));
    const Tensor start = recorded.slice(prefix + "init_samples", 0);
    const std::int64_t num_frames = start.num_rows();
    const auto values_of = [](const Tensor& x) {
      return std::vector<float>(x.values().begin(), x.values().end());
    };
    const KeptValues known(start.width(), values_of(start),
                           recorded.has(prefix + "mask") ? values_of(recorded.slice(prefix + "mask", 0))
                                                         : std::vector<float>(start.values().size()));
    const SaidNoise noise(recorded, prefix + "noise", prefix + "variance_noise", 0);
    const auto options = said_options(own.at("kw"));
    std::int64_t num_run = 0;
    said::Walk walk{
        .num_frames = num_frames, .num_channels = start.width(), .takes = {&noise}, .known = &known};
    const RecordedBlocks entering(recorded, prefix + "latents_in");
    walk.observe = [&](int step, std::span<const float> x_t, std::span<const float>) {
      SCOPED_TRACE(step);
      MIEN_EXPECT_CLOSE(Tensor({num_frames, start.width()}, x_t), entering.block(step), "said latents");
      ++num_run;
    };
    Progress progress;
    const auto got = said::sample(performer.network(num_frames), process, options, walk, progress);
    ASSERT_TRUE(got) << got.error().message();
    EXPECT_EQ(num_run, own.at("steps_run").template get<std::int64_t>());
    MIEN_EXPECT_CLOSE(clamped(*got), recorded.slice(prefix + "result", 0), "said result");
    for (std::int64_t n = 0; n < num_frames; ++n)
      for (std::int64_t c = 0; c < start.width(); ++c)
        if (known.keeps(n, c)) {
          ASSERT_EQ(got->row(n)[static_cast<std::size_t>(c)], known.value(n, c)) << n << ' ' << c;
        }
  });
  EXPECT_GT(count, 0);
}

TYPED_TEST_P(SaidSampling, WalksEndAsRecorded) {
  SaidPerformer<TypeParam> performer{Fixture("said", kSaidWeights)};
  expect_recorded_walks<TypeParam>(performer);
}

TYPED_TEST_P(SaidSampling, EditsEndAsRecorded) {
  SaidPerformer<TypeParam> performer{Fixture("said", kSaidWeights)};
  expect_recorded_edits<TypeParam>(performer);
}

REGISTER_TYPED_TEST_SUITE_P(SaidSampling, SpeechEqualsEveryRecordedStage, WalksEndAsRecorded,
                            EditsEndAsRecorded);

}  // namespace mien::parity

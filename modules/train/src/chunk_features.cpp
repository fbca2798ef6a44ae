#include <array>

#include "condition_batch.h"
#include "mien/audio/running_level.h"
#include "mien/base/bytes.h"

namespace mien::train {
namespace {

namespace dm = default_model;

}  // namespace

Status write_chunk_features(const TrainingSet& set, Network& network, const DefaultTrainingOptions& options,
                            const std::filesystem::path& path, Progress& progress) {
  const torch::NoGradGuard no_grad;
  const auto& entries = set.entries();
  const auto n = static_cast<std::int64_t>(entries.size()), takes = set.num_takes();
  const std::int64_t speech_width = dm::kContextGroups * network.sizes.width;
  std::vector<std::int64_t> chunk_start = {0};
  for (const auto& e : entries) chunk_start.push_back(chunk_start.back() + e.num_frames / dm::kChunkFrames);
  MIEN_TRY(auto writer,
           SafetensorsWriter::create(path, {{"speech", Dtype::f16, {chunk_start.back(), speech_width}},
                                            {"first_mean", Dtype::f32, {n, takes, kNumFace}},
                                            {"chunk_start", Dtype::i64, {n + 1}}}));
  MIEN_TRY([[maybe_unused]] const auto starts, writer.write("chunk_start", chunk_start));
  progress.stage("computing features", n);
  for (std::int64_t i = 0; i < n; ++i) {
    const auto& e = entries[static_cast<std::size_t>(i)];
    const std::int64_t num_mel = e.num_mel + options.look_ahead_mel_frames + 1;
    std::vector<float> mel(static_cast<std::size_t>(num_mel * dm::kMelBands), -14.0f);
    for (std::int64_t t = 0; t < e.num_mel; ++t)
      set.relative_mel(e.mel_start + t,
                       std::span(mel).subspan(static_cast<std::size_t>(t * dm::kMelBands), 64));
    for (float& v : mel) v = normalise_mel(v, 0.0f);
    const auto input = torch::from_blob(mel.data(), {1, num_mel, dm::kMelBands}).to(options.device);
    const auto features =
        network.encoder.encode_frames(interpolate_to_motion_rate(network.encoder.encode_mel(input, nullptr),
                                                                 e.num_frames, options.look_ahead_mel_frames),
                                      nullptr);
    // Chunk k, at frame 12 k, hears frames 12 k - 11 ... 12 k.
    const std::int64_t num_chunks = e.num_frames / dm::kChunkFrames;
    const auto padded = torch::cat(
        {torch::zeros({1, dm::kChunkFrames - 1, network.sizes.width}, features.options()), features}, 1);
    const auto speech = padded.narrow(1, 0, num_chunks * dm::kChunkFrames)
                            .reshape({num_chunks, dm::kContextGroups, dm::kChunkFrames / dm::kContextGroups,
                                      network.sizes.width})
                            .mean(2)
                            .reshape({num_chunks, speech_width})
                            .to(torch::kCPU)
                            .contiguous();
    MIEN_TRY(
        [[maybe_unused]] const auto wrote,
        writer.write_float("speech", {speech.data_ptr<float>(), static_cast<std::size_t>(speech.numel())}));
    Rng unused(0);
    for (std::int64_t k = 0; k < takes; ++k) {
      ConditionBatch condition(set, 0);
      condition.add(k, static_cast<std::size_t>(i), unused);
      const auto mean = network
                            .mean(features.narrow(1, 0, 1),
                                  network.mean.condition(condition.tensors(options.device)), nullptr)
                            .to(torch::kCPU)
                            .contiguous();
      MIEN_TRY(
          [[maybe_unused]] const auto wrote_mean,
          writer.write_float("first_mean", {mean.data_ptr<float>(), static_cast<std::size_t>(kNumFace)}));
    }
    progress.update(i + 1);
    if (progress.cancelled()) return Error{Errc::cancelled, "computing features", "interrupted", "Run again"};
  }
  return writer.finish();
}

Result<ChunkFeatures> ChunkFeatures::open(const std::filesystem::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  MIEN_TRY(const auto speech, file.as<std::uint16_t>("speech"));
  MIEN_TRY(auto first_mean, file.read_float("first_mean"));
  MIEN_TRY(const auto starts, file.as<std::int64_t>("chunk_start"));
  const auto shape = file.find("speech")->shape, mean_shape = file.find("first_mean")->shape;
  ChunkFeatures out;
  out.speech = torch::empty(shape, torch::kHalf);
  std::memcpy(out.speech.data_ptr(), speech.data(), speech.size_bytes());
  out.first_mean = torch::from_blob(first_mean.data(), mean_shape).clone();
  out.chunk_start.assign(starts.begin(), starts.end());
  return out;
}

}  // namespace mien::train

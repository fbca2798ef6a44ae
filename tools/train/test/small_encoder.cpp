#include "small_encoder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/models/model_file.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/plain_weights.h"
#include "small_encoder_config.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct ListShapes : ParameterVisitor<ListShapes> {
  void matrix(std::string_view name, PlainWeights&, std::int64_t out, std::int64_t in, Init) {
    tensors.push_back({full_name(name), Dtype::f32, {out, in}});
  }
  void convolution(std::string_view name, PlainWeights&, std::int64_t out, std::int64_t in,
                   std::int64_t kernel, Init) {
    tensors.push_back({full_name(name), Dtype::f32, {out, in, kernel}});
  }
  void tensor(std::string_view name, PlainWeights&, const Shape& shape, Init) {
    tensors.push_back({full_name(name), Dtype::f32, shape});
  }
  std::vector<StoredTensor> tensors;
};

}  // namespace

EncoderConfig small_encoder() { return small_encoder_config(3); }

void write_encoder(const fs::path& path) {
  SpeechEncoder<PlainWeights> encoder(small_encoder());
  ListShapes list;
  list.scope("audio_encoder", encoder);
  ModelFile description;
  description.architecture = Architecture::speech_encoder;
  description.name = "small";
  description.encoder = small_encoder();
  auto writer = SafetensorsWriter::create(path, list.tensors, to_metadata(description));
  ASSERT_TRUE(writer);
  Rng rng(5);
  for (const auto& t : list.tensors) {
    std::vector<float> values(static_cast<std::size_t>(t.count()));
    for (float& v : values) v = static_cast<float>(rng.normal(t.shape.size() == 1 ? 0.5 : 0, 0.2));
    ASSERT_TRUE(writer->write_float(t.name, values));
  }
  ASSERT_TRUE(writer->finish());
}

void write_coefficients(const fs::path& path, int num_frames, double rate) {
  const auto names = arkit_order(ArkitOrder::said);
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ",") + name;
  for (int n = 0; n < num_frames; ++n) {
    text += '\n';
    for (std::size_t k = 0; k < names.size(); ++k)
      text += (k == 0 ? "" : ",") + std::to_string(0.4 + 0.3 * std::sin(rate * n + static_cast<double>(k)));
  }
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, std::string_view(text + "\n")));
}

void write_wav(const fs::path& path, int num_samples) {
  std::string bytes;
  const auto number = [&](int value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  };
  bytes += "RIFF";
  number(36 + 2 * num_samples, 4);
  bytes += "WAVEfmt ";
  number(16, 4);
  number(1, 2);
  number(1, 2);
  number(16000, 4);
  number(32000, 4);
  number(2, 2);
  number(16, 2);
  bytes += "data";
  number(2 * num_samples, 4);
  for (int i = 0; i < num_samples; ++i)
    number(static_cast<int>(8000 * std::sin(0.1 * i) * std::sin(0.0007 * i)), 2);
  fs::create_directories(path.parent_path());
  ASSERT_TRUE(write_file(path, std::string_view(bytes)));
}

}  // namespace mien

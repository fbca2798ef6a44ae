#include "wav_source.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "mien/base/contract.h"

namespace mien {
namespace {

constexpr std::int64_t kBlockFrames = 4096;

// G.711 codes to 16-bit samples: sign, three bits of exponent, four bits of mantissa.
float from_mu_law(std::uint8_t code) {
  const int bits = 255 - code;
  const int magnitude = ((2 * (bits & 15) + 33) << ((bits >> 4) & 7)) - 33;
  return static_cast<float>((bits & 128) != 0 ? -magnitude : magnitude) / 8192.0f;
}
float from_a_law(std::uint8_t code) {
  const int bits = code ^ 0x55;
  const int exponent = (bits >> 4) & 7;
  const int mantissa = 2 * (bits & 15);
  const int magnitude = exponent == 0 ? mantissa + 1 : (mantissa + 33) << (exponent - 1);
  return static_cast<float>((bits & 128) != 0 ? magnitude : -magnitude) / 4096.0f;
}

template <class T>
T load(const std::byte* p) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return value;
}

float from_s24(const std::byte* p) {
  const auto byte = [&](int i) { return static_cast<std::uint32_t>(p[i]) << (8 * i + 8); };
  return static_cast<float>(static_cast<std::int32_t>(byte(0) | byte(1) | byte(2)) >> 8) / 8388608.0f;
}

template <class F>
void convert(const std::byte* bytes, std::size_t stride, std::span<float> out, F&& sample_at) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = sample_at(bytes + i * stride);
}

void decode(WavCoding coding, const std::byte* bytes, std::size_t stride, std::span<float> out) {
  static_assert(std::endian::native == std::endian::little, "big-endian hosts are not supported");
  using P = const std::byte*;
  switch (coding) {
    case WavCoding::pcm_u8:
      return convert(bytes, stride, out,
                     [](P p) { return (static_cast<float>(load<std::uint8_t>(p)) - 128) / 128; });
    case WavCoding::pcm_s16:
      return convert(bytes, stride, out,
                     [](P p) { return static_cast<float>(load<std::int16_t>(p)) / 32768.0f; });
    case WavCoding::pcm_s24:
      return convert(bytes, stride, out, from_s24);
    case WavCoding::pcm_s32:
      return convert(bytes, stride, out,
                     [](P p) { return static_cast<float>(load<std::int32_t>(p)) / 2147483648.0f; });
    case WavCoding::float32:
      return convert(bytes, stride, out, load<float>);
    case WavCoding::float64:
      return convert(bytes, stride, out, [](P p) { return static_cast<float>(load<double>(p)); });
    case WavCoding::a_law:
      return convert(bytes, stride, out, [](P p) { return from_a_law(load<std::uint8_t>(p)); });
    case WavCoding::mu_law:
      return convert(bytes, stride, out, [](P p) { return from_mu_law(load<std::uint8_t>(p)); });
    case WavCoding::other:
      break;
  }
  contract(false, "WavSource: not a plain coding");
}

class WavSource final : public SoundSource {
 public:
  WavSource(InputFile file, WavHeader header) : file_(std::move(file)), header_(std::move(header)) {
    const std::int64_t frame = static_cast<std::int64_t>(header_.num_channels) * header_.bytes_per_sample;
    left_ = header_.data_size / frame;
    info_ = {.format = "WAV, " + header_.coding_name,
             .sample_rate_hz = header_.sample_rate_hz,
             .num_channels = header_.num_channels,
             .seconds = static_cast<double>(left_) / header_.sample_rate_hz};
    warnings_ = header_.warnings;
    bytes_.resize(static_cast<std::size_t>(frame * std::min(left_, kBlockFrames)));
    file_.seek(header_.data_start);
  }

  Status read(SoundBlock& block) override {
    const std::size_t stride = static_cast<std::size_t>(header_.bytes_per_sample);
    const std::size_t frame = stride * static_cast<std::size_t>(header_.num_channels);
    const auto want = static_cast<std::size_t>(std::min(left_, kBlockFrames)) * frame;
    const std::size_t got = file_.read(std::span(bytes_).first(want));
    if (got < want) {
      warnings_.push_back("the file ended early: it became shorter or could not be read to its end");
      left_ = 0;
    } else {
      left_ -= static_cast<std::int64_t>(want / frame);
    }
    block.num_channels = header_.num_channels;
    block.samples.resize(got / frame * static_cast<std::size_t>(header_.num_channels));
    decode(header_.coding, bytes_.data(), stride, block.samples);
    return Done{};
  }

 private:
  InputFile file_;
  WavHeader header_;
  std::int64_t left_ = 0;  // frames
  std::vector<std::byte> bytes_;
};

}  // namespace

std::unique_ptr<SoundSource> make_wav_source(InputFile file, WavHeader header) {
  contract(header.coding != WavCoding::other, "make_wav_source: not a plain coding");
  return std::make_unique<WavSource>(std::move(file), std::move(header));
}

}  // namespace mien

#include "mien/models/model_file.h"
#include "mien/models/said/vae.h"

namespace mien::said {
namespace {

std::string conv_name(const char* part, std::size_t index) {
  return std::string(part) + ".conv_layers." + std::to_string(index) + ".weight";
}

}  // namespace

std::int64_t VaeSizes::encoded_frames() const {
  std::int64_t frames = window;
  for (std::size_t i = 0; i < encoder_convs.size(); ++i)
    frames = (frames - encoder_convs[i].kernel) / kEncoderSteps[i] + 1;
  return frames;
}

std::int64_t VaeSizes::seed_frames() const {
  return window - (decoder_convs[0].kernel - 1) - (decoder_convs[1].kernel - 1) +
         (decoder_convs[2].kernel - 1) + (decoder_convs[3].kernel - 1);
}

Result<VaeSizes> vae_sizes_of(const SafetensorsFile& file) { return vae_sizes_of(stored_shapes(file)); }

Result<VaeSizes> vae_sizes_of(const std::map<std::string, Shape>& shapes) {
  bool whole = true;
  // Size of an axis of a tensor of that rank; 0 and not whole when there is none.
  const auto size = [&](const std::string& name, std::size_t rank, std::size_t axis) -> std::int64_t {
    const auto stored = shapes.find(name);
    const bool fits = stored != shapes.end() && stored->second.size() == rank && stored->second[axis] > 0;
    whole = whole && fits;
    return fits ? stored->second[axis] : 0;
  };
  VaeSizes s;
  const auto conv = [&](const std::string& name, bool transposed) {
    return VaeConvSizes{size(name, 3, transposed ? 0 : 1), size(name, 3, transposed ? 1 : 0),
                        size(name, 3, 2)};
  };
  constexpr std::array<std::size_t, 4> kDecoderIndex = {0, 3, 6, 7};
  for (std::size_t i = 0; i < 4; ++i) {
    s.encoder_convs[i] = conv(conv_name("encoder", 3 * i), false);
    s.decoder_convs[i] = conv(conv_name("decoder", kDecoderIndex[i]), i < 2);
  }
  for (std::size_t i = 0; i < 3; ++i)
    s.encoder_widths[i] = size("encoder.fc_layers." + std::to_string(3 * i) + ".weight", 2, 0);
  s.latent = size("encoder.fc_mu.weight", 2, 0);
  s.decoder_width = size("decoder.fc_layers.0.weight", 2, 0);
  s.channels = s.encoder_convs[0].in;
  const std::int64_t seed = size("decoder.fc_layers.3.weight", 2, 0);
  if (!whole || seed % s.decoder_convs[0].in != 0)
    return Error{
        Errc::incompatible, "weights", "are not those of SAiD's motion codec",
        "Expected are encoder.conv_layers, encoder.fc_layers, decoder.fc_layers and decoder.conv_layers"};
  // Only the decoder's lengths tell the window without doubt: the encoder's step of 2 drops a frame.
  s.window = 0;
  s.window = seed / s.decoder_convs[0].in - s.seed_frames();
  const bool follows = s.window > 0 && s.encoded_frames() > 0 && s.decoder_convs[3].out == s.channels &&
                       size("encoder.fc_layers.0.weight", 2, 1) == s.flat_width();
  if (!follows)
    return Error{Errc::incompatible, "weights",
                 "are of a motion codec whose layers do not follow on each other: windows of " +
                     std::to_string(s.window) + " frames leave " + std::to_string(s.flat_width()) +
                     " numbers, the linear layers take " +
                     std::to_string(size("encoder.fc_layers.0.weight", 2, 1)),
                 "The file may be damaged"};
  return s;
}

}  // namespace mien::said

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/models/said/vae.h"
#include "mien/nn/runtime_operations.h"

namespace mien::said {
namespace {

constexpr std::int64_t kWindowsAtATime = 256;  // windows at a time: 2 MB of their flattened rows

}  // namespace

// Convolutions with step 1 give a window the same rows wherever it begins. Behind the one convolution with
// step 2, a window takes every second row from its start on; so that convolution runs with step 1 and the
// next with dilation 2.
Tensor window_features(const Vae<Tensor>& vae, const Tensor& coefficients, std::int64_t num_windows) {
  const VaeEncoder<Tensor>& encoder = vae.encoder;
  const VaeSizes& sizes = encoder.sizes;
  if (num_windows == 0) return Tensor({0, sizes.latent});
  contract(coefficients.width() == sizes.channels, "window_features: another number of coefficients");
  contract(num_windows > 0 && coefficients.num_rows() >= num_windows + sizes.window - 1,
           "window_features: the sequence is too short for its windows");

  const MeasuredStatistics<Tensor> norm;
  Tensor x = rows(coefficients, 0, num_windows + sizes.window - 1);
  std::int64_t spread = 1;
  for (std::size_t i = 0; i < encoder.convs.size(); ++i) {
    const auto& conv = encoder.convs[i];
    x = conv_rows(x, conv.weight, conv.bias, conv.size.kernel, spread);
    spread *= conv.step;
    if (i < encoder.conv_norms.size()) x = leaky_relu(norm(encoder.conv_norms[i], std::move(x)), kConvSlope);
  }

  const std::int64_t frames = sizes.encoded_frames(), channels = x.width();
  Tensor features = Tensor::uninitialized({num_windows, sizes.latent});
  for (std::int64_t first = 0; first < num_windows; first += kWindowsAtATime) {
    const std::int64_t count = std::min(kWindowsAtATime, num_windows - first);
    Tensor flat = Tensor::uninitialized({count, channels * frames});
    for (std::int64_t w = 0; w < count; ++w)
      for (std::int64_t n = 0; n < frames; ++n) {
        const auto row = x.row(first + w + spread * n);
        for (std::int64_t c = 0; c < channels; ++c)
          flat.data()[(w * channels + c) * frames + n] = row[static_cast<std::size_t>(c)];
      }
    const Tensor codes = encoder.mean(encoder.hidden(std::move(flat)));
    std::ranges::copy(codes.values(), features.data() + first * sizes.latent);
  }
  return features;
}

}  // namespace mien::said

#include "mien/metrics/regions.h"

#include "mien/base/contract.h"
#include "mien/core/arkit.h"
#include "mien/metrics/aperture.h"

namespace mien {
namespace {

std::vector<std::size_t> matching(auto&& belongs) {
  std::vector<std::size_t> out;
  const auto names = arkit_and_head_channels();
  for (std::size_t c = 0; c < names.size(); ++c)
    if (belongs(std::string_view(names[c]))) out.push_back(c);
  return out;
}

}  // namespace

std::string_view region_name(FaceRegion region) {
  switch (region) {
    case FaceRegion::lower:
      return "lower";
    case FaceRegion::upper:
      return "upper";
    case FaceRegion::gaze:
      return "gaze";
    case FaceRegion::head:
      return "head";
  }
  return "";
}

std::span<const std::size_t> region_channels(FaceRegion region) {
  static const std::vector<std::size_t> lower = matching([](std::string_view n) {
    return n.starts_with("jaw") || n.starts_with("mouth") || n.starts_with("tongue");
  });
  static const std::vector<std::size_t> upper = matching([](std::string_view n) {
    return n.starts_with("brow") || n.starts_with("eyeBlink") || n.starts_with("eyeSquint") ||
           n.starts_with("eyeWide");
  });
  static const std::vector<std::size_t> gaze =
      matching([](std::string_view n) { return n.starts_with("eyeLook"); });
  static const std::vector<std::size_t> head =
      matching([](std::string_view n) { return n.starts_with("head"); });
  switch (region) {
    case FaceRegion::lower:
      return lower;
    case FaceRegion::upper:
      return upper;
    case FaceRegion::gaze:
      return gaze;
    case FaceRegion::head:
      return head;
  }
  return {};
}

void require_performance(const Motion& motion) {
  static const std::vector<std::string> channels = arkit_and_head_channels();
  contract(motion.fps == kMetricFps, "metrics: performances are measured at 60 frames/s");
  contract(motion.channels == channels,
           "metrics: performances need the 52 ARKit and 3 head channels in order");
}

Motion mean_motion(std::span<const Motion> motions) {
  contract(!motions.empty(), "mean_motion: nothing to average");
  Motion out = motions.front();
  std::vector<double> sum(out.values.size(), 0.0);
  for (const Motion& motion : motions) {
    contract(motion.values.size() == sum.size() && motion.channels.size() == out.channels.size(),
             "mean_motion: the motions differ in shape");
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += motion.values[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    out.values[i] = static_cast<float>(sum[i] / static_cast<double>(motions.size()));
  return out;
}

std::vector<double> channel_values(const Motion& motion, std::size_t channel) {
  contract(channel < motion.channels.size(), "channel_values: no such channel");
  std::vector<double> out(static_cast<std::size_t>(motion.num_frames()));
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = motion.values[n * motion.channels.size() + channel];
  return out;
}

}  // namespace mien

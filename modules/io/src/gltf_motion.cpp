#include <algorithm>
#include <cmath>
#include <map>

#include "even_motion.h"
#include "gltf_accessor.h"
#include "gltf_nodes.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/io/gltf_animation.h"
#include "shape_names.h"

namespace mien {
namespace {

using namespace io;

enum class Interpolation { linear, step, cubic };

// Keys of one channel: values [keys, width], or [keys, 3, width] (in-tangent, value, out-tangent) for cubic
// curves.
struct Curve {
  std::vector<double> times;
  std::vector<float> values;
  std::size_t width = 0;
  Interpolation interpolation = Interpolation::linear;

  // Number `c` at `time`; the end values hold (glTF 2.0, appendix C).
  [[nodiscard]] double sample(const KeyPosition& at, std::size_t c) const {
    const auto value = [&](std::size_t key) {
      return static_cast<double>(interpolation == Interpolation::cubic ? values[(key * 3 + 1) * width + c]
                                                                       : values[key * width + c]);
    };
    if (at.weight == 0 || interpolation == Interpolation::step) return value(at.key);
    const double a = value(at.key), b = value(at.key + 1), s = at.weight;
    if (interpolation == Interpolation::linear) return a + s * (b - a);
    const double span = times[at.key + 1] - times[at.key];
    const double out_tangent = span * values[(at.key * 3 + 2) * width + c];
    const double in_tangent = span * values[(at.key * 3 + 3) * width + c];
    const double s2 = s * s, s3 = s2 * s;
    return (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * out_tangent + (3 * s2 - 2 * s3) * b +
           (s3 - s2) * in_tangent;
  }
};

Result<Curve> read_curve(const GltfDocument& document, const Json& animation, const Json& channel,
                         const char* path, std::size_t width) {
  const Json& samplers = array_member(animation, "samplers");
  const auto index = index_member(channel, "sampler");
  const std::string what = std::string("glTF animation, channel '") + path + "'";
  if (!index || *index >= samplers.size()) return Error{Errc::input, what, "it names no sampler", ""};
  const Json& sampler = samplers[*index];
  const auto input = index_member(sampler, "input"), output = index_member(sampler, "output");
  if (!input || !output) return Error{Errc::input, what, "its sampler names no data", ""};

  Curve curve;
  curve.width = width;
  const std::string interpolation = text_member(sampler, "interpolation");
  if (interpolation == "STEP") curve.interpolation = Interpolation::step;
  if (interpolation == "CUBICSPLINE") curve.interpolation = Interpolation::cubic;
  MIEN_TRY(const auto times, read_floats(document, *input, 1));
  curve.times.assign(times.begin(), times.end());
  for (std::size_t k = 0; k < times.size(); ++k)
    if (times[k] < 0 || (k > 0 && times[k] <= times[k - 1]))
      return Error{Errc::input, what, "its key times do not rise", ""};

  const std::size_t per_key = width * (curve.interpolation == Interpolation::cubic ? 3 : 1);
  const bool is_rotation = std::string_view(path) == "rotation";
  const auto expected = checked_multiply(times.size(), is_rotation ? per_key / 4 : per_key);
  if (!expected) return Error{Errc::input, what, "it has too many keys", ""};
  MIEN_TRY(curve.values, read_floats(document, *output, is_rotation ? 4 : 1, *expected));
  return curve;
}

const Json* find_animation(const GltfDocument& document) {
  const Json* chosen = nullptr;
  for (const Json& animation : array_member(document.json, "animations")) {
    const bool has_weights = std::any_of(
        array_member(animation, "channels").begin(), array_member(animation, "channels").end(),
        [](const Json& channel) { return text_member(member(channel, "target"), "path") == "weights"; });
    const bool is_ours = number_member(member(animation, "extras"), "fps").has_value();
    if (has_weights && (chosen == nullptr || is_ours)) chosen = &animation;
  }
  return chosen;
}

// Where a channel of the motion comes from.
struct Source {
  std::size_t curve = 0, target = 0;
};

struct Curves {
  std::vector<Curve> all;
  std::map<std::string, Source> by_name;
  std::optional<std::size_t> head;
  Quaternion head_parent = kNoRotation, head_rest = kNoRotation;
};

Result<Curves> read_curves(const GltfDocument& document, const Json& animation) {
  MIEN_TRY(const NodeTree tree, read_nodes(document));
  const Json& nodes = array_member(document.json, "nodes");
  const Json& meshes = array_member(document.json, "meshes");
  Curves curves;
  std::vector<std::size_t> face_nodes;
  for (const Json& channel : array_member(animation, "channels")) {
    const Json& target = member(channel, "target");
    const auto node = index_member(target, "node");
    if (text_member(target, "path") != "weights" || !node) continue;
    const auto mesh = *node < nodes.size() ? index_member(nodes[*node], "mesh") : std::nullopt;
    if (!mesh || *mesh >= meshes.size())
      return Error{Errc::input, "glTF animation", "it moves the weights of a node without a mesh", ""};
    const auto names = target_names(document, meshes[*mesh]);
    const auto matched = arkit_of(names);
    bool is_new = false;
    for (std::size_t t = 0; t < names.size(); ++t)
      if (matched[t] && curves.by_name.try_emplace(*matched[t], Source{curves.all.size(), t}).second)
        is_new = true;
    face_nodes.push_back(*node);
    if (!is_new) continue;
    MIEN_TRY(auto curve, read_curve(document, animation, channel, "weights", names.size()));
    curves.all.push_back(std::move(curve));
  }

  const auto head = find_head_node(document, tree, face_nodes);
  if (!head) return curves;
  for (const Json& channel : array_member(animation, "channels")) {
    const Json& target = member(channel, "target");
    if (text_member(target, "path") != "rotation" || index_member(target, "node") != head) continue;
    MIEN_TRY(auto curve, read_curve(document, animation, channel, "rotation", 4));
    curves.head = curves.all.size();
    curves.all.push_back(std::move(curve));
    curves.head_rest = node_placement(nodes[*head]).value_or(Placement{}).rotation;
    curves.head_parent = normalised(multiply(tree.world_rotation[*head], conjugate(curves.head_rest)));
    break;
  }
  return curves;
}

double rate_of(const Json& animation, const std::vector<double>& times) {
  const auto stated = number_member(member(animation, "extras"), "fps");
  if (stated && is_frame_rate(*stated)) return *stated;
  if (times.size() < 2) return 60;
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (std::size_t k = 0; k < times.size(); ++k)
    if (std::abs(times.front() + step * static_cast<double>(k) - times[k]) > 0.05 * step) return 60;
  const double rate = 1.0 / step;
  if (!is_frame_rate(rate)) return 60;
  return std::abs(rate - std::round(rate)) < 1e-3 * rate ? std::max(1.0, std::round(rate)) : rate;
}

Result<Motion> motion_of(const GltfDocument& document) {
  const Json* animation = find_animation(document);
  if (animation == nullptr)
    return Error{Errc::incompatible, "glTF", "no animation moves morph targets",
                 "Is this the character alone?"};
  MIEN_TRY(const Curves curves, read_curves(document, *animation));
  if (curves.by_name.empty())
    return Error{Errc::incompatible, "glTF", "its animation moves no morph target with an ARKit name", ""};

  Motion motion;
  motion.fps = rate_of(*animation, curves.all[curves.by_name.begin()->second.curve].times);
  std::vector<Source> sources;
  for (const auto name : arkit_names())
    if (const auto found = curves.by_name.find(std::string(name)); found != curves.by_name.end()) {
      motion.channels.push_back(found->first);
      sources.push_back(found->second);
    }
  if (curves.head)
    for (const auto name : head_names()) motion.channels.emplace_back(name);

  double last = 0;
  std::size_t num_keys = 0;
  for (const Curve& curve : curves.all) {
    last = std::max(last, curve.times.back());
    num_keys = std::max(num_keys, curve.times.size());
  }
  MIEN_TRY(const std::int64_t num_frames, num_even_frames(last, motion.fps, num_keys));
  motion.values.resize(static_cast<std::size_t>(num_frames) * motion.channels.size());
  std::vector<KeyPosition> at(curves.all.size());
  for (std::int64_t n = 0; n < num_frames; ++n) {
    for (std::size_t k = 0; k < at.size(); ++k)
      at[k] = find_key(curves.all[k].times, static_cast<double>(n) / motion.fps, kSnapFrames / motion.fps);
    const auto out = motion.frame(n);
    for (std::size_t c = 0; c < sources.size(); ++c)
      out[c] =
          static_cast<float>(curves.all[sources[c].curve].sample(at[sources[c].curve], sources[c].target));
    if (!curves.head) continue;
    Quaternion q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = curves.all[*curves.head].sample(at[*curves.head], i);
    const Quaternion turn = multiply(normalised(q), conjugate(curves.head_rest));
    const auto angles =
        head_angles(multiply(curves.head_parent, multiply(turn, conjugate(curves.head_parent))));
    for (std::size_t k = 0; k < 3; ++k) out[sources.size() + k] = static_cast<float>(angles[k]);
  }
  // The keys are finite; cubic curves between them need not be.
  if (!std::all_of(motion.values.begin(), motion.values.end(), [](float v) { return std::isfinite(v); }))
    return Error{Errc::input, "glTF animation", "its curves leave the range of numbers", ""};
  return motion;
}

}  // namespace

Result<Motion> read_glb_motion(std::span<const std::byte> glb) {
  MIEN_TRY(const GltfDocument document, parse_gltf(glb));
  return motion_of(document);
}

Result<Motion> read_glb_motion(const std::filesystem::path& path) {
  MIEN_TRY(const Bytes bytes, read_file(path));
  const auto folder = path.parent_path();
  MIEN_TRY(const GltfDocument document, parse_gltf(bytes, &folder));
  return motion_of(document);
}

}  // namespace mien

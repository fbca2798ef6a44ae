#include "mien/io/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base64.h"
#include "even_motion.h"
#include "glb_container.h"
#include "gltf_component_type.h"
#include "gltf_nodes.h"
#include "mien/core/arkit.h"
#include "read_budget.h"
#include "shape_names.h"

namespace mien {
namespace {

using namespace io;

constexpr std::size_t kMaxBlock = 0xC0000000;  // bytes; leaves room for the character in the format's 4 GiB

// One set of weights: what drives each target of a mesh. Nodes with the same set share their data.
struct WeightTrack {
  std::vector<std::optional<std::size_t>> columns;  // [targets] channel of the motion
  std::vector<float> defaults;                      // [targets]
  std::vector<std::size_t> nodes;
};

struct Plan {
  std::vector<WeightTrack> tracks;
  std::optional<std::size_t> head_node;
  Placement head;                        // of the head node at rest
  Quaternion head_parent = kNoRotation;  // from the space of its parent to the axes of the character
  std::array<std::optional<std::size_t>, 3> head_columns;  // yaw, pitch, roll
  std::vector<std::string> warnings;
};

// Exact name first, then what both sides call by the same ARKit name.
std::optional<std::size_t> column_of(const Motion& motion, const std::string& target,
                                     const std::optional<std::string>& arkit) {
  if (const auto exact = motion.find(target)) return static_cast<std::size_t>(*exact);
  if (!arkit) return std::nullopt;
  if (const auto same = motion.find(*arkit)) return static_cast<std::size_t>(*same);
  for (std::size_t c = 0; c < motion.channels.size(); ++c)
    if (match_arkit_name(motion.channels[c]) == *arkit) return c;
  return std::nullopt;
}

WeightTrack make_track(const GltfDocument& document, const Json& node, const Json& mesh, const Motion& motion,
                       std::set<std::string>& still) {
  const auto names = target_names(document, mesh);
  const auto matched = arkit_of(names);
  const Json& own = array_member(node, "weights");
  const Json& weights = own.size() == names.size() ? own : array_member(mesh, "weights");
  WeightTrack track;
  for (std::size_t t = 0; t < names.size(); ++t) {
    track.columns.push_back(column_of(motion, names[t], matched[t]));
    track.defaults.push_back(t < weights.size() && weights[t].is_number() ? weights[t].get<float>() : 0.0f);
    if (!track.columns.back()) still.insert(names[t]);
  }
  return track;
}

Result<Plan> make_plan(const GltfDocument& document, const Motion& motion) {
  MIEN_TRY(const NodeTree tree, read_nodes(document));
  const Json& nodes = array_member(document.json, "nodes");
  const Json& meshes = array_member(document.json, "meshes");
  Plan plan;
  std::vector<std::size_t> face_nodes;
  std::set<std::string> still;
  std::set<std::size_t> used;
  ReadBudget budget;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto mesh = index_member(nodes[i], "mesh");
    if (!mesh) continue;
    if (*mesh >= meshes.size())
      return Error{Errc::input, "glTF", "a node names a mesh that does not exist", ""};
    MIEN_TRY([[maybe_unused]] const auto paid, budget.spend(num_targets(meshes[*mesh])));
    WeightTrack track = make_track(document, nodes[i], meshes[*mesh], motion, still);
    bool driven = false;
    for (const auto column : track.columns)
      if (column) used.insert(*column), driven = true;
    if (!driven) continue;
    face_nodes.push_back(i);
    const auto same = std::find_if(plan.tracks.begin(), plan.tracks.end(), [&](const WeightTrack& t) {
      return t.columns == track.columns && t.defaults == track.defaults;
    });
    if (same != plan.tracks.end()) {
      same->nodes.push_back(i);
    } else {
      track.nodes = {i};
      plan.tracks.push_back(std::move(track));
    }
  }
  if (plan.tracks.empty())
    return Error{Errc::incompatible, "glTF", "no morph target matches a channel of the motion",
                 "The character needs morph targets with ARKit names such as jawOpen"};

  bool has_head = false;
  for (std::size_t k = 0; k < 3; ++k)
    if (const auto column = motion.find(head_names()[k])) {
      plan.head_columns[k] = static_cast<std::size_t>(*column);
      used.insert(*plan.head_columns[k]);
      has_head = true;
    }
  if (has_head) plan.head_node = find_head_node(document, tree, face_nodes);
  if (plan.head_node) {
    plan.head = node_placement(nodes[*plan.head_node]).value_or(Placement{});
    plan.head_parent =
        normalised(multiply(tree.world_rotation[*plan.head_node], conjugate(plan.head.rotation)));
  }
  if (has_head && !plan.head_node)
    plan.warnings.emplace_back("the character has no head node or joint: head angles are left out");

  std::vector<std::string> unheard;
  for (std::size_t c = 0; c < motion.channels.size(); ++c)
    if (!used.contains(c)) unheard.push_back(motion.channels[c]);
  if (!unheard.empty()) plan.warnings.push_back("channels without a morph target: " + listed(unheard));
  if (!still.empty())
    plan.warnings.push_back("morph targets that the motion does not drive: " +
                            listed({still.begin(), still.end()}));
  return plan;
}

// The new data: where each piece lies, from the start of the new block.
struct Block {
  std::size_t size = 0;
  std::size_t reserve(std::size_t bytes) {
    const std::size_t offset = size;
    size += (bytes + 3) / 4 * 4;
    return offset;
  }
};

void put(std::span<std::byte> out, std::size_t& at, float value) {
  std::memcpy(&out[at], &value, sizeof value);
  at += sizeof value;
}

void fill_times(std::span<std::byte> out, const Motion& motion) {
  std::size_t at = 0;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n)
    put(out, at, static_cast<float>(static_cast<double>(n) / motion.fps));
}

void fill_weights(std::span<std::byte> out, const Motion& motion, const WeightTrack& track, bool quantised) {
  std::size_t at = 0;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    const auto frame = motion.frame(n);
    for (std::size_t t = 0; t < track.columns.size(); ++t) {
      const float value = track.columns[t] ? frame[*track.columns[t]] : track.defaults[t];
      if (!quantised) {
        put(out, at, value);
        continue;
      }
      const auto packed = static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(value, 0.0f, 1.0f)));
      std::memcpy(&out[at], &packed, sizeof packed);
      at += sizeof packed;
    }
  }
}

void fill_rotations(std::span<std::byte> out, const Motion& motion, const Plan& plan) {
  std::size_t at = 0;
  Quaternion last = plan.head.rotation;
  for (std::int64_t n = 0; n < motion.num_frames(); ++n) {
    const auto frame = motion.frame(n);
    std::array<double, 3> angles{};
    for (std::size_t k = 0; k < 3; ++k)
      if (plan.head_columns[k]) angles[k] = frame[*plan.head_columns[k]];
    // The turn is meant in the axes of the character: carry it into the frame of the node's parent.
    const Quaternion turn = head_rotation(angles[0], angles[1], angles[2]);
    const Quaternion local = multiply(conjugate(plan.head_parent), multiply(turn, plan.head_parent));
    Quaternion q = normalised(multiply(local, plan.head.rotation));
    double same_side = 0;
    for (std::size_t i = 0; i < 4; ++i) same_side += q[i] * last[i];
    if (same_side < 0)
      for (double& component : q) component = -component;  // the short way round between keys
    last = q;
    for (const double component : q) put(out, at, static_cast<float>(component));
  }
}

// What the animation will be added to must have the right kind.
Status check_lists(const Json& json) {
  for (const char* key : {"buffers", "bufferViews", "accessors", "animations", "nodes", "meshes"})
    if (json.contains(key) && !json[key].is_array())
      return Error{Errc::input, "glTF", std::string("'") + key + "' is not a list", ""};
  for (const Json& buffer : array_member(json, "buffers"))
    if (!buffer.is_object()) return Error{Errc::input, "glTF", "a buffer is not described by an object", ""};
  return Done{};
}

// Adds views, accessors and the animation to a document, with all data in one block of one buffer.
class AnimationEntry {
 public:
  AnimationEntry(Json& json, std::size_t buffer, std::size_t block_start)
      : json_(json), buffer_(buffer), block_start_(block_start) {}

  std::size_t add_accessor(std::size_t offset, std::size_t size, Json accessor) {
    json_["bufferViews"].push_back(
        {{"buffer", buffer_}, {"byteOffset", block_start_ + offset}, {"byteLength", size}});
    accessor["bufferView"] = json_["bufferViews"].size() - 1;
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }
  std::size_t add_sampler(std::size_t input, std::size_t output) {
    animation_["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    return animation_["samplers"].size() - 1;
  }
  void add_channel(std::size_t sampler, std::size_t node, const char* path) {
    animation_["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
  }
  void finish(const std::string& name, std::string_view audio_name, double fps) {
    animation_["name"] = name;
    animation_["extras"]["fps"] = fps;
    if (!audio_name.empty()) animation_["extras"]["audio"] = std::string(audio_name);
    json_["animations"].push_back(std::move(animation_));
  }

 private:
  Json& json_;
  std::size_t buffer_, block_start_;
  Json animation_;
};

// Animation targets may not have a matrix: write it as translation, rotation and scale.
void take_matrix_apart(Json& node, const Placement& placement) {
  if (!node.contains("matrix")) return;
  node.erase("matrix");
  node["translation"] = placement.translation;
  node["rotation"] = placement.rotation;
  node["scale"] = placement.scale;
}

bool refers_to_files(const Json& json) {
  for (const char* list : {"buffers", "images"})
    for (const Json& entry : array_member(json, list)) {
      const std::string uri = text_member(entry, "uri");
      if (!uri.empty() && !uri.starts_with("data:")) return true;
    }
  return false;
}

}  // namespace

Result<Bytes> animate_glb(std::span<const std::byte> glb, const Motion& motion, std::string_view audio_name,
                          const GlbAnimationOptions& options) {
  if (motion.space != MotionSpace::arkit && motion.space != MotionSpace::rig)
    return Error{Errc::incompatible, "motion", "it holds no coefficients that morph targets could follow",
                 ""};
  if (motion.num_frames() == 0) return Error{Errc::input, "motion", "it has no frames", ""};
  MIEN_TRY([[maybe_unused]] const auto checked, check_motion(motion, "glTF animation"));
  MIEN_TRY(GltfDocument document, parse_gltf(glb, nullptr, false));
  Json& json = document.json;
  MIEN_TRY([[maybe_unused]] const auto lists, check_lists(json));
  MIEN_TRY(const Plan plan, make_plan(document, motion));

  const auto num_frames = static_cast<std::size_t>(motion.num_frames());
  const std::size_t weight_size = options.quantised ? sizeof(std::uint16_t) : sizeof(float);
  Block block;
  const std::size_t times_offset = block.reserve(num_frames * sizeof(float));
  std::vector<std::size_t> track_offsets;
  for (const WeightTrack& track : plan.tracks)
    track_offsets.push_back(block.reserve(num_frames * track.columns.size() * weight_size));
  const std::size_t head_offset = plan.head_node ? block.reserve(num_frames * 4 * sizeof(float)) : 0;
  if (block.size > kMaxBlock)
    return Error{Errc::failed, "glTF animation", "it would take " + std::to_string(block.size >> 20) + " MiB",
                 "Animate a shorter recording or ask for quantised weights"};

  // The block goes behind the BIN chunk when buffer 0 is that chunk, into a new BIN chunk when there are no
  // buffers, else into a data URI: only the first buffer may be the BIN chunk.
  const bool in_bin = document.has_bin || array_member(json, "buffers").empty();
  const std::size_t block_start = document.has_bin ? (document.bin.size() + 3) / 4 * 4 : 0;
  const std::size_t buffer = in_bin ? 0 : json["buffers"].size();
  if (!document.has_bin) json["buffers"].push_back(Json::object());
  json["buffers"][buffer]["byteLength"] = block_start + block.size;

  AnimationEntry entry(json, buffer, block_start);
  const double last = static_cast<float>(static_cast<double>(num_frames - 1) / motion.fps);
  const std::size_t input = entry.add_accessor(times_offset, num_frames * sizeof(float),
                                               {{"componentType", kFloat},
                                                {"type", "SCALAR"},
                                                {"count", num_frames},
                                                {"min", {0.0}},
                                                {"max", {last}}});
  for (std::size_t k = 0; k < plan.tracks.size(); ++k) {
    const std::size_t count = num_frames * plan.tracks[k].columns.size();
    Json accessor = {
        {"componentType", options.quantised ? kUnsignedShort : kFloat}, {"type", "SCALAR"}, {"count", count}};
    if (options.quantised) accessor["normalized"] = true;
    const std::size_t output = entry.add_accessor(track_offsets[k], count * weight_size, std::move(accessor));
    const std::size_t sampler = entry.add_sampler(input, output);
    for (const std::size_t node : plan.tracks[k].nodes) entry.add_channel(sampler, node, "weights");
  }
  if (plan.head_node) {
    take_matrix_apart(json["nodes"][*plan.head_node], plan.head);
    const std::size_t output =
        entry.add_accessor(head_offset, num_frames * 4 * sizeof(float),
                           {{"componentType", kFloat}, {"type", "VEC4"}, {"count", num_frames}});
    entry.add_channel(entry.add_sampler(input, output), *plan.head_node, "rotation");
  }
  entry.finish(options.name, audio_name, motion.fps);

  const auto fill = [&](std::span<std::byte> out) {
    fill_times(out.subspan(times_offset), motion);
    for (std::size_t k = 0; k < plan.tracks.size(); ++k)
      fill_weights(out.subspan(track_offsets[k]), motion, plan.tracks[k], options.quantised);
    if (plan.head_node) fill_rotations(out.subspan(head_offset), motion, plan);
  };
  if (!in_bin) {
    Bytes data(block.size);
    fill(data);
    json["buffers"][buffer]["uri"] = "data:application/octet-stream;base64," + base64_encode(data);
  }
  MIEN_TRY(GlbDraft draft, assemble_glb(json_text(json), in_bin ? block_start + block.size : 0));
  if (in_bin) {
    const auto out = std::span(draft.bytes).subspan(draft.bin_start);
    if (document.has_bin) std::copy(document.bin.begin(), document.bin.end(), out.begin());
    fill(out.subspan(block_start));
  }
  Result<Bytes> result(std::move(draft.bytes));
  result.warnings = plan.warnings;
  if (refers_to_files(json))
    result.warnings.emplace_back("the character refers to other files: keep them beside it");
  return result;
}

}  // namespace mien

#include "mien/face/pose.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mien/base/contract.h"
#include "mien/core/arkit.h"

namespace mien {
namespace {

struct Quaternion {
  double x, y, z, w;
};

Quaternion quaternion_product(Quaternion a, Quaternion b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Quaternion unit_quaternion(const HeadAngles& angles) {
  constexpr double kHalfRadian = std::numbers::pi / 360;
  const double yaw = angles.yaw_deg * kHalfRadian, pitch = -angles.pitch_deg * kHalfRadian;
  const double roll = angles.roll_deg * kHalfRadian;
  const Quaternion q = quaternion_product(
      quaternion_product({0, std::sin(yaw), 0, std::cos(yaw)}, {std::sin(pitch), 0, 0, std::cos(pitch)}),
      {0, 0, std::sin(roll), std::cos(roll)});
  return q.w < 0 ? Quaternion{-q.x, -q.y, -q.z, -q.w} : q;
}

// The ARKit name behind a spelling, or the spelling itself.
std::string plain_name(const std::string& name) {
  const auto known = match_arkit_name(name);
  return known ? std::string(*known) : name;
}

float finite(float value) { return std::isfinite(value) ? value : 0.0f; }

}  // namespace

std::array<float, 4> head_quaternion(const HeadAngles& angles) {
  const Quaternion q = unit_quaternion(angles);
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}

Rotation head_rotation(const HeadAngles& angles) {
  const auto [x, y, z, w] = unit_quaternion(angles);
  const auto row = [](double a, double b, double c) {
    return Vec3{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
  };
  return {{row(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
           row(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
           row(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))}};
}

Vec3 neck_pivot(const Character& character) {
  constexpr float kHeight = 0.30f, kDepth = 0.45f;
  if (character.parts.empty() || character.parts.front().mesh.positions.empty()) return {};
  const auto& positions = character.parts.front().mesh.positions;
  Vec3 low = positions.front(), high = low;
  for (const Vec3& p : positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {0.5f * (low.x + high.x), low.y + kHeight * (high.y - low.y), low.z + kDepth * (high.z - low.z)};
}

Poser::Poser(const Character& character, std::span<const std::string> channels, std::optional<Vec3> pivot)
    : character_(&character), num_channels_(channels.size()), pivot_(pivot.value_or(neck_pivot(character))) {
  struct Place {
    std::size_t part, shape;
  };
  std::multimap<std::string, Place> shapes_by_name;
  for (std::size_t p = 0; p < character.parts.size(); ++p)
    for (std::size_t k = 0; k < character.parts[p].shapes.size(); ++k)
      shapes_by_name.emplace(plain_name(character.parts[p].shapes[k].name), Place{p, k});
  for (std::size_t c = 0; c < channels.size(); ++c) {
    bool used = false;
    for (std::size_t angle = 0; angle < head_.size(); ++angle)
      if (channels[c] == head_names()[angle]) head_[angle] = c, used = true;
    const auto [first, last] = shapes_by_name.equal_range(plain_name(channels[c]));
    for (auto use = first; use != last; ++use) uses_.push_back({c, use->second.part, use->second.shape});
    used = used || first != last;
    if (!used) unused_.push_back(channels[c]);
  }
}

void Poser::pose(std::span<const float> frame, PosedCharacter& out) const {
  contract(frame.size() == num_channels_, "Poser: one value per channel expected");
  const auto& parts = character_->parts;
  out.resize(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) out[p].positions = parts[p].mesh.positions;
  std::vector<bool> moved(parts.size(), false);
  for (const Use& use : uses_) {
    const float coefficient = finite(frame[use.channel]);
    const Blendshape& shape = parts[use.part].shapes[use.shape];
    if (coefficient == 0.0f || shape.vertices.empty()) continue;
    moved[use.part] = true;
    for (std::size_t i = 0; i < shape.vertices.size(); ++i)
      out[use.part].positions[shape.vertices[i]] += coefficient * shape.offsets[i];
  }
  const auto angle = [&](std::size_t i) { return head_[i] ? finite(frame[*head_[i]]) : 0.0f; };
  const HeadAngles angles{angle(0), angle(1), angle(2)};
  const bool turned = angles.yaw_deg != 0 || angles.pitch_deg != 0 || angles.roll_deg != 0;
  const Rotation rotation = head_rotation(angles);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Mesh& mesh = parts[p].mesh;
    const bool reuse = !moved[p] && mesh.normals.size() == mesh.positions.size();
    out[p].normals = reuse ? mesh.normals : vertex_normals(out[p].positions, mesh.triangles);
    if (!turned) continue;
    for (Vec3& v : out[p].positions) v = rotation(v - pivot_) + pivot_;
    for (Vec3& n : out[p].normals) n = rotation(n);
  }
}

PosedCharacter rest_pose(const Character& character) {
  PosedCharacter out;
  Poser(character, {}).pose({}, out);
  return out;
}

}  // namespace mien

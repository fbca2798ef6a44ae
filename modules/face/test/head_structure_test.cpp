// What makes the head usable: closed surfaces, exact symmetry, sealed lips, lids that slide over the eyeball.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "built_head.h"
#include "head/head_skin.h"
#include "head/skin_surface.h"

namespace mien {
namespace {

using head::HeadSkin;
using head::MouthLoop;
using head::Offsets;
using head::Vec3d;
using test::built_model;
using test::skin_shape;
using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

const HeadSkin& skin() { return built_model().skin; }

double twice_area(const std::vector<Vec3d>& p, const head::Triangle& t) {
  return length(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
}

// Edges that one triangle uses in one direction and no other in the opposite one.
std::vector<DirectedEdge> border_edges(const std::vector<head::Triangle>& triangles) {
  std::set<DirectedEdge> edges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second) << "edge " << t[k] << " " << t[(k + 1) % 3];
  std::vector<DirectedEdge> border;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) border.emplace_back(a, b);
  return border;
}

TEST(HeadStructure, SkinIsClosedExceptForNeckAndEyes) {
  const auto border = border_edges(skin().triangles);
  std::size_t neck = 0, eyes = 0;
  for (const auto& [a, b] : border) {
    const auto& rings = skin().eyes;
    for (const auto& eye : rings)
      for (const auto v : eye.rings.back()) eyes += v == a;
    neck += a < skin().chart.size() && skin().chart[a].station == 0;
  }
  EXPECT_EQ(border.size(), 144U);
  EXPECT_EQ(neck, 88U);
  EXPECT_EQ(eyes, 56U);
  double least = 1;
  for (const auto& t : skin().triangles) least = std::min(least, twice_area(skin().positions, t));
  EXPECT_GT(least, 1e-6);  // cm^2: no triangle without area
}

TEST(HeadStructure, OtherPartsUseNoEdgeTwice) {
  for (const auto& part : built_model().parts) {
    SCOPED_TRACE(part.name);
    border_edges(part.mesh.triangles);
    for (const auto& t : part.mesh.triangles) EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    EXPECT_EQ(part.mesh.colors.size(), part.mesh.positions.size());
  }
}

TEST(HeadStructure, EveryPartFacesOutwards) {
  // Signed volume of each triangle with the part's middle: the sum is positive for a sheet that bulges
  // outwards.
  for (const auto& part : built_model().parts) {
    if (part.name.starts_with("teeth") || part.name.starts_with("lashes")) continue;  // strips with two sides
    Vec3d middle;
    for (const Vec3d& p : part.mesh.positions)
      middle += (1.0 / static_cast<double>(part.mesh.positions.size())) * p;
    if (part.name.starts_with("eyeCorners"))
      middle = {middle.x, middle.y, 0};
    else if (part.name.starts_with("eye"))
      middle = {middle.x, head::kEyeCentre.y, head::kEyeCentre.z};
    if (part.name.starts_with("brow") || part.name.starts_with("ear")) middle = {};  // shells on the head
    double volume = 0;
    for (const auto& [a, b, c] : part.mesh.triangles) {
      const auto& p = part.mesh.positions;
      volume += dot(p[a] - middle, cross(p[b] - middle, p[c] - middle));
    }
    EXPECT_GT(volume, 0) << part.name;
  }
}

TEST(HeadStructure, NeutralAndShapesAreMirrorSymmetric) {
  const auto& mirror = skin().mirror;
  for (std::uint32_t v = 0; v < mirror.size(); ++v) {
    ASSERT_EQ(mirror[mirror[v]], v);
    ASSERT_LT(length(mirrored(skin().positions[v]) - skin().positions[mirror[v]]), 1e-9) << v;
  }
  for (const auto name : arkit_names()) {
    std::string other(name);
    if (const auto left = other.rfind("Left"); left != std::string::npos) other.replace(left, 4, "Right");
    const Offsets &a = skin_shape(name), &b = skin_shape(other);
    if (std::string(name).ends_with("Right")) continue;  // compared from the left
    double worst = 0;
    for (std::uint32_t v = 0; v < mirror.size(); ++v)
      worst = std::max(worst, length(mirrored(a[v]) - b[mirror[v]]));
    EXPECT_LT(worst, 1e-9) << name;
  }
}

TEST(HeadStructure, MirrorKeepsUpperAndLowerLipApart) {
  const MouthLoop& mouth = skin().mouth;
  for (const auto& ring : mouth.rings)
    for (std::size_t m = 0; m < ring.size(); ++m) {
      const auto other = static_cast<std::size_t>(
          std::find(ring.begin(), ring.end(), skin().mirror[ring[m]]) - ring.begin());
      ASSERT_LT(other, ring.size());
      EXPECT_EQ(mouth.upper[other], mouth.upper[m]);
      EXPECT_EQ(mouth.along[other], -mouth.along[m]);
    }
}

// Largest distance between contact vertices of one pair under the sum of two shapes.
double contact_gap(const Offsets& first, const Offsets& second, double w) {
  const auto& contact = skin().mouth.rings[head::kContactRing];
  double gap = 0;
  for (std::size_t m = 1; m < head::kLeftCorner; ++m) {
    const auto a = contact[m], b = contact[head::kMouthLoop - m];
    const Vec3d d = skin().positions[a] - skin().positions[b];
    gap = std::max(gap, length(d + w * (first[a] - first[b]) + w * (second[a] - second[b])));
  }
  return gap;
}

TEST(HeadStructure, LipsAreSealedAtRestAndByMouthClose) {
  const Offsets none(skin().positions.size());
  EXPECT_EQ(contact_gap(none, none, 0), 0.0);
  EXPECT_GT(contact_gap(skin_shape("jawOpen"), none, 1), 3.0);
  for (const double w : {0.1, 0.5, 1.0})
    EXPECT_LT(contact_gap(skin_shape("jawOpen"), skin_shape("mouthClose"), w), 1e-9) << w;
}

TEST(HeadStructure, CornerShapesKeepTheSeal) {
  const Offsets none(skin().positions.size());
  for (const char* shape : {"mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch"})
    for (const char* side : {"Left", "Right"})
      EXPECT_LT(contact_gap(skin_shape(std::string(shape) + side), none, 1), 1e-9) << shape << side;
  for (const char* shape : {"mouthLeft", "mouthRight", "cheekPuff"})
    EXPECT_LT(contact_gap(skin_shape(shape), none, 1), 1e-9) << shape;
  // Roll reaches the contact line a little: pressed lips overlap, puckered ones part by less than 0.1 mm.
  EXPECT_LT(contact_gap(skin_shape("mouthPressLeft"), none, 1), 0.03);
  EXPECT_LT(contact_gap(skin_shape("mouthPucker"), none, 1), 0.01);
  EXPECT_GT(contact_gap(skin_shape("mouthFunnel"), none, 1), 0.5);
}

TEST(HeadStructure, LipDistanceIsProportionalToJawOpen) {
  const auto& contact = skin().mouth.rings[head::kContactRing];
  const auto upper = contact[12], lower = contact[36];
  const Offsets& open = skin_shape("jawOpen");
  const auto gap = [&](double w) {
    return length(skin().positions[upper] - skin().positions[lower] + w * (open[upper] - open[lower]));
  };
  for (const double w : {0.1, 0.25, 0.5, 0.75}) EXPECT_NEAR(gap(w), w * gap(1), 1e-12);
  // 33.3 mm after the final shortening of the face.
  const Vec3d d = open[upper] - open[lower];
  EXPECT_NEAR(length(Vec3d{10 * d.x, 9.4 * d.y, 10 * d.z}), 33.3, 0.1);
}

TEST(HeadStructure, BlinkClosesTheEyeAndStaysOutsideTheEyeball) {
  for (std::size_t e = 0; e < 2; ++e) {
    const auto& eye = skin().eyes[e];
    const Offsets& blink = skin_shape(e == 0 ? "eyeBlinkLeft" : "eyeBlinkRight");
    const auto& edge = eye.rings[head::kLidEdgeRing];
    for (std::size_t m = 1; m < head::kEyeLoop / 2; ++m) {  // edges meet: 0 to 0.6 mm of overlap
      const auto up = edge[m], low = edge[head::kEyeLoop - m];
      const double gap = skin().positions[up].y + blink[up].y - skin().positions[low].y - blink[low].y;
      EXPECT_LE(gap, 1e-9) << m;
      EXPECT_GT(gap, -0.0601) << m;
    }
    const Vec3d centre{eye.sign * head::kEyeCentre.x, head::kEyeCentre.y, head::kEyeCentre.z};
    double nearest = 100;
    for (const double w : {0.0, 0.25, 0.5, 0.75, 1.0})
      for (std::size_t k = 0; k <= head::kLidEdgeRing;
           ++k)  // the rings behind are hidden and touch the eyeball
        for (const auto v : eye.rings[k])
          nearest = std::min(nearest, length(skin().positions[v] + w * blink[v] - centre) - head::kEyeRadius);
    EXPECT_GT(nearest, 0.046);  // cm
  }
}

TEST(HeadStructure, LashesStayOnTheLidAndPointDownWhenItIsClosed) {
  const auto part = [](std::string_view name) -> const head::MovingPart& {
    const auto& parts = built_model().parts;
    return *std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.name == name; });
  };
  const head::MovingPart &left = part("lashesLeft"), &right = part("lashesRight");
  const auto& open = left.mesh.positions;
  ASSERT_EQ(open.size(), right.mesh.positions.size());
  for (std::size_t v = 0; v < open.size(); ++v)
    EXPECT_LT(length(mirrored(open[v]) - right.mesh.positions[v]), 1e-9);

  const Offsets &lash = left.shapes[arkit_index("eyeBlinkLeft")], &lid = skin_shape("eyeBlinkLeft");
  const auto& edge = skin().eyes[0].rings[head::kLidEdgeRing];
  const auto distance_to_edge = [&](Vec3d p, double w) {
    double nearest = 100;
    for (const auto v : edge) nearest = std::min(nearest, length(skin().positions[v] + w * lid[v] - p));
    return nearest;
  };
  constexpr std::size_t kRoots = 73, kTips = 36;  // roots come first, tips last
  for (const double w : {0.0, 0.5, 1.0})
    for (std::size_t v = 0; v < kRoots; ++v)
      EXPECT_LT(distance_to_edge(open[v] + w * lash[v], w), 0.2) << v;  // cm: half the spacing of the edge
  const std::size_t root = kRoots / 2, tip = open.size() - kTips / 2;
  EXPECT_GT(open[tip].y, open[root].y + 0.1);
  EXPECT_LT(open[tip].y + lash[tip].y, open[root].y + lash[root].y - 0.1);
}

TEST(HeadStructure, TrianglesTurnOverOnlyWhereTheyAreHidden) {
  // Inside the mouth and behind the lid edges; besides, in lips that are rolled in, and at the corners when
  // mouthClose stands alone.
  std::set<std::uint32_t> hidden;
  for (std::size_t k = head::kContactRing; k < head::kNumMouthRings; ++k)
    hidden.insert(skin().mouth.rings[k].begin(), skin().mouth.rings[k].end());
  for (const auto& eye : skin().eyes)
    for (std::size_t k = 4; k < head::kNumEyeRings; ++k)
      hidden.insert(eye.rings[k].begin(), eye.rings[k].end());
  const std::map<std::string_view, std::size_t> in_sight = {
      {"mouthClose", 29}, {"mouthRollLower", 27}, {"mouthRollUpper", 1}};
  for (const auto name : arkit_names()) {
    std::vector<Vec3d> moved = skin().positions;
    const Offsets& shape = skin_shape(name);
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v] += shape[v];
    std::size_t turned = 0, seen = 0;
    for (const auto& t : skin().triangles) {
      const auto normal = [&](const std::vector<Vec3d>& p) {
        return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
      };
      if (dot(normal(skin().positions), normal(moved)) >= 0) continue;
      ++turned;
      seen += !std::all_of(t.begin(), t.end(), [&](auto v) { return hidden.contains(v); });
    }
    EXPECT_LE(turned, 30U) << name;
    EXPECT_LE(seen, in_sight.contains(name) ? in_sight.at(name) : 0) << name;
  }
}

// Largest offset of a shape over vertices, millimetres.
double largest_mm(const Offsets& shape, const std::vector<std::uint32_t>& vertices) {
  double largest = 0;
  for (const auto v : vertices) largest = std::max(largest, 10 * length(shape[v]));
  return largest;
}

TEST(HeadStructure, ShapesStayInTheirRegion) {
  const auto& lips = test::built_head().character.regions.at("lips");
  std::vector<std::uint32_t> around_eyes, lids;
  for (const auto& eye : skin().eyes)
    for (std::size_t k = 0; k < head::kNumEyeRings; ++k)
      for (const auto v : eye.rings[k]) (k < 4 ? around_eyes : lids).push_back(v);
  std::vector<std::uint32_t> neck;
  for (std::uint32_t v = 0; v < skin().chart.size(); ++v)
    if (skin().chart[v].station == 0) neck.push_back(v);
  for (const auto name : arkit_names()) {
    const Offsets& shape = skin_shape(name);
    if (name.starts_with("brow") || name.starts_with("eye")) {
      EXPECT_LT(largest_mm(shape, lips), 0.1) << name;
    }
    if (name.starts_with("mouth") || name.starts_with("jaw")) {
      EXPECT_EQ(largest_mm(shape, lids), 0) << name;
      EXPECT_LT(largest_mm(shape, around_eyes), 0.5) << name;  // a smile lifts the skin under the lid
    }
    EXPECT_EQ(largest_mm(shape, neck), 0) << name;
  }
}

TEST(HeadStructure, ThrowOfTheMainShapes) {
  const auto throw_mm = [](std::string_view shape) {
    double largest = 0;
    for (const Vec3d& d : skin_shape(shape))
      largest = std::max(largest, length(Vec3d{10 * d.x, 9.4 * d.y, 10 * d.z}));
    return largest;
  };
  EXPECT_NEAR(throw_mm("mouthPucker"), 16.9, 0.1);
  EXPECT_NEAR(throw_mm("mouthSmileLeft"), 11.7, 0.1);
  EXPECT_NEAR(throw_mm("eyeBlinkRight"), 8.3, 0.1);
  EXPECT_NEAR(throw_mm("browInnerUp"), 5.5, 0.1);
  EXPECT_EQ(throw_mm("tongueOut"), 0);
}

TEST(HeadStructure, SameHeadForAnyNumberOfThreads) {
  const auto one = head::build_head_model(1), many = head::build_head_model(5);
  for (std::size_t p = 0; p < one.parts.size(); ++p)
    for (std::size_t k = 0; k < one.parts[p].shapes.size(); ++k) {
      const Offsets &a = one.parts[p].shapes[k], &b = many.parts[p].shapes[k];
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t v = 0; v < a.size(); ++v) {
        const bool same = a[v].x == b[v].x && a[v].y == b[v].y && a[v].z == b[v].z;
        ASSERT_TRUE(same) << p << " " << k << " " << v;
      }
    }
}

}  // namespace
}  // namespace mien

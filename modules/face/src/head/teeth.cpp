#include <algorithm>
#include <numbers>
#include <numeric>

#include "head/curves.h"
#include "head/parts.h"

namespace mien::head {
namespace {

// Widths from the middle incisor to the second molar, cm; the lower teeth in proportion to the upper ones.
constexpr std::array<double, 7> kUpperWidths = {0.86, 0.66, 0.76, 0.70, 0.68, 1.0, 1.0};
constexpr std::array<double, 7> kLowerShare = {0.64, 0.84, 0.9, 0.98, 1, 1.05, 1.03};
constexpr int kNumTeeth = 14, kColumnsPerTooth = 7;

// One row of the strip, from the gum in front over the cutting edge to the gum behind.
struct ProfileRow {
  double depth;   // fraction of the tooth's thickness
  double height;  // fraction of the tooth's length, 0 at the cutting edge
  bool gum;
};

struct JawForm {
  double half_width, length;  // of the half ellipse that the teeth stand on, cm
  double tooth_length, edge_y, front_z;
  double gum_height;  // of the profile's first row
  int up;             // direction from the cutting edge to the gum
};

// Column of the strip: where on the jaw, which tooth, and how far from the tooth's middle (0) to its side
// (1).
struct Column {
  double arc, off_middle;
  int tooth;
};

std::vector<Column> columns_of(Jaw jaw) {
  std::array<double, 2 * kUpperWidths.size()> widths{};
  for (std::size_t k = 0; k < kUpperWidths.size(); ++k) {
    const double w = kUpperWidths[k] * (jaw == Jaw::upper ? 1.0 : kLowerShare[k]);
    widths[kUpperWidths.size() - 1 - k] = widths[kUpperWidths.size() + k] = w;
  }
  std::vector<double> edges = {0};
  for (const double w : widths) edges.push_back(edges.back() + w);
  const double middle = edges.back() / 2;
  std::vector<Column> columns;
  for (int k = 0; k < kNumTeeth; ++k) {
    const double left = edges[static_cast<std::size_t>(k)] - middle;
    const double width = (edges[static_cast<std::size_t>(k) + 1] - middle) - left;
    const int count = kColumnsPerTooth + (k == kNumTeeth - 1 ? 1 : 0);
    for (int q = 0; q < count; ++q)
      columns.push_back({left + width * q / kColumnsPerTooth, std::abs(2.0 * q / kColumnsPerTooth - 1), k});
  }
  return columns;
}

// Angle of a half ellipse (x = b sin, z = -a (1 - cos)) at an arc length from its middle, by a fine polygon.
class EllipseArc {
 public:
  EllipseArc(double half_width, double length) {
    constexpr int kPoints = 8001;
    constexpr double kReach = 1.02;  // a little beyond the half
    angles_ = linear_space(-std::numbers::pi / 2 * kReach, std::numbers::pi / 2 * kReach, kPoints);
    arcs_.push_back(0);
    for (std::size_t i = 1; i < angles_.size(); ++i) {
      const double dx = half_width * (std::sin(angles_[i]) - std::sin(angles_[i - 1]));
      const double dz = length * (std::cos(angles_[i]) - std::cos(angles_[i - 1]));
      arcs_.push_back(arcs_.back() + std::hypot(dx, dz));
    }
    const double middle = arcs_[kPoints / 2];
    for (double& arc : arcs_) arc -= middle;
  }
  [[nodiscard]] double angle(double arc) const { return interpolate(arc, arcs_, angles_); }

 private:
  std::vector<double> angles_, arcs_;
};

double length_factor(double from_middle) {
  if (from_middle < 1) return 1.0;   // middle incisors
  if (from_middle < 2) return 0.90;  // side incisors
  if (from_middle < 3) return 1.0;   // canines
  if (from_middle < 5) return 0.82;  // premolars
  return 0.70;                       // molars
}

double thickness(double from_middle) { return from_middle < 2.6 ? 0.34 : from_middle < 4.6 ? 0.62 : 0.86; }

}  // namespace

Part build_teeth(Jaw jaw, double contact_z) {
  const JawForm form = jaw == Jaw::upper
                           ? JawForm{2.8, 4.4, 0.98, kMouthLineY - 0.20, contact_z - 0.86, 1.75, 1}
                           : JawForm{2.7, 4.3, 0.88, kMouthLineY - 0.16, contact_z - 0.86 - 0.22, 1.5, -1};
  const std::array<ProfileRow, 13> profile = {{{0.10, form.gum_height, true},
                                               {-0.05, 1.4, true},
                                               {-0.03, 1.12, true},
                                               {0.0, 1.0, false},
                                               {-0.015, 0.72, false},
                                               {0.02, 0.35, false},
                                               {0.10, 0.08, false},
                                               {0.22, 0.0, false},
                                               {0.62, 0.0, false},
                                               {0.9, 0.15, false},
                                               {1.0, 0.5, false},
                                               {1.05, 1.05, true},
                                               {1.15, 1.6, true}}};
  constexpr Rgb kTooth = {0.88, 0.85, 0.77}, kGum = {0.62, 0.30, 0.29};
  constexpr double kGumFollowsTeeth =
      1.2;  // lower gum rows scallop around each tooth, higher ones run straight

  const auto columns = columns_of(jaw);
  std::vector<double> lengths;
  for (const Column& c : columns)
    lengths.push_back(length_factor(std::abs(c.tooth - (kNumTeeth - 1) / 2.0)) * form.tooth_length);
  const double mean_length =
      std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());

  const EllipseArc ellipse(form.half_width, form.length);
  Part part;
  for (const ProfileRow& row : profile)
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Column& column = columns[k];
      const double off2 = column.off_middle * column.off_middle, off4 = off2 * off2, off8 = off4 * off4;
      const double angle = ellipse.angle(column.arc);
      const double x = form.half_width * std::sin(angle), z = -form.length * (1 - std::cos(angle));
      double nx = form.length * std::sin(angle), nz = form.half_width * std::cos(angle);
      const double size = std::hypot(nx, nz);
      nx /= size, nz /= size;
      double depth = row.depth * thickness(std::abs(column.tooth - (kNumTeeth - 1) / 2.0));
      double height = row.height * lengths[k];
      if (row.gum) {
        height = row.height < kGumFollowsTeeth ? height + 0.06 * off4 : row.height * mean_length;
      } else {
        if (row.depth < 0.5) depth += 0.075 * off4 * off2;  // groove between the teeth, in front
        if (row.height < 0.2) height += 0.12 * off8;        // notch of the cutting edge
      }
      part.positions.push_back(
          {x - nx * depth, form.edge_y + form.up * height, form.front_z + z - nz * depth});
      Rgb color = row.gum ? kGum : kTooth;
      if (!row.gum)
        for (double& channel : color) channel *= 1 - 0.16 * off8;
      part.colors.push_back(color);
    }
  // Column order is left to right seen from behind: the upper strip winds the other way round than a plain
  // sheet.
  part.triangles = sheet_triangles(static_cast<int>(profile.size()), static_cast<int>(columns.size()), false);
  if (jaw == Jaw::upper) turn_around(part.triangles);
  return part;
}

}  // namespace mien::head

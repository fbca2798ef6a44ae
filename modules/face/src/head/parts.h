#pragma once
#include <array>
#include <vector>

#include "head/head_skin.h"
#include "head/vec3d.h"

namespace mien::head {

using Rgb = std::array<double, 3>;  ///< linear, 0 ... 1

/// A separate mesh of the head, cm.
struct Part {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  std::vector<Rgb> colors;  // [V]
};

/// Which of a pair; the value is the sign of x.
enum class BodySide : int { left = 1, right = -1 };
enum class Jaw { upper, lower };

Part build_eyeball(BodySide side);
/// Soft tissue in both corners of the eye.
Part build_eye_corners(BodySide side);
/// @param contact_z  HeadSkin::contact_z
Part build_teeth(Jaw jaw, double contact_z);
Part build_tongue(double contact_z);
Part build_brow(BodySide side);
Part build_ear(BodySide side);
Part build_hair();

/// Colour of every vertex of the skin: cheeks, nose, lips, lids, mouth cavity.
std::vector<Rgb> skin_colors(const HeadSkin& skin);

/// Quads of a sheet of `rows` x `columns` vertices in row-major order, split into triangles (a b c)(a c d)
/// with a = (row, column), b = the next column, c = the next row; `closed` joins the last column with the
/// first.
std::vector<Triangle> sheet_triangles(int rows, int columns, bool closed);
/// Turns every triangle around.
void turn_around(std::vector<Triangle>& triangles);

}  // namespace mien::head

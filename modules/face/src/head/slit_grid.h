#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "head/base_surface.h"
#include "head/head_design.h"

namespace mien::head {

using Triangle = std::array<std::uint32_t, 3>;
using Quad = std::array<std::uint32_t, 4>;

/// Which copy of a doubled vertex: the one of the upper or of the lower lip or lid.
enum class Side { upper, lower };

inline constexpr int kHalfColumns = 44;       ///< columns -44 ... 43; column 0 is the middle of the face
inline constexpr int kMouthHalfColumns = 12;  ///< the mouth's slit spans columns -12 ... 12
inline constexpr int kEyeFirstColumn = 8;     ///< the eyes' slits span columns +-8 ... +-22
inline constexpr int kEyeLastColumn = 22;

struct FrontPosition {
  double x, y;
};
/// Outline of the mouth at a column of the slit (-12 ... 12): where the skin ends and the lips begin.
FrontPosition mouth_outline(int column, Side side, double corner_lift);
/// Outline of the left eye at a column of the slit (8 ... 22).
FrontPosition eye_outline(int column, Side side);
/// Eases -1 ... 1 so that columns are denser at both ends of the eye.
double eye_ease(double u);

/// The grid of columns and rows over the whole head with slits for mouth and eyes. Vertices of a slit are
/// doubled except for its two ends; the grid flows around the slits in loops (spec section 4).
struct SlitGrid {
  std::vector<ChartPoint> chart;      // [V]
  std::vector<Quad> quads;            // counter-clockwise from outside
  std::vector<Triangle> crown;        // fan around the last vertex
  std::vector<std::uint32_t> mirror;  // [V] the vertex on the other side of the face

  /// Vertex of a column (-44 ... 44, the ends are one column) of the slit row of the mouth or the eyes.
  [[nodiscard]] std::uint32_t mouth_vertex(int column, Side side) const;
  [[nodiscard]] std::uint32_t eye_vertex(int column, Side side) const;

  int mouth_row = 0, eye_row = 0;
  std::vector<std::array<std::uint32_t, 2>> cells;  // [rows * columns] vertex of each side
};

SlitGrid build_slit_grid(const HeadDesign& design);

}  // namespace mien::head

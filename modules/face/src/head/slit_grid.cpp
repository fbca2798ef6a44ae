#include "head/slit_grid.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "head/curves.h"
#include "head/graph_smoothing.h"
#include "head/skin_surface.h"

namespace mien::head {
namespace {

constexpr int kNumColumns = 2 * kHalfColumns;
constexpr double kMouthStation = 8, kEyeStation = 12;

// Azimuth of columns 0 ... 44: 22 equal steps in front (2.1 mm), then steps that grow by one factor up to pi
// behind.
std::vector<double> column_azimuths() {
  constexpr double kStep = 0.0236;
  constexpr int kEqualSteps = 22, kGrowingSteps = kHalfColumns - kEqualSteps;
  double factor = 1.12;
  for (int round = 0; round < 60; ++round) {  // a fixed point of the factor; converges after about 30 rounds
    double reach = kStep * kEqualSteps;
    for (int k = 1; k <= kGrowingSteps; ++k) reach += kStep * std::pow(factor, k);
    factor *= 1 + (std::numbers::pi - reach) * 0.02;
  }
  std::vector<double> azimuths = {0};
  for (int i = 0; i < kEqualSteps; ++i) azimuths.push_back(azimuths.back() + kStep);
  for (int k = 1; k <= kGrowingSteps; ++k) azimuths.push_back(azimuths.back() + kStep * std::pow(factor, k));
  azimuths.back() = std::numbers::pi;
  return azimuths;
}

// Stations of the rows: denser at mouth, nose and eyes.
std::vector<double> row_stations() {
  struct Span {
    double from, to;
    int rows;
  };
  constexpr std::array<Span, 11> kSpans = {{{0, 2, 5},      // neck
                                            {2, 4, 8},      // throat and chin from below
                                            {4, 6.6, 9},    // chin
                                            {6.6, 8, 6},    // lower lip
                                            {8, 9.4, 6},    // upper lip
                                            {9.4, 11, 11},  // nose
                                            {11, 12, 5},    // lower lids
                                            {12, 13, 7},    // upper lids
                                            {13, 14, 6},    // brows
                                            {14, 16, 9},    // forehead
                                            {16, 16.9, 5}}};
  std::vector<double> stations;
  for (const Span& s : kSpans)
    for (int k = 0; k < s.rows; ++k) stations.push_back(s.from + k * ((s.to - s.from) / s.rows));
  stations.push_back(16.9);
  return stations;
}

int nearest_row(const std::vector<double>& stations, double station) {
  const auto best = std::min_element(stations.begin(), stations.end(), [&](double a, double b) {
    return std::abs(a - station) < std::abs(b - station);
  });
  return static_cast<int>(best - stations.begin());
}

std::size_t cell_index(int column, int row) {
  const int wrapped = column == kHalfColumns ? -kHalfColumns : column;
  return static_cast<std::size_t>(row * kNumColumns + wrapped + kHalfColumns);
}

// Regular grid before the slits open: vertices, cells, mirror.
void lay_out(SlitGrid& grid, const std::vector<double>& azimuths, const std::vector<double>& stations) {
  const auto num_rows = static_cast<int>(stations.size());
  grid.cells.resize(static_cast<std::size_t>(num_rows * kNumColumns));
  for (int row = 0; row < num_rows; ++row) {
    for (int column = -kHalfColumns; column < kHalfColumns; ++column) {
      const int away = std::abs(column);
      const bool doubled = (row == grid.mouth_row && away < kMouthHalfColumns) ||
                           (row == grid.eye_row && away > kEyeFirstColumn && away < kEyeLastColumn);
      const double azimuth = azimuths[static_cast<std::size_t>(away)];
      auto& cell = grid.cells[cell_index(column, row)];
      cell[0] = static_cast<std::uint32_t>(grid.chart.size());
      cell[1] = cell[0] + (doubled ? 1 : 0);
      grid.chart.resize(grid.chart.size() + (doubled ? 2 : 1),
                        {column < 0 ? -azimuth : azimuth, stations[static_cast<std::size_t>(row)]});
    }
  }
  grid.mirror.resize(grid.chart.size());
  for (int row = 0; row < num_rows; ++row)
    for (int column = -kHalfColumns; column < kHalfColumns; ++column)
      for (std::size_t side = 0; side < 2; ++side) {
        const int opposite = column == -kHalfColumns ? column : -column;
        grid.mirror[grid.cells[cell_index(column, row)][side]] = grid.cells[cell_index(opposite, row)][side];
      }
}

void connect(SlitGrid& grid, int num_rows) {
  // A quad above a slit uses the slit's upper copies, the quad below it the lower ones.
  const auto upper = [&](int column, int row) { return grid.cells[cell_index(column, row)][0]; };
  const auto lower = [&](int column, int row) { return grid.cells[cell_index(column, row)][1]; };
  for (int row = 0; row + 1 < num_rows; ++row)
    for (int column = -kHalfColumns; column < kHalfColumns; ++column)
      grid.quads.push_back(
          {upper(column, row), upper(column + 1, row), lower(column + 1, row + 1), lower(column, row + 1)});
  const auto pole = static_cast<std::uint32_t>(grid.chart.size());
  grid.chart.push_back({0, kLastStation});
  grid.mirror.push_back(pole);
  for (int column = -kHalfColumns; column < kHalfColumns; ++column)
    grid.crown.push_back({upper(column, num_rows - 1), upper(column + 1, num_rows - 1), pole});
}

// Chart displacement that carries every vertex on a slit's border to its place on the outline.
std::map<std::uint32_t, std::array<double, 2>> border_displacements(const SlitGrid& grid,
                                                                    const HeadDesign& design) {
  std::map<std::uint32_t, std::array<double, 2>> wanted;
  const auto send = [&](std::uint32_t vertex, double x, double y) {
    const ChartPoint to = find_in_front(x, y), from = grid.chart[vertex];
    wanted[vertex] = {to.azimuth - from.azimuth, to.station - from.station};
  };
  for (const Side side : {Side::lower, Side::upper}) {  // the ends of a slit take the upper outline
    for (int column = -kMouthHalfColumns; column <= kMouthHalfColumns; ++column) {
      const auto [x, y] = mouth_outline(column, side, design.mouth_corner_lift);
      send(grid.mouth_vertex(column, side), x, y);
    }
    for (const int sign : {-1, 1})
      for (int column = kEyeFirstColumn; column <= kEyeLastColumn; ++column) {
        const auto [x, y] = eye_outline(column, side);
        send(grid.eye_vertex(sign * column, side), sign * x, y);
      }
  }
  return wanted;
}

// Spreads the displacement of the borders over the grid; the outer rows and columns stay.
void open_slits(SlitGrid& grid, int num_rows, const HeadDesign& design) {
  constexpr int kStillRowsAboveEyes = 14, kStillColumn = 34;
  constexpr double kBending = 0.35;
  const std::size_t n = grid.chart.size();
  std::vector<bool> known(n, false);
  for (int row = 0; row < num_rows; ++row)
    for (int column = -kHalfColumns; column < kHalfColumns; ++column)
      if (row == 0 || row >= grid.eye_row + kStillRowsAboveEyes || std::abs(column) >= kStillColumn)
        for (const auto vertex : grid.cells[cell_index(column, row)]) known[vertex] = true;
  known[n - 1] = true;  // the crown

  std::vector<std::array<double, 2>> displacement(n);
  for (const auto& [vertex, d] : border_displacements(grid, design)) {
    displacement[vertex] = d;
    known[vertex] = true;
  }
  std::set<std::array<std::uint32_t, 2>> edges;
  for (const Quad& q : grid.quads)
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [low, high] = std::minmax(q[k], q[(k + 1) % 4]);
      edges.insert({low, high});
    }
  smooth_over_graph({edges.begin(), edges.end()}, kBending, known, displacement);
  for (std::size_t v = 0; v < n; ++v) {
    grid.chart[v].azimuth += displacement[v][0];
    grid.chart[v].station += displacement[v][1];
  }
}

}  // namespace

double eye_ease(double u) { return 0.5 * u + 0.5 * std::sin(std::numbers::pi / 2 * u); }

FrontPosition mouth_outline(int column, Side side, double corner_lift) {
  constexpr double kHalfWidth = 2.66, kMiddleY = -4.15, kUpperHeight = 0.98, kLowerHeight = 1.22;
  const double u = static_cast<double>(column) / kMouthHalfColumns;
  const double x = kHalfWidth * (0.55 * std::sin(std::numbers::pi / 2 * u) + 0.45 * u);
  const double s = std::abs(x / kHalfWidth);
  const double middle_y = kMiddleY + corner_lift * std::pow(s, 2.2);
  if (side == Side::upper) return {x, middle_y + kUpperHeight * std::pow(1 - std::pow(s, 2.3), 0.75)};
  return {x, middle_y - kLowerHeight * std::pow(1 - std::pow(s, 2.2), 0.75)};
}

FrontPosition eye_outline(int column, Side side) {
  constexpr double kHalfWidth = 1.92, kUpperHeight = 1.22, kLowerHeight = 1.0;
  const double u = static_cast<double>(column - kEyeFirstColumn) / (kEyeLastColumn - kEyeFirstColumn);
  const double a = eye_ease(-1 + 2 * u);
  const double height = side == Side::upper ? kUpperHeight : -kLowerHeight;
  return {kEyeCentre.x + 0.05 + kHalfWidth * a,
          kEyeCentre.y + 0.06 * a + height * std::pow(1 - std::pow(std::abs(a), 2.4), 0.7)};
}

std::uint32_t SlitGrid::mouth_vertex(int column, Side side) const {
  return cells[cell_index(column, mouth_row)][side == Side::upper ? 0 : 1];
}
std::uint32_t SlitGrid::eye_vertex(int column, Side side) const {
  return cells[cell_index(column, eye_row)][side == Side::upper ? 0 : 1];
}

SlitGrid build_slit_grid(const HeadDesign& design) {
  const auto azimuths = column_azimuths();
  const auto stations = row_stations();
  const auto num_rows = static_cast<int>(stations.size());
  SlitGrid grid;
  grid.mouth_row = nearest_row(stations, kMouthStation);
  grid.eye_row = nearest_row(stations, kEyeStation);
  lay_out(grid, azimuths, stations);
  connect(grid, num_rows);
  open_slits(grid, num_rows, design);
  return grid;
}

}  // namespace mien::head

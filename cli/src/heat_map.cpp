#include "heat_map.h"

#include <algorithm>

#include "mien/metrics/vertex_travel.h"
#include "mien/render/heat_colors.h"
#include "mien/render/motion_picture.h"
#include "mien/render/motion_video.h"
#include "mien/render/png.h"

namespace mien {
namespace {

constexpr float kMillimetres = 1000;

// A face at the first frame of a motion, coloured.
Result<Image> heat_picture(const VertexStage& stage, std::span<const float> values, float largest,
                           const std::string& label, const PictureOptions& options) {
  Character character = stage.character;
  auto& colors = character.parts.front().mesh.colors;
  colors.clear();
  for (const float value : values) colors.push_back(heat_vertex_color(largest > 0 ? value / largest : 0));
  Motion still = stage.motion;
  still.values.resize(static_cast<std::size_t>(still.num_channels()));
  MotionPictureOptions look;
  look.shading.width = options.width;
  look.shading.height = options.height;
  if (!label.empty()) look.labels = {label};
  MIEN_TRY(look.view, parse_view(options.view));
  MIEN_TRY(const auto picture, MotionPicture::create(character, {&still}, look));
  return picture.at(0, options.threads);
}

}  // namespace

Result<HeatStatistic> parse_heat_statistic(const std::string& word) {
  if (word == "mean") return HeatStatistic::mean;
  if (word == "std") return HeatStatistic::deviation;
  return Error{Errc::usage, "--heatmap '" + word + "'", "is not known", "Known: mean, std"};
}

Status write_heat_map(const std::filesystem::path& path, std::span<const VertexStage> stages,
                      const std::vector<std::string>& labels, HeatStatistic statistic,
                      const PictureOptions& options) {
  std::vector<std::vector<float>> values;
  float largest = 0;
  for (const VertexStage& stage : stages) {
    MIEN_TRY(VertexTravel travel, vertex_travel(stage.motion));
    values.push_back(statistic == HeatStatistic::mean ? std::move(travel.mean) : std::move(travel.deviation));
    largest = std::max(largest, *std::max_element(values.back().begin(), values.back().end()));
  }
  std::vector<Image> pictures;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    MIEN_TRY(pictures.emplace_back(),
             heat_picture(stages[i], values[i], largest, labels.empty() ? "" : labels[i], options));
  }
  const Image grid = make_grid(pictures, options.columns);
  constexpr int kLegendHeight = 32, kMargin = 8;
  Image sheet(grid.width(), grid.height() + kLegendHeight, {255, 255, 255});
  blit(sheet, grid, 0, 0);
  draw_heat_legend(sheet, kMargin, grid.height() + 4, grid.width() - 2 * kMargin, largest * kMillimetres,
                   "mm/frame");
  return write_png(path, sheet);
}

}  // namespace mien

// FLAME: parameters as text, and the model as an archive of arrays. Its pickle goes through the pickle
// target.
#include <array>
#include <cmath>
#include <numeric>

#include "mien/base/contract.h"
#include "mien/io/flame_csv.h"
#include "mien/io/flame_file.h"
#include "mien/io/npy.h"
#include "target.h"
#include "zip_for_tests.h"

namespace mien::fuzz {
namespace {

std::vector<Bytes> csv_seeds() {
  return {
      bytes_of(
          "time,expression_0,expression_49,jaw_x,jaw_z\n0.000000,0.1,-0.25,0.1,0\n0.040000,0.2,0,1e-3,-1\n"),
      bytes_of("jaw_y,shape_299\n0.5,1\n")};
}
Outcome read_csv(std::span<const std::byte> bytes) {
  const auto motion = read_flame_csv(as_text(bytes));
  if (motion) {
    contract(motion->fps > 0 && motion->num_channels() > 0, "fuzz: a motion has a rate and channels");
    for (const float v : motion->values) contract(std::isfinite(v), "fuzz: parameters are finite");
    std::string text;
    const Status written = write_flame_csv(*motion, [&](std::string_view piece) -> Status {
      text += piece;
      return Done{};
    });
    contract(written.has_value(), "fuzz: what was read can be written");
    const auto again = read_flame_csv(text, motion->fps);
    contract(again.has_value() && again->values == motion->values, "fuzz: CSV gives back what it was given");
  }
  return outcome_of(motion, motion ? motion->values.size() : 0);
}
constexpr std::array<std::string_view, 10> kCsvWords = {",",       "\n",          "\r\n", "time", "jaw_x",
                                                        "shape_0", "expression_", "1e38", "nan",  "-"};

std::string array(std::vector<std::int64_t> shape) {
  std::size_t count = 1;
  for (const auto size : shape) count *= static_cast<std::size_t>(size);
  return std::string(as_text(write_npy({std::move(shape), std::vector<float>(count, 0.5f)})));
}
std::vector<Bytes> model_seeds() {
  constexpr std::int64_t kVertices = 2, kShapes = 301;
  const auto npy = [](std::string_view type, std::vector<std::int64_t> shape,
                      std::span<const std::byte> data) {
    const Bytes header = npy_header(shape);
    std::string text(as_text(header));
    text.replace(text.find("<f4"), 3, type);
    return text + std::string(as_text(data));
  };
  constexpr std::array<std::uint32_t, 10> kParents = {4294967295u, 0, 1, 1, 1, 0, 1, 2, 3, 4};
  constexpr std::array<std::int64_t, 3> kTriangle = {0, 1, 1};
  return {test::make_zip({{"v_template.npy", array({kVertices, 3})},
                          {"shapedirs.npy", array({kVertices, 3, kShapes}), true},
                          {"posedirs.npy", array({kVertices, 3, 36}), true},
                          {"J_regressor.npy", array({5, kVertices})},
                          {"weights.npy", array({kVertices, 5})},
                          {"kintree_table.npy", npy("<u4", {2, 5}, std::as_bytes(std::span(kParents)))},
                          {"f.npy", npy("<i8", {1, 3}, std::as_bytes(std::span(kTriangle)))}})};
}
Outcome read_model(std::span<const std::byte> bytes) {
  const auto model = parse_flame_model(bytes, "x");
  if (model) {
    const auto v3 = static_cast<std::size_t>(3 * model->num_vertices);
    contract(model->neutral.size() == v3 &&
                 model->shapes.size() == v3 * static_cast<std::size_t>(model->num_shapes),
             "fuzz: the arrays of a model fit each other");
    for (const auto& triangle : model->triangles)
      for (const auto v : triangle) contract(v < model->num_vertices, "fuzz: triangles stay in the mesh");
  }
  return outcome_of(model, model ? model->neutral.size() : 0);
}
constexpr std::array<std::string_view, 8> kModelWords = {"'<f4'", "'>f8'", "'|b1'", "True",
                                                         "(",     "'<i8'", ", ",    "18446744073709551615"};

}  // namespace

Target flame_csv_target() { return {"flame-csv", &csv_seeds, &read_csv, kCsvWords}; }
Target flame_target() { return {"flame", &model_seeds, &read_model, kModelWords}; }

}  // namespace mien::fuzz

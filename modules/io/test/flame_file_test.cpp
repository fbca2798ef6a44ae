#include "mien/io/flame_file.h"

#include <gmock/gmock.h>

#include "mien/base/file.h"
#include "mien/io/npy.h"
#include "zip_for_tests.h"

namespace mien {
namespace {

using test::make_zip;
using test::ZipPart;
using testing::HasSubstr;

constexpr std::int64_t kVertices = 4, kShapes = 302;

// An .npy file of any type: the header that npy_header() writes, with another type's name of three letters.
std::string npy(const std::string& type, std::vector<std::int64_t> shape, std::string data) {
  const Bytes header = npy_header(shape);
  std::string text(as_text(header));
  text.replace(text.find("<f4"), 3, type);
  return text + std::move(data);
}
template <class T>
std::string raw(const std::vector<T>& values) {
  return std::string(as_text(std::as_bytes(std::span(values))));
}
std::string floats(std::vector<std::int64_t> shape, double first = 0) {
  std::size_t count = 1;
  for (const auto size : shape) count *= static_cast<std::size_t>(size);
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = first + static_cast<double>(i) / 64;
  return npy("<f8", std::move(shape), raw(values));
}

std::vector<ZipPart> members() {
  return {{"v_template.npy", floats({kVertices, 3})},
          {"shapedirs.npy", floats({kVertices, 3, kShapes})},
          {"posedirs.npy", floats({kVertices, 3, 36})},
          {"J_regressor.npy", floats({5, kVertices}), true},
          {"weights.npy", floats({kVertices, 5})},
          {"kintree_table.npy",
           npy("<u4", {2, 5}, raw(std::vector<std::uint32_t>{4294967295u, 0, 1, 1, 1, 0, 1, 2, 3, 4}))},
          {"f.npy", npy("<i8", {2, 3}, raw(std::vector<std::int64_t>{0, 1, 2, 1, 2, 3}))},
          {"other.npy", "not an array"}};
}

Result<FlameModel> parse(const std::vector<ZipPart>& parts) {
  return parse_flame_model(make_zip(parts), "model");
}

TEST(FlameFile, ReadsAnArchiveOfArrays) {
  const auto model = parse(members());
  ASSERT_TRUE(model) << model.error().message();
  EXPECT_EQ(model->num_vertices, kVertices);
  EXPECT_EQ(model->num_shapes, kShapes);
  EXPECT_EQ(model->neutral[5], 5.0f / 64);
  EXPECT_EQ(model->shapes[3], static_cast<float>(3 * kShapes) / 64) << "direction 0, the fourth coordinate";
  EXPECT_EQ(model->shapes[12], 1.0f / 64) << "direction 1";
  EXPECT_EQ(model->parents, (std::array<int, 5>{-1, 0, 1, 1, 1}));
  EXPECT_EQ(model->triangles.back(), (std::array<std::uint32_t, 3>{1, 2, 3}));
}

TEST(FlameFile, ReadsFortranOrderAndOtherByteOrders) {
  auto parts = members();
  std::string fortran =
      npy("<f8", {kVertices, 3}, raw(std::vector<double>{0, 3, 6, 9, 1, 4, 7, 10, 2, 5, 8, 11}));
  fortran.replace(fortran.find("False, "), 7, "True,  ");
  parts[0].content = fortran;
  parts[6].content = npy(">u2", {1, 3}, std::string("\0\1\0\2\0\3", 6));
  const auto model = parse(parts);
  ASSERT_TRUE(model) << model.error().message();
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(model->neutral[i], static_cast<float>(i));
  EXPECT_EQ(model->triangles.front(), (std::array<std::uint32_t, 3>{1, 2, 3}));
}

TEST(FlameFile, NamesWhatDoesNotFit) {
  const auto refusal = [&](std::size_t member, const std::string& content) {
    auto parts = members();
    parts[member].content = content;
    const auto model = parse(parts);
    EXPECT_FALSE(model);
    return model ? std::string() : model.error().message();
  };
  for (std::size_t i = 0; i < 7; ++i) {
    auto parts = members();
    const std::string name = parts[i].name.substr(0, parts[i].name.find('.'));
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
    const auto model = parse(parts);
    ASSERT_FALSE(model) << name;
    EXPECT_EQ(model.error().code, Errc::incompatible);
    EXPECT_THAT(model.error().message(), HasSubstr("'" + name + "'"));
  }
  EXPECT_THAT(refusal(0, floats({0, 3})), HasSubstr("0 vertices"));
  EXPECT_THAT(refusal(0, floats({kVertices, 2})), HasSubstr("[4, 2]"));
  EXPECT_THAT(refusal(1, floats({kVertices, 3, 300})), HasSubstr("300 shape directions"));
  EXPECT_THAT(refusal(2, floats({kVertices, 3, 207})), HasSubstr("posedirs"));
  EXPECT_THAT(refusal(3, floats({24, kVertices})), HasSubstr("J_regressor"));
  EXPECT_THAT(refusal(4, floats({kVertices, 5}, 1e300)), HasSubstr("not finite"));
  EXPECT_THAT(refusal(5, npy("<i4", {2, 5}, raw(std::vector<std::int32_t>(10, 4)))), HasSubstr("parent"));
  EXPECT_THAT(refusal(6, npy("<i4", {1, 3}, raw(std::vector<std::int32_t>{0, 1, 4}))),
              HasSubstr("does not exist"));
  EXPECT_THAT(refusal(6, npy("<i4", {1, 3}, raw(std::vector<std::int32_t>{0, 1, -1}))),
              HasSubstr("does not exist"));
  EXPECT_THAT(refusal(6, npy("|O8", {1, 3}, std::string(24, 'x'))), HasSubstr("no number"));
  EXPECT_THAT(refusal(6, "x"), HasSubstr("NumPy"));
}

TEST(FlameFile, SurvivesFilesThatAreCutOrSomethingElse) {
  const Bytes whole = make_zip(members());
  for (std::size_t n = 0; n < whole.size(); n += 131) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(parse_flame_model(cut, "model"));
  }
  EXPECT_FALSE(parse_flame_model(as_bytes(std::string_view("(lp0\n.")), "model")) << "a pickled list";
  EXPECT_FALSE(parse_flame_model({}, "model"));
  EXPECT_EQ(read_flame_model("no/such/file.pkl").error().code, Errc::input);
}

}  // namespace
}  // namespace mien

#include "mien/datasets/blendshape_residuals.h"

#include <gmock/gmock.h>

#include <limits>

#include "mien/base/file.h"
#include "pickle_text.h"
#include "test_folder.h"

namespace mien {
namespace {

using pickle_text::array;
using pickle_text::dict;
using pickle_text::number;
using pickle_text::text;
using testing::ElementsAre;
using testing::HasSubstr;

class BlendshapeResiduals : public testing::Test {
 protected:
  auto load(const std::string& pickle) {
    EXPECT_TRUE(write_file(folder_ / "residuals.pkl", std::string_view(pickle)));
    return load_blendshape_residuals(folder_ / "residuals.pkl");
  }
  std::string refused(const std::string& pickle) {
    const auto loaded = load(pickle + ".");
    return loaded ? std::string() : loaded.error().message();
  }
  TestFolder folder_;
};

const std::string kShape = array(std::vector<double>{1, 2, 3, 4, 5, 6}, "f8", {2, 3});
const std::string kWhole = dict({{text("Anna"), dict({{text("jawOpen"), kShape}, {text("jawLeft"), kShape}})},
                                 {text("Bert"), dict({{text("jawOpen"), kShape}})}}) +
                           ".";

TEST_F(BlendshapeResiduals, AreReadByPersonAndShape) {
  const auto persons = load(kWhole);
  ASSERT_TRUE(persons) << persons.error().message();
  ASSERT_EQ(persons->size(), 2u);
  EXPECT_EQ(persons->at("Anna").size(), 2u);
  EXPECT_THAT(persons->at("Bert").at("jawOpen"), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST_F(BlendshapeResiduals, NameWhatIsWrong) {
  EXPECT_THAT(refused(kShape), HasSubstr("is not a dictionary"));
  EXPECT_THAT(refused("}"), HasSubstr("is empty"));
  EXPECT_THAT(refused(dict({{number(1), kShape}})), HasSubstr("entry 0 has no name"));
  EXPECT_THAT(refused(dict({{text("../x"), dict({{text("jawOpen"), kShape}})}})), HasSubstr("'../x'"));
  EXPECT_THAT(refused(dict({{text("A"), dict({{text("jawOpen"), text("x")}})}})),
              HasSubstr("'A' 'jawOpen': is not an array"));
  EXPECT_THAT(refused(dict({{text("A"), dict({{text("j"), array(std::vector<double>{1, 2, 3}, "f8")}})}})),
              HasSubstr("is not an array [vertices, 3]"));
  EXPECT_THAT(
      refused(dict({{text("A"), dict({{text("a"), kShape},
                                      {text("b"), array(std::vector<double>{1, 2, 3}, "f8", {1, 3})}})}})),
      HasSubstr("'A' 'b': moves 1 vertices, the first shape 2"));
  EXPECT_THAT(
      refused(
          dict({{text("A"),
                 dict({{text("a"), array(std::vector<double>{0, 0, std::numeric_limits<double>::quiet_NaN()},
                                         "f8", {1, 3})}})}})),
      HasSubstr("not finite"));
}

TEST_F(BlendshapeResiduals, OfACutFileAreRefused) {
  for (std::size_t size = 0; size < kWhole.size(); ++size) EXPECT_FALSE(load(kWhole.substr(0, size))) << size;
}

}  // namespace
}  // namespace mien

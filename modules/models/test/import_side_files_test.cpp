#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "import/side_files.h"
#include "import/system_subjects.h"
#include "mien/base/file.h"
#include "mien/io/min_max_scaler.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class SideFiles : public testing::Test {
 protected:
  SideFiles() {
    folder_ = fs::temp_directory_path() / ("mien_side_files_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~SideFiles() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string write(const std::string& name, std::string_view text) const {
    EXPECT_TRUE(write_file(folder_ / name, text));
    return (folder_ / name).string();
  }
  fs::path folder_;
};

TEST_F(SideFiles, RegionsListVerticesOrWeights) {
  const auto mouth = read_region(write("lve.txt", "2, 5, 7\n"), 8);
  ASSERT_TRUE(mouth) << mouth.error().message();
  EXPECT_EQ(mouth->name, "mouth");
  EXPECT_THAT(mouth->vertices, ElementsAre(2, 5, 7));
  EXPECT_EQ(read_region(write("fdd.txt", "3,1,3"), 8)->name, "upper");
  EXPECT_THAT(read_region(write("fdd.txt", "3,1,3"), 8)->vertices, ElementsAre(1, 3));
  EXPECT_EQ(read_region("jaw=" + write("lve.txt", "0"), 8)->name, "jaw");
  EXPECT_EQ(read_region(write("neck.txt", "0"), 8)->name, "neck");
  EXPECT_THAT(read_region(write("weighted_mouth_mask.txt", "0.0\n0.2\n0.1\n1.0\n"), 4)->vertices,
              ElementsAre(1, 3));
  EXPECT_THAT(read_region(write("forehead_mask.txt", "0.3\n0.5\n0\n1\n"), 4)->vertices, ElementsAre(1, 3));
}

TEST_F(SideFiles, RegionsThatDoNotFit) {
  const auto rejection = [&](const std::string& text) {
    const auto region = read_region(write("lve.txt", text), 8);
    return region ? std::string("accepted") : region.error().message();
  };
  EXPECT_THAT(rejection("1, 8"), HasSubstr("mesh with 8 vertices"));
  EXPECT_THAT(rejection("-1"), HasSubstr("mesh with 8 vertices"));
  EXPECT_THAT(rejection("1.5"), HasSubstr("mesh with 8 vertices"));
  EXPECT_THAT(rejection(""), HasSubstr("lists no vertices"));
  EXPECT_THAT(rejection("one, two"), HasSubstr("lists no vertices"));
  EXPECT_THAT(rejection("nan"), HasSubstr("lists no vertices"));
  EXPECT_EQ(read_region((folder_ / "absent.txt").string(), 8).error().code, Errc::input);
}

TEST_F(SideFiles, TemplatesAndScalersThatAreSomethingElse) {
  const auto templates = [&](std::string_view pickle) {
    const auto read = read_templates(write("t.pkl", pickle), 9);
    return read ? std::string("accepted") : read.error().message();
  };
  EXPECT_THAT(templates("}."), HasSubstr("no neutral faces"));
  EXPECT_THAT(templates("]."), HasSubstr("no neutral faces"));
  EXPECT_THAT(templates("}U\x01"
                        "aK\x01s."),
              HasSubstr("no neutral face"));
  EXPECT_THAT(templates("cos\nsystem\n(U\x02lstR."), HasSubstr("'os.system'"));
  const std::string face =
      "}U\x01"
      "acnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(I2\ntcnumpy\ndtype\n"
      "(S'f4'\nI0\nI1\ntR(I3\nS'<'\nNNNI-1\nI-1\nI0\ntbI0\nU\x08"
      "12345678tbs.";
  EXPECT_THAT(templates(face), HasSubstr("with 2 coordinates, the model has 9"));
  EXPECT_TRUE(read_templates(write("t.pkl", face), 2));
  const auto scaler = read_min_max_scaler(write("s.pkl", "cos\nsystem\n(U\x02lstR."), 9);
  EXPECT_THAT(scaler.error().message(), HasSubstr("'os.system', expected a MinMaxScaler"));
  EXPECT_THAT(read_min_max_scaler(write("s.pkl", "}."), 9).error().message(), HasSubstr("no MinMaxScaler"));
}

TEST(SubjectNames, ArePublishedGivenOrNumbers) {
  const auto names = [](std::vector<std::string> given, std::int64_t count, const char* topology) {
    return subject_names(given, count, Architecture::facediffuser_v, topology);
  };
  EXPECT_EQ(names({}, 6, "biwi")->front(), "F2");
  EXPECT_EQ(names({}, 8, "flame")->size(), 8u);
  EXPECT_THAT(*names({}, 3, "biwi"), ElementsAre("1", "2", "3"));
  EXPECT_FALSE(names({}, 3, "biwi").warnings.empty());
  EXPECT_THAT(*names({"a", "b"}, 2, ""), ElementsAre("a", "b"));
  EXPECT_THAT(names({"a"}, 2, "").error().message(), HasSubstr("names 1 subjects"));
  EXPECT_THAT(names({"a", "a"}, 2, "").error().message(), HasSubstr("twice"));
  EXPECT_THAT(names({"a"}, 0, "").error().message(), HasSubstr("no styles"));
}

}  // namespace
}  // namespace mien

#include "mien/io/index_list.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "mien/base/file.h"
#include "mien/io/character_file.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST(IndexList, KeepsTheOrderOfNumbersAndRanges) {
  const auto list = read_index_list("7\n# two ranges\n0-2, 5;5-5 # end\r\n\n1", 8);
  ASSERT_TRUE(list) << list.error().message();
  EXPECT_THAT(*list, ElementsAre(7, 0, 1, 2, 5, 5, 1));
  EXPECT_TRUE(read_index_list("", 0)->empty());
}

TEST(IndexList, NamesTheLineThatIsWrong) {
  const auto why = [](std::string_view text) { return read_index_list(text, 8).error().message(); };
  EXPECT_THAT(why("1\n2\nx"), HasSubstr("line 3: 'x' is no vertex number"));
  EXPECT_THAT(why("8"), HasSubstr("vertex 8 does not exist: there are 8"));
  EXPECT_THAT(why("0-4294967295"), HasSubstr("does not exist"));
  EXPECT_THAT(why("5-3"), HasSubstr("runs backwards"));
  EXPECT_THAT(why("3-"), HasSubstr("no range"));
  EXPECT_THAT(why("-1"), HasSubstr("no vertex number"));
  EXPECT_THAT(why("99999999999999999999"), HasSubstr("no vertex number"));
}

TEST(IndexPairs, ReadsTwoNumbersALineBelowAHeading) {
  const auto pairs = read_index_pairs("source,target\n1, 2\n\n30 40 # nose\n5;6\n");
  ASSERT_TRUE(pairs) << pairs.error().message();
  EXPECT_THAT(*pairs, ElementsAre(Pair(1, 2), Pair(30, 40), Pair(5, 6)));
  EXPECT_THAT(read_index_pairs("1,2\n3\n").error().message(), HasSubstr("line 2: is no pair"));
  EXPECT_THAT(read_index_pairs("1,2,3\n").error().message(), HasSubstr("line 1"));
  EXPECT_THAT(read_index_pairs("a,b\nc,d\n").error().message(), HasSubstr("line 2"));
}

TEST(BlendshapeFolder, IsACharacter) {
  const auto folder = std::filesystem::temp_directory_path() / ("mien_shapes_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto put = [&](const char* name, const char* text) {
    ASSERT_TRUE(write_file(folder / name, std::string_view(text)));
  };
  EXPECT_THAT(load_character(folder).error().message(), HasSubstr("holds no neutral.obj"));
  put("Neutral.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("jawOpen.obj", "v 0 0 0\nv 1 0 0.5\nv 0 1 0\nf 1 2 3\n");
  put("EyeBlink_L.obj", "v 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("wink.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  put("notes.txt", "no mesh");
  const auto character = load_character(folder);
  ASSERT_TRUE(character) << character.error().message();
  ASSERT_EQ(character->parts.size(), 1u);
  const auto& shapes = character->parts[0].shapes;
  ASSERT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes[0].name, "eyeBlinkLeft");
  EXPECT_EQ(shapes[1].name, "jawOpen");
  EXPECT_THAT(shapes[1].vertices, ElementsAre(1));
  EXPECT_EQ(shapes[1].offsets[0], (Vec3{0, 0, 0.5f}));
  EXPECT_TRUE(shapes[2].vertices.empty());
  EXPECT_THAT(character.warnings, ElementsAre(HasSubstr("wink")));
  put("jawOpen.obj", "v 0 0 0\n");
  EXPECT_THAT(load_character(folder).error().message(), HasSubstr("has 1 vertices, the neutral face 3"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace mien

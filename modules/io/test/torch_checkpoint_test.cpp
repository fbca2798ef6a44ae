#include "mien/io/torch_checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "io_test_support.h"
#include "mien/base/file.h"
#include "zip_for_tests.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::string_literals;

std::string short_text(std::string_view text) {
  return "U" + std::string(1, static_cast<char>(text.size())) + std::string(text);
}
std::string number(std::int64_t value) { return "I" + std::to_string(value) + "\n"; }
std::string tuple(const std::vector<std::int64_t>& values) {
  std::string text = "(";
  for (const auto v : values) text += number(v);
  return text + "t";
}
/// The pickle text of a float tensor with this view of storage "0".
std::string tensor(const std::vector<std::int64_t>& shape, const std::vector<std::int64_t>& strides,
                   std::int64_t offset = 0, std::int64_t count = 6,
                   std::string_view storage = "FloatStorage") {
  return "ctorch._utils\n_rebuild_tensor_v2\n((" + short_text("storage") + "ctorch\n" + std::string(storage) +
         "\n" + short_text("0") + short_text("cuda:0") + number(count) + "tQ" + number(offset) +
         tuple(shape) + tuple(strides) + "I00\nccollections\nOrderedDict\n)RtR";
}
std::string dict(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string text = "ccollections\nOrderedDict\n)R";
  for (const auto& [name, value] : entries) text += short_text(name) + value + "s";
  return text + "}U\x09_metadataNsb";  // what module.state_dict() hangs on
}
std::string six_floats() {
  const std::array<float, 6> values = {0, 1, 2, 3, 4, 5};
  return std::string(as_text(std::as_bytes(std::span(values))));
}
Bytes checkpoint(const std::string& pickle, const std::string& data = six_floats(), bool deflated = false) {
  return test::make_zip(
      {{"m/data.pkl", pickle + ".", deflated}, {"m/data/0", data, deflated}, {"m/version", "3\n"}});
}
std::string rejection(const std::string& pickle) {
  const auto file = TorchCheckpoint::parse(checkpoint(pickle), "x");
  return file ? "accepted" : file.error().message();
}

TEST(TorchCheckpoint, ViewsOfOneStorage) {
  const auto file = TorchCheckpoint::parse(checkpoint(dict({{"whole", tensor({2, 3}, {3, 1})},
                                                            {"transposed", tensor({3, 2}, {1, 3})},
                                                            {"tail", tensor({2}, {1}, 4)},
                                                            {"scalar", tensor({}, {}, 5)},
                                                            {"empty", tensor({0, 4}, {4, 1}, 6)},
                                                            {"expanded", tensor({2, 2}, {0, 1}, 1)},
                                                            {"steps", "K\x05"}})));
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_EQ(file->tensors().size(), 6u);
  EXPECT_EQ(file->find("whole")->shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_THAT(*file->read_float("whole"), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(*file->read_float("transposed"), ElementsAre(0, 3, 1, 4, 2, 5));
  EXPECT_THAT(*file->read_float("tail"), ElementsAre(4, 5));
  EXPECT_THAT(*file->read_float("scalar"), ElementsAre(5));
  EXPECT_THAT(*file->read_float("expanded"), ElementsAre(1, 2, 1, 2));
  EXPECT_TRUE(file->read_float("empty")->empty());
  EXPECT_EQ(file->find("steps"), nullptr) << "a number beside the tensors";
  EXPECT_THAT(file->read_float("absent").error().message(), HasSubstr("no tensor 'absent'"));
}

TEST(TorchCheckpoint, FindsTheStateDict) {
  const std::string weights = dict({{"w", tensor({2}, {1})}});
  for (const auto* key : {"state_dict", "model_state_dict", "model", "module", "net"}) {
    const std::string foreign = "cmy\nOptions\n)\x81}b";
    const auto file = TorchCheckpoint::parse(
        checkpoint("}" + short_text("options") + foreign + "s" + short_text(key) + weights + "s"));
    ASSERT_TRUE(file) << file.error().message();
    EXPECT_THAT(*file->read_float("w"), ElementsAre(0, 1));
  }
  EXPECT_THAT(rejection("}" + short_text("epoch") + "K\x01s"), HasSubstr("it holds 'epoch'"));
  EXPECT_THAT(rejection("cmy\nNetwork\n)\x81}b"), HasSubstr("object of class 'my.Network'"));
  EXPECT_THAT(rejection("]"), HasSubstr("no dictionary of tensors"));
}

TEST(TorchCheckpoint, RefusesForeignValuesAmongTheTensors) {
  EXPECT_THAT(rejection(dict({{"w", tensor({2}, {1})}, {"f", "cposix\nsystem\n(U\x02lstR"}})),
              AllOf(HasSubstr("'posix.system'"), HasSubstr("Nothing of it was run")));
  EXPECT_THAT(rejection(dict({{"w", tensor({2}, {1})}, {"f", "c__builtin__\nprint\n"}})),
              HasSubstr("'builtins.print'"));
}

TEST(TorchCheckpoint, RefusesViewsOutsideTheirStorage) {
  const auto with = [](const std::string& t) { return rejection(dict({{"w", t}})); };
  constexpr auto kBig = std::int64_t{1} << 62;
  EXPECT_THAT(with(tensor({7}, {1})), HasSubstr("reaches outside its storage of 6 elements"));
  EXPECT_THAT(with(tensor({2}, {1}, 5)), HasSubstr("reaches outside"));
  EXPECT_THAT(with(tensor({2, 2}, {5, 1})), HasSubstr("reaches outside"));
  EXPECT_THAT(with(tensor({kBig, 4}, {4, 1})), HasSubstr("reaches outside"));
  EXPECT_THAT(with(tensor({3}, {kBig})), HasSubstr("reaches outside"));
  EXPECT_THAT(with(tensor({1}, {1}, kBig + (kBig - 1))), HasSubstr("reaches outside"));
  EXPECT_THAT(with(tensor({std::int64_t{1} << 40}, {0})), HasSubstr("64 times the file's size"));
  EXPECT_THAT(with(tensor({-1}, {1})), HasSubstr("damaged shape"));
  EXPECT_THAT(with(tensor({1, 1}, {1})), HasSubstr("damaged shape"));
  EXPECT_THAT(with(tensor({1}, {1}, 0, 7)), HasSubstr("fewer than its 7 elements need"));
  EXPECT_THAT(with(tensor({1}, {1}, 0, kBig)), HasSubstr("elements need"));
  EXPECT_THAT(with(tensor({1}, {1}, 0, 6, "ComplexFloatStorage")), HasSubstr("ComplexFloatStorage"));
}

TEST(TorchCheckpoint, ElementTypes) {
  const auto file = TorchCheckpoint::parse(checkpoint(dict({{"i", tensor({2}, {1}, 1, 3, "LongStorage")}})));
  ASSERT_TRUE(file);
  EXPECT_EQ(file->find("i")->dtype, Dtype::i64);
  EXPECT_EQ(file->read("i")->size(), 16u);
  EXPECT_THAT(file->read_float("i").error().message(), HasSubstr("has dtype I64"));
  const std::array<std::uint16_t, 2> halves = {float_to_half(1.5f), float_to_half(-2.f)};
  const auto half =
      TorchCheckpoint::parse(checkpoint(dict({{"h", tensor({2}, {1}, 0, 2, "HalfStorage")}}),
                                        std::string(as_text(std::as_bytes(std::span(halves)))), true));
  ASSERT_TRUE(half) << half.error().message();
  EXPECT_THAT(*half->read_float("h"), ElementsAre(1.5f, -2.f));
}

TEST(TorchCheckpoint, FilesThatAreSomethingElse) {
  const auto reject = [](std::string_view text) {
    const auto bytes = as_bytes(text);
    const auto file = TorchCheckpoint::parse(Bytes(bytes.begin(), bytes.end()), "x");
    return file ? std::string("accepted") : file.error().message();
  };
  EXPECT_THAT(reject(""), HasSubstr("is empty"));
  EXPECT_THAT(reject("version https://git-lfs.github.com/spec/v1\noid sha256:0\n"),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(reject("\n<!DOCTYPE html><html>"), HasSubstr("is a web page"));
  EXPECT_THAT(reject("RIFF1234WAVE"), HasSubstr("no checkpoint"));
  EXPECT_THAT(reject("cposix\nsystem\n(U\x02lstR."), HasSubstr("'posix.system'"));
  const auto zip = TorchCheckpoint::parse(test::make_zip({{"a.txt", "hello"}}), "x");
  EXPECT_THAT(zip.error().message(), HasSubstr("without data.pkl"));
}

bool touch(const Bytes& bytes) {
  const auto file = TorchCheckpoint::parse(bytes, "x");
  if (!file) return false;
  bool fine = true;
  for (const auto& t : file->tensors()) {
    const auto read = file->read(t.name);
    fine &= read.has_value();
    if (read) {
      EXPECT_EQ(read->size(), static_cast<std::size_t>(t.count()) * dtype_size(t.dtype));
    }
  }
  return fine && !file->tensors().empty();
}

TEST(TorchCheckpoint, SurvivesEveryTruncationAndFlip) {
  const std::string pickle = dict({{"w", tensor({2, 3}, {3, 1})}, {"v", tensor({2}, {1}, 4)}});
  test::torture(checkpoint(pickle), touch, [](std::size_t) { return false; });
  std::string old = "\x80\x02\x8a\x0al\xfc\x9c\x46\xf9 j\xa8P\x19.M\xe9\x03."s;
  old += "}" + short_text("little_endian") + "I01\ns." + pickle + ".](" + short_text("0") + "e.";
  Bytes legacy;
  for (const char c : old) legacy.push_back(static_cast<std::byte>(c));
  append_le<std::int64_t>(legacy, 6);
  for (const char c : six_floats()) legacy.push_back(static_cast<std::byte>(c));
  const auto file = TorchCheckpoint::parse(legacy);
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_THAT(*file->read_float("v"), ElementsAre(4, 5));
  test::torture(legacy, touch, [](std::size_t) { return false; });
}

/// Every checkpoint of the fixtures with bytes changed at random places: a result or an error, nothing else.
TEST(TorchCheckpoint, SurvivesDamagedFixtures) {
  const auto root = test::shared_file("fixtures");
  if (!root) GTEST_SKIP() << "no fixtures";
  std::uint32_t seed = 1;
  const auto random = [&] { return seed = seed * 1664525u + 1013904223u; };
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*root)) {
    const auto extension = entry.path().extension();
    if (extension != ".pth" && extension != ".bin" && extension != ".ckpt" && extension != ".pt") continue;
    if (entry.file_size() > 300'000) continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    const Bytes whole = *read_file(entry.path());
    (void)touch(whole);
    for (int i = 0; i < 40 && !whole.empty(); ++i) {
      Bytes damaged = whole;
      // Zip checksums stop most damage: the pickle's own is in its directory, so damage the old form too.
      for (int k = 0; k < 1 + i % 4; ++k)
        damaged[(random() >> 4) % damaged.size()] = static_cast<std::byte>(random() >> 24);
      (void)touch(damaged);
      damaged.resize((random() >> 4) % damaged.size());
      EXPECT_FALSE(touch(damaged));
    }
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace mien

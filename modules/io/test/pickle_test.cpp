#include "mien/io/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io_test_support.h"
#include "mien/base/file.h"

namespace mien {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::string_literals;

Bytes bytes_of(std::string_view text) {
  const auto bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}

/// A pickle and the bytes that it looks into.
struct Read {
  std::unique_ptr<Bytes> bytes;
  Result<Pickle> pickle;
};
Read read(std::string_view text, bool keep_foreign = false) {
  auto bytes = std::make_unique<Bytes>(bytes_of(text));
  auto pickle = Pickle::parse(*bytes, "x", {.keep_foreign = keep_foreign});
  return {std::move(bytes), std::move(pickle)};
}
std::string rejection(std::string_view text, bool keep_foreign = false) {
  const auto [bytes, pickle] = read(text, keep_foreign);
  return pickle ? "accepted" : pickle.error().message();
}

TEST(Pickle, NumbersOfEveryProtocol) {
  EXPECT_EQ(read("I42\n.").pickle->root().integer(), 42);
  EXPECT_EQ(read("L-7L\n.").pickle->root().integer(), -7);
  EXPECT_EQ(read("F1.5\n.").pickle->root().number(), 1.5);
  EXPECT_EQ(read("I01\n.").pickle->root().boolean(), true);
  EXPECT_EQ(read("J\xff\xff\xff\xff.").pickle->root().integer(), -1);
  EXPECT_EQ(read("K\xff.").pickle->root().integer(), 255);
  EXPECT_EQ(read("M\x01\x02.").pickle->root().integer(), 0x201);
  EXPECT_EQ(read("G\x3f\xf8\0\0\0\0\0\0."s).pickle->root().number(), 1.5);
  EXPECT_EQ(read("\x80\x02\x8a\x02\x00\xff."s).pickle->root().integer(), -256);
  EXPECT_EQ(read("\x80\x02\x8a\x00."s).pickle->root().integer(), 0);
  EXPECT_EQ(read("\x80\x02\x88.").pickle->root().boolean(), true);
  EXPECT_EQ(read("N.").pickle->root().kind(), PickleKind::none);
  const auto big = read(
      "\x80\x02\x8a\x0a"
      "0123456789.");
  EXPECT_EQ(big.pickle->root().kind(), PickleKind::big_integer);
  EXPECT_EQ(big.pickle->root().bytes()->size(), 10u);
}

TEST(Pickle, StringsOfEveryProtocol) {
  EXPECT_EQ(read("S'a\\x41\\n\\'b'\n.").pickle->root().text(), "aA\n'b");
  EXPECT_EQ(read("V\\u00e4b\n.").pickle->root().text(),
            "\xc3\xa4"
            "b");
  EXPECT_EQ(read("U\x02hi.").pickle->root().text(), "hi");
  EXPECT_EQ(read("T\x02\0\0\0hi."s).pickle->root().text(), "hi");
  EXPECT_EQ(read("X\x02\0\0\0hi."s).pickle->root().text(), "hi");
  EXPECT_EQ(read("\x80\x04\x8c\x02hi.").pickle->root().text(), "hi");
  EXPECT_EQ(read("\x80\x04\x8d\x02\0\0\0\0\0\0\0hi."s).pickle->root().text(), "hi");
  for (const auto& text : {"C\x02hi."s, "B\x02\0\0\0hi."s, "\x80\x05\x96\x02\0\0\0\0\0\0\0hi."s})
    EXPECT_EQ(as_text(*read(text).pickle->root().bytes()), "hi");
  // Protocol 2 of Python 3 has no bytes: Latin-1 text and a call that encodes it.
  const auto encoded = read("c_codecs\nencode\n(X\x03\0\0\0\xc3\xa4zX\x06\0\0\0latin1tR."s);
  EXPECT_EQ(as_text(*encoded.pickle->root().bytes()), "\xe4z");
  EXPECT_THAT(rejection("c_codecs\nencode\n(X\x03\0\0\0\xe2\x82\xacX\x06\0\0\0latin1tR."s),
              HasSubstr("not Latin-1"));
}

TEST(Pickle, ContainersOfEveryProtocol) {
  const auto list = read("(lp0\nI1\naI2\na.");
  ASSERT_EQ(list.pickle->root().size(), 2u);
  EXPECT_EQ(list.pickle->root()[1].integer(), 2);
  const auto dict = read(
      "}(U\x01"
      "aK\x01U\x01"
      "bK\x02U\x01"
      "aK\x03u.");
  EXPECT_EQ(dict.pickle->root().size(), 3u);
  EXPECT_EQ(dict.pickle->root().find("a")->integer(), 3) << "the last one counts";
  EXPECT_FALSE(dict.pickle->root().find("c"));
  EXPECT_EQ(dict.pickle->root().key(1).text(), "b");
  EXPECT_EQ(read("K\x01K\x02K\x03\x87.").pickle->root().size(), 3u);
  EXPECT_EQ(read("\x80\x04\x8f(K\x01K\x02\x90.").pickle->root().kind(), PickleKind::set);
  EXPECT_EQ(read("c__builtin__\nset\n(]K\x01"
                 "atR.")
                .pickle->root()
                .size(),
            1u);
  const auto ordered = read(
      "ccollections\nOrderedDict\n((l(U\x01"
      "xK\x05tatR.");
  EXPECT_EQ(ordered.pickle->root().find("x")->integer(), 5);
}

TEST(Pickle, SharedAndCyclicValuesAreFine) {
  const auto cycle = read(
      "]q\x01h\x01"
      "a.");
  ASSERT_EQ(cycle.pickle->root().size(), 1u);
  EXPECT_EQ(cycle.pickle->root()[0][0][0].kind(), PickleKind::list);
  std::string deep(500'000, '('), after(500'000, 't');
  EXPECT_TRUE(read(deep + after + ".").pickle)
      << "nesting costs no stack, neither when made nor when destroyed";
}

TEST(Pickle, RefusesProgramsByName) {
  const std::string call =
      "\x80\x02"
      "cposix\nsystem\nX\x02\0\0\0ls\x85R."s;
  EXPECT_THAT(rejection(call), AllOf(HasSubstr("'posix.system'"), HasSubstr("Nothing of it was run")));
  EXPECT_EQ(Pickle::parse(bytes_of(call), "x").error().code, Errc::incompatible);
  EXPECT_THAT(rejection("\x80\x04\x8c\x02os\x8c\x06system\x93."), HasSubstr("'os.system'"));
  EXPECT_THAT(rejection("(S'ls'\nios\nsystem\n."), HasSubstr("'os.system'"));
  EXPECT_THAT(rejection("(cos\nsystem\nS'ls'\no."), HasSubstr("'os.system'"));
  EXPECT_THAT(rejection("c__builtin__\neval\n(S'1'\ntR."), HasSubstr("'builtins.eval'"));
  EXPECT_THAT(rejection("ccollections\nOrderedDict.__init__\n."), HasSubstr("OrderedDict.__init__"));
  EXPECT_THAT(rejection("\x80\x02\x82\x01."), HasSubstr("extension registry"));
  EXPECT_THAT(rejection("cbuiltins\nint\n(K\x01tR."), HasSubstr("makes an object of 'builtins.int'"));
}

TEST(Pickle, KeepsForeignObjectsAsideWhenAsked) {
  const auto kept = read("cmy.module\nThing\n)\x81}U\x01xK\x07sb.", true);
  ASSERT_TRUE(kept.pickle);
  const auto root = kept.pickle->root();
  EXPECT_EQ(root.kind(), PickleKind::object);
  EXPECT_EQ(root.class_name(), "my.module.Thing");
  EXPECT_EQ(root.state()->find("x")->integer(), 7);
  const auto call = read("cposix\nsystem\n(U\x02lstR.", true);
  EXPECT_EQ(call.pickle->root().class_name(), "posix.system");
  EXPECT_EQ(call.pickle->root()[0].text(), "ls");
  const auto old = read("ccopy_reg\n_reconstructor\n(cchumpy.ch\nCh\nc__builtin__\nobject\nNtR}b.", true);
  EXPECT_EQ(old.pickle->root().class_name(), "chumpy.ch.Ch");
}

std::string array_pickle(std::string_view type, std::string_view order, std::string_view shape,
                         std::string_view fortran, std::string_view data) {
  return "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n" + std::string(shape) +
         "cnumpy\ndtype\n(S'" + std::string(type) + "'\nI0\nI1\ntR(I3\nS'" + std::string(order) +
         "'\nNNNI-1\nI-1\nI0\ntb" + std::string(fortran) + "U" +
         std::string(1, static_cast<char>(data.size())) + std::string(data) + "tb.";
}

TEST(Pickle, NumPyArraysOfEveryLayout) {
  const auto values = [](const std::string& text) {
    const auto [bytes, pickle] = read(text);
    EXPECT_TRUE(pickle) << pickle.error().message();
    const auto* array = pickle->root().array();
    return array->to_doubles().value();
  };
  EXPECT_THAT(values(array_pickle("i2", "<", "(I2\nI2\nt", "I0\n", "\1\0\2\0\3\0\4\0"s)),
              ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(values(array_pickle("i2", "<", "(I2\nI2\nt", "I1\n", "\1\0\2\0\3\0\4\0"s)),
              ElementsAre(1, 3, 2, 4));
  EXPECT_THAT(values(array_pickle("i2", ">", "(I2\nt", "I0\n", "\1\0\0\2"s)), ElementsAre(256, 2));
  EXPECT_THAT(values(array_pickle("u1", "|", "(I2\nt", "I0\n", "\xff\1")), ElementsAre(255, 1));
  EXPECT_THAT(values(array_pickle("i1", "|", "(I2\nt", "I0\n", "\xff\1")), ElementsAre(-1, 1));
  EXPECT_THAT(values(array_pickle("f2", "<", "(I1\nt", "I0\n", "\0\x3c"s)), ElementsAre(1));
  EXPECT_THAT(values(array_pickle("f4", "<", ")", "I0\n", "\0\0\xc0\x3f"s)), ElementsAre(1.5));
}

TEST(Pickle, NumPyArraysThatDoNotFit) {
  EXPECT_THAT(rejection(array_pickle("f8", "<", "(I3\nt", "I0\n", "12345678")),
              HasSubstr("shape does not fit"));
  EXPECT_THAT(rejection(array_pickle("f8", "<", "(I-1\nt", "I0\n", "12345678")), HasSubstr("damaged"));
  EXPECT_THAT(rejection(array_pickle("f8", "<", "(L4294967296L\nL4294967296L\nL4294967296L\nt", "I0\n", "")),
              HasSubstr("shape does not fit"));
  EXPECT_THAT(rejection(array_pickle("f99999999999999999999999", "<", "(I1\nt", "I0\n", "1")),
              HasSubstr("does not read"));
  const auto [bytes, text_array] = read(array_pickle("S4", "|", "(I1\nt", "I0\n", "abcd"));
  EXPECT_THAT(text_array->root().array()->to_doubles().error().message(), HasSubstr("'S4'"));
}

TEST(Pickle, BrokenPrograms) {
  EXPECT_THAT(rejection(""), HasSubstr("ends in the middle"));
  EXPECT_THAT(rejection("."), HasSubstr("unfinished"));
  EXPECT_THAT(rejection("(."), HasSubstr("unfinished"));
  EXPECT_THAT(rejection("0."), HasSubstr("not there"));
  EXPECT_THAT(rejection("K\x01(\x85."), HasSubstr("not there")) << "takes a value from below a mark";
  EXPECT_THAT(rejection("h\x05."), HasSubstr("never stored"));
  EXPECT_THAT(rejection("Nr\xff\xff\xff\xff."), HasSubstr("remembers"));
  EXPECT_THAT(rejection("t."), HasSubstr("never began"));
  EXPECT_THAT(rejection("K\x01K\x02"
                        "a."),
              HasSubstr("holds none"));
  EXPECT_THAT(rejection("}(K\x01u."), HasSubstr("without a value"));
  EXPECT_THAT(rejection("K\x01)R."), HasSubstr("no function"));
  EXPECT_THAT(rejection("K\x01K\x02"
                        "b."),
              HasSubstr("no state"));
  EXPECT_THAT(rejection("\x80\x09N."), HasSubstr("protocol 9"));
  EXPECT_THAT(rejection("X\xff\xff\xff\xffhi."), HasSubstr("ends in the middle"));
  EXPECT_THAT(rejection("\x80\x04\x8d\xff\xff\xff\xff\xff\xff\xff\xffhi."), HasSubstr("ends in the middle"));
  EXPECT_THAT(rejection("N\x88Q."), HasSubstr("no tensor storage"));
  EXPECT_THAT(rejection("PK\x03\x04."), HasSubstr("it "));
}

// A few bytes that ask for much: limits come before memory.
TEST(Pickle, Bombs) {
  EXPECT_THAT(rejection(std::string(2'100'000, '}')), HasSubstr("more than 2000000 values"));
  // One tuple of a thousand, made into a list again and again.
  std::string copies = "(" + std::string(1000, 'N') + "tq\1";
  for (int i = 0; i < 20'000; ++i) copies += "c__builtin__\nlist\n(h\1tR0";
  EXPECT_THAT(rejection(copies + "N."), HasSubstr("16000000 items"));
}

TEST(Pickle, TortureOfEveryFixture) {
  const auto root = test::shared_file("fixtures");
  if (!root) GTEST_SKIP() << "no fixtures";
  int count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*root)) {
    if (entry.path().extension() != ".pkl" || entry.file_size() > 10'000) continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    test::torture(
        *read_file(entry.path()),
        [](const Bytes& bytes) {
          const auto pickle = Pickle::parse(bytes, "x", {.keep_foreign = true});
          if (!pickle) return false;
          const auto pickled = pickle->root();
          for (std::size_t i = 0; i < pickled.size(); ++i)
            if (const auto* array = pickled[i].array()) (void)array->to_doubles();
          return true;
        },
        [](std::size_t) { return false; });
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace mien

#include "mien/io/safetensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "mien/base/file.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Safetensors : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("mien_safetensors_" + std::to_string(::getpid()) + "_" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path path(const char* name = "a.safetensors") const { return folder_ / name; }
  fs::path folder_;
};

Bytes with_header(std::string_view json, std::size_t data_size) {
  Bytes bytes(8 + json.size() + data_size, std::byte{1});
  const auto length = static_cast<std::uint64_t>(json.size());
  std::memcpy(bytes.data(), &length, 8);
  std::memcpy(bytes.data() + 8, json.data(), json.size());
  return bytes;
}

std::string rejection(std::string_view json, std::size_t data_size = 0) {
  const auto file = SafetensorsFile::parse(with_header(json, data_size), "x");
  return file ? "accepted" : file.error().message();
}

/// One tensor of each kind, an empty one and a scalar.
Bytes small_file(const fs::path& path) {
  auto writer = SafetensorsWriter::create(path,
                                          {{"mask", Dtype::boolean, {3}},
                                           {"w", Dtype::f32, {2, 3}},
                                           {"half", Dtype::f16, {3}},
                                           {"empty", Dtype::i64, {0, 4}},
                                           {"scalar", Dtype::f64, {}}},
                                          {{"format", "mien"}, {"a", "\xc3\xa4 \"q\""}});
  EXPECT_TRUE(writer);
  EXPECT_TRUE(writer->write("w", std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(writer->write("mask", std::vector<std::uint8_t>{1, 0, 1}));
  EXPECT_TRUE(writer->write("w", std::vector<float>{4, 5, 6}));
  EXPECT_TRUE(writer->write_float_at("half", 1, std::vector<float>{0.5f, -2.0f}));
  EXPECT_TRUE(writer->write_float_at("half", 0, std::vector<float>{1.0f}));
  EXPECT_TRUE(writer->write_float("scalar", std::vector<float>{0.25f}));
  EXPECT_FALSE(fs::exists(path)) << "a name before the file is complete";
  EXPECT_TRUE(writer->finish());
  return *read_file(path);
}

/// Reads everything a file offers, so that a sanitizer sees every address.
std::size_t touch(const SafetensorsFile& file) {
  std::size_t sum = 0;
  for (const auto& tensor : file.tensors()) {
    const auto bytes = file.raw(tensor.name);
    EXPECT_TRUE(bytes);
    for (const auto b : *bytes) sum += static_cast<std::size_t>(b);
    EXPECT_EQ(bytes->size(), static_cast<std::size_t>(tensor.count()) * dtype_size(tensor.dtype));
  }
  return sum;
}

TEST_F(Safetensors, ReadsBackWhatWasWritten) {
  small_file(path());
  const auto file = SafetensorsFile::open(path());
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_EQ(file->metadata(), (Metadata{{"a", "\xc3\xa4 \"q\""}, {"format", "mien"}}));
  ASSERT_EQ(file->tensors().size(), 5u);
  const auto w = file->as<float>("w");
  ASSERT_TRUE(w);
  EXPECT_THAT(*w, testing::ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(file->find("w")->shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_THAT(*file->read_float("half"), testing::ElementsAre(1.0f, 0.5f, -2.0f));
  EXPECT_THAT(*file->read_float("scalar"), testing::ElementsAre(0.25f));
  EXPECT_THAT(*file->as<std::uint8_t>("mask"), testing::ElementsAre(1, 0, 1));
  EXPECT_TRUE(file->as<std::int64_t>("empty")->empty());
  EXPECT_EQ(file->find("absent"), nullptr);
}

TEST_F(Safetensors, SameContentGivesSameBytes) {
  EXPECT_EQ(small_file(path("a.safetensors")), small_file(path("b.safetensors")));
}

TEST_F(Safetensors, AlignsEveryTensorItWrites) {
  const auto bytes = small_file(path());
  EXPECT_EQ(*read_le<std::uint64_t>(bytes, 0) % 8, 0u);
  const auto file = SafetensorsFile::open(path());
  for (const auto& t : file->tensors())
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(file->raw(t.name)->data()) % dtype_size(t.dtype), 0u)
        << t.name;
}

TEST_F(Safetensors, AsksForTheRightTypeAndShape) {
  small_file(path());
  const auto file = SafetensorsFile::open(path());
  EXPECT_THAT(file->as<double>("w").error().message(), HasSubstr("'w': has dtype F32"));
  EXPECT_THAT(file->as<float>("v").error().message(), HasSubstr("no tensor 'v'"));
  EXPECT_THAT(file->read_float("mask").error().message(), HasSubstr("has dtype BOOL"));
  EXPECT_TRUE(file->expect("w", std::vector<std::int64_t>{2, -1}));
  EXPECT_THAT(file->expect("w", std::vector<std::int64_t>{-1, 2}).error().message(),
              HasSubstr("has shape [2, 3], expected [any, 2]"));
  EXPECT_EQ(file->expect("w", std::vector<std::int64_t>{6}).error().code, Errc::incompatible);
}

TEST_F(Safetensors, UnalignedDataOfOldWritersIsReadable) {
  auto bytes = with_header(R"({"x":{"dtype":"F64","shape":[1],"data_offsets":[0,8]}}  )", 0);
  while (bytes.size() % 8 != 3) {  // lengthen the header until the data starts at an odd address
    bytes.push_back(std::byte{' '});
    bytes[0] = static_cast<std::byte>(bytes.size() - 8);
  }
  append_le(bytes, 1.5);
  const auto file = SafetensorsFile::parse(bytes);
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_THAT(*file->as<double>("x"), testing::ElementsAre(1.5));
}

TEST_F(Safetensors, ConvertsSixteenBitFloatsBothWays) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{1.0f, -3.140625f, 1e-3f, 3e38f, inf, 0.0f, std::nanf("")};
  auto writer = SafetensorsWriter::create(path(), {{"b", Dtype::bf16, {7}}, {"h", Dtype::f16, {7}}});
  ASSERT_TRUE(writer->write_float("b", values));
  ASSERT_TRUE(writer->write_float("h", values));
  ASSERT_TRUE(writer->finish());
  const auto file = SafetensorsFile::open(path());
  const auto b = *file->read_float("b"), h = *file->read_float("h");
  for (const std::size_t i : {0, 1, 4, 5}) {
    EXPECT_EQ(b[i], values[i]);
    EXPECT_EQ(h[i], values[i]);
  }
  EXPECT_NEAR(b[2], 1e-3f, 1e-3f / 256);
  EXPECT_NEAR(h[2], 1e-3f, 1e-3f / 2048);
  EXPECT_NEAR(b[3] / 3e38f, 1.0f, 1.0f / 256);
  EXPECT_EQ(h[3], inf);
  EXPECT_TRUE(std::isnan(b[6]) && std::isnan(h[6]));
  EXPECT_EQ(**file->first_non_finite("h"), 3);
  EXPECT_EQ(**file->first_non_finite("b"), 4);
  EXPECT_EQ(file->as<std::uint16_t>("h")->size(), 7u);
}

TEST_F(Safetensors, EmptyFilesOfTensorsAreValid) {
  auto writer = SafetensorsWriter::create(path(), {});
  ASSERT_TRUE(writer->finish());
  const auto file = SafetensorsFile::open(path());
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_TRUE(file->tensors().empty());
}

TEST_F(Safetensors, EveryPrefixIsRejected) {
  const auto bytes = small_file(path());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const auto file =
        SafetensorsFile::parse(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)));
    ASSERT_FALSE(file) << n;
    EXPECT_EQ(file.error().code, Errc::input);
    EXPECT_FALSE(file.error().why.empty());
  }
}

TEST_F(Safetensors, FlippedHeaderBytesNeverCrash) {
  const auto bytes = small_file(path());
  const auto header_end = 8 + *read_le<std::uint64_t>(bytes, 0);
  int accepted = 0;
  for (std::size_t i = 0; i < header_end; ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes broken = bytes;
      broken[i] ^= static_cast<std::byte>(1 << bit);
      const auto file = SafetensorsFile::parse(std::move(broken));
      if (file) touch(*file), ++accepted;
    }
  }
  EXPECT_LT(accepted, static_cast<int>(header_end) * 4);  // letters of names may change, structure may not
}

TEST_F(Safetensors, EachBreachOfTheFormatHasItsMessage) {
  const auto entry = [](std::string_view dtype, std::string_view shape, std::string_view offsets) {
    return R"({"x":{"dtype":")" + std::string(dtype) + R"(","shape":)" + std::string(shape) +
           R"(,"data_offsets":)" + std::string(offsets) + "}}";
  };
  EXPECT_EQ(rejection(entry("F32", "[1]", "[0,4]"), 4), "accepted");
  EXPECT_THAT(rejection(entry("F31", "[1]", "[0,4]"), 4),
              HasSubstr("tensor 'x': has the unknown dtype 'F31'"));
  EXPECT_THAT(rejection(entry("F32", "[-1]", "[0,4]"), 4), HasSubstr("negative number -1"));
  EXPECT_THAT(rejection(entry("F32", "[1.0]", "[0,4]"), 4), HasSubstr("not an integer"));
  EXPECT_THAT(rejection(entry("F32", "[1e99]", "[0,4]"), 4), HasSubstr("not an integer"));
  EXPECT_THAT(rejection(entry("F32", "[18446744073709551615]", "[0,4]"), 4), HasSubstr("beyond 2^63"));
  EXPECT_THAT(rejection(entry("F32", "[4294967296,4294967296,4]", "[0,4]"), 4),
              HasSubstr("too large to exist"));
  EXPECT_THAT(rejection(entry("F32", "[0,4294967296,4294967296,4]", "[0,0]"), 0),
              HasSubstr("too large to exist"));
  EXPECT_THAT(rejection(entry("F32", "[2]", "[0,4]"), 4),
              HasSubstr("needs 8 bytes, data_offsets [0, 4) give 4"));
  EXPECT_THAT(rejection(entry("F32", "[1]", "[4,0]"), 4), HasSubstr("reversed"));
  EXPECT_THAT(rejection(entry("F32", "[1]", "[4,8]"), 4), HasSubstr("past the end"));
  EXPECT_THAT(rejection(entry("F32", "[1]", "[4,8]"), 8), "accepted");  // a gap before it
  EXPECT_THAT(rejection(entry("F32", "[1]", "[0,4]"), 5),
              HasSubstr("1 bytes at the end of the data belong to no tensor"));
  EXPECT_THAT(rejection(entry("F32", "[1]", "[0]"), 4), HasSubstr("1 numbers, expected 2"));
  EXPECT_THAT(rejection(entry("F32", "[[1]]", "[0,4]"), 4), HasSubstr("an array where the format has none"));
  EXPECT_THAT(rejection(entry("F32", "null", "[0,4]"), 4), HasSubstr("null"));
  EXPECT_THAT(rejection(R"({"x":{"dtype":"F32","shape":[1]}})", 4), HasSubstr("no data_offsets"));
  EXPECT_THAT(rejection(R"({"x":{"shape":[1],"data_offsets":[0,4]}})", 4), HasSubstr("no dtype"));
  EXPECT_THAT(rejection(R"({"x":{"dtype":"F32","data_offsets":[0,4]}})", 4), HasSubstr("no shape"));
  EXPECT_THAT(rejection(R"({"x":{"dtype":"F32","dtype":"F32"}})"), HasSubstr("repeated member 'dtype'"));
  EXPECT_THAT(rejection(R"({"x":3})"), HasSubstr("tensor 'x': has a number"));
  EXPECT_THAT(rejection(R"({"__metadata__":{"a":1}})"), HasSubstr("expected a string"));
  EXPECT_THAT(rejection(R"({"__metadata__":{"a":{}}})"), HasSubstr("an object as 'a'"));
  EXPECT_THAT(rejection(R"({"__metadata__":{"a":"1","a":"2"}})"), HasSubstr("the key 'a' twice"));
  EXPECT_THAT(rejection(R"([])"), HasSubstr("does not begin with '{'"));
  EXPECT_THAT(rejection("\xef\xbb\xbf{}"), HasSubstr("does not begin with '{'"));
  EXPECT_THAT(rejection(std::string("{}\0\0", 4)), HasSubstr("NUL"));
  EXPECT_THAT(rejection("{} {}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(rejection("{\"\xff\":1}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(rejection(std::string(200000, '{')), HasSubstr("not valid JSON"));
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += R"({"a":)";
  EXPECT_THAT(rejection(deep), HasSubstr("unexpected or repeated member 'a'"));
  const auto two = [](const char* first, const char* second) {
    return std::string(R"({"a":{"dtype":"U8","shape":[4],"data_offsets":)") + first +
           R"(},"b":{"dtype":"U8","shape":[4],"data_offsets":)" + second + "}}";
  };
  EXPECT_EQ(rejection(two("[4,8]", "[0,4]"), 8), "accepted");
  EXPECT_THAT(rejection(two("[0,4]", "[2,6]"), 6), HasSubstr("tensor 'b': data_offsets [2, 6) overlap"));
  EXPECT_THAT(rejection(two("[0,4]", "[0,4]"), 4), HasSubstr("overlap"));
}

TEST_F(Safetensors, MissingFilesAndFoldersAreErrors) {
  EXPECT_THAT(SafetensorsFile::open(path("none")).error().message(), HasSubstr("file not found"));
  EXPECT_THAT(SafetensorsFile::open(folder_).error().message(), HasSubstr("directory"));
  ASSERT_TRUE(write_file(path("empty"), std::string_view{}));
  EXPECT_THAT(SafetensorsFile::open(path("empty")).error().message(), HasSubstr("it has 0 bytes"));
  EXPECT_FALSE(SafetensorsWriter::create(path("no_folder") / "x", {}));
}

TEST_F(Safetensors, AbandonedWriterLeavesNothing) {
  {
    auto writer = SafetensorsWriter::create(path(), {{"x", Dtype::f32, {1000}}});
    ASSERT_TRUE(writer->write("x", std::vector<float>(10)));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Safetensors, WriterRefusesMisuse) {
  EXPECT_THROW((void)SafetensorsWriter::create(path(), {{"x", Dtype::f32, {1}}, {"x", Dtype::f32, {1}}}),
               std::logic_error);
  EXPECT_THROW((void)SafetensorsWriter::create(path(), {{"__metadata__", Dtype::f32, {1}}}),
               std::logic_error);
  EXPECT_THROW((void)SafetensorsWriter::create(path(), {{"x", Dtype::f32, {-1}}}), std::logic_error);
  EXPECT_THAT(SafetensorsWriter::create(path(), {}, {{"a", "\xff"}}).error().message(),
              HasSubstr("not UTF-8"));
  auto writer = SafetensorsWriter::create(path(), {{"x", Dtype::f32, {2}}});
  EXPECT_THROW((void)writer->write("y", std::vector<float>{1}), std::logic_error);
  EXPECT_THROW((void)writer->write("x", std::vector<double>{1}), std::logic_error);
  EXPECT_THROW((void)writer->write("x", std::vector<float>{1, 2, 3}), std::logic_error);
  EXPECT_THROW((void)writer->write_at("x", 3, std::span<const float>{}), std::logic_error);
  EXPECT_TRUE(writer->write("x", std::vector<float>{1}));
  EXPECT_THROW((void)writer->finish(), std::logic_error);
}

fs::path checkpoint_variants() { return shared_path("fixtures/encoders/checkpoint-variants"); }

TEST(SharedSafetensors, HostileFilesAreRejected) {
  const auto folder = checkpoint_variants() / "reject";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
  int rejected = 0;
  for (const auto& item : fs::directory_iterator(folder)) {
    const auto name = item.path().filename().string();
    if (!name.starts_with("st_")) continue;
    const auto file = SafetensorsFile::open(item.path());
    // Sound as files; what is wrong with them is for the loader of the model to see.
    if (name.starts_with("st_missing_tensor") || name.starts_with("st_wrong_shape") ||
        name.starts_with("st_nan_weight")) {
      ASSERT_TRUE(file) << name << file.error().message();
      touch(*file);
      int broken = 0;
      for (const auto& t : file->tensors()) broken += (*file->first_non_finite(t.name)).has_value();
      EXPECT_EQ(broken, name.starts_with("st_nan_weight") ? 1 : 0) << name;
      continue;
    }
    EXPECT_FALSE(file) << name;
    if (!file) {
      EXPECT_EQ(file.error().code, Errc::input) << name;
    }
    ++rejected;
  }
  EXPECT_GE(rejected, 16);
}

TEST(SharedSafetensors, CheckpointVariantsAreRead) {
  if (!fs::exists(checkpoint_variants())) GTEST_SKIP() << checkpoint_variants() << " is absent";
  std::vector<float> plain;
  for (const char* name : {"01_plain", "23_no_metadata_unpadded_header", "07_f16", "08_bf16", "09_f64"}) {
    const auto file = SafetensorsFile::open(checkpoint_variants() / (std::string(name) + ".safetensors"));
    ASSERT_TRUE(file) << file.error().message();
    touch(*file);
    const auto values = file->read_float("encoder.layer_norm.weight");
    ASSERT_TRUE(values) << values.error().message();
    if (plain.empty()) plain = *values;
    ASSERT_EQ(values->size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_NEAR((*values)[i], plain[i], 0.005) << name;
  }
}

}  // namespace
}  // namespace mien

#include "mien/io/npy.h"

#include <cstring>

#include "io_test_support.h"

namespace mien {
namespace {

using namespace test;

// A file written by hand: header text as given, padded as version 1.0 asks.
Bytes npy(std::string header, const Bytes& data, int version = 1) {
  const std::size_t start = version == 1 ? 10 : 12;
  while ((start + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  Bytes bytes;
  for (const char c : {'\x93', 'N', 'U', 'M', 'P', 'Y'}) bytes.push_back(static_cast<std::byte>(c));
  bytes.push_back(static_cast<std::byte>(version));
  bytes.push_back(std::byte{0});
  if (version == 1)
    append_le(bytes, static_cast<std::uint16_t>(header.size()));
  else
    append_le(bytes, static_cast<std::uint32_t>(header.size()));
  for (const char c : header) bytes.push_back(static_cast<std::byte>(c));
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

template <class T>
Bytes packed(std::initializer_list<T> values) {
  Bytes out;
  for (const T v : values) append_le(out, v);
  return out;
}

TEST(Npy, WritesWhatNumpyWrites) {
  const NpyArray array{{2, 3}, {1, 2, 3, 4, 5, 6}};
  const Bytes expected =
      npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }", packed<float>({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(write_npy(array), expected);
  EXPECT_EQ(npy_header(array.shape).size() % 64, 0u);
  EXPECT_EQ(write_npy({{3}, {1, 2, 3}}),
            npy("{'descr': '<f4', 'fortran_order': False, 'shape': (3,), }", packed<float>({1, 2, 3})));
  EXPECT_EQ(write_npy({{}, {7}}),
            npy("{'descr': '<f4', 'fortran_order': False, 'shape': (), }", packed<float>({7})));
}

TEST(Npy, RoundTripOfAllShapes) {
  const std::vector<std::vector<std::int64_t>> shapes = {{}, {0}, {5}, {0, 3}, {4, 2}, {2, 3, 4}};
  for (const auto& shape : shapes) {
    NpyArray array{shape, {}};
    std::size_t count = 1;
    for (const auto size : shape) count *= static_cast<std::size_t>(size);
    for (std::size_t i = 0; i < count; ++i) array.values.push_back(static_cast<float>(i) * 0.1f);
    const auto read = read_npy(write_npy(array));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->shape, array.shape);
    EXPECT_EQ(read->values, array.values);
  }
}

TEST(Npy, ReadsDoublesAndLaterVersions) {
  const auto doubles = read_npy(
      npy("{\"shape\": (2,), 'descr': '<f8', 'fortran_order': False}", packed<double>({0.5, 1e-3}), 2));
  ASSERT_TRUE(doubles) << doubles.error().message();
  EXPECT_EQ(doubles->values, (std::vector<float>{0.5f, 1e-3f}));
  EXPECT_EQ(read_npy(npy("{}", {}, 4)).error().code, Errc::incompatible);
}

TEST(Npy, RefusesOtherTypesOrdersAndSizes) {
  const Bytes data = packed<float>({1, 2, 3, 4});
  const auto code = [&](const std::string& header) { return read_npy(npy(header, data)).error().code; };
  EXPECT_EQ(code("{'descr': '>f4', 'fortran_order': False, 'shape': (4,), }"), Errc::incompatible);
  EXPECT_EQ(code("{'descr': '<i4', 'fortran_order': False, 'shape': (4,), }"), Errc::incompatible);
  EXPECT_EQ(code("{'descr': '|O', 'fortran_order': False, 'shape': (4,), }"), Errc::incompatible);
  EXPECT_EQ(code("{'descr': '<f4', 'fortran_order': True, 'shape': (4,), }"), Errc::incompatible);
  for (const char* shape : {"(3,)", "(5,)", "(-4,)", "(2.0, 2)", "4", "(4", "(99999999999999999999,)",
                            "(4294967296, 4294967296, 4294967296)", "(4611686018427387905,)"})
    EXPECT_EQ(code(std::string("{'descr': '<f4', 'fortran_order': False, 'shape': ") + shape + ", }"),
              Errc::input)
        << shape;
  EXPECT_EQ(code("{'descr': '<f4', 'shape': (4,), }"), Errc::input);
  EXPECT_EQ(code("{'descr': '<f4', 'fortran_order': Maybe, 'shape': (4,), }"), Errc::input);
  EXPECT_EQ(code("['descr']"), Errc::input);
  EXPECT_EQ(code("{'descr': '<f4', 'fortran_order': False, 'shape': (4,), } x"), Errc::input);
  EXPECT_THROW((void)write_npy({{2}, {1}}), std::logic_error);
  EXPECT_THROW((void)npy_header(std::vector<std::int64_t>{-1}), std::logic_error);
}

TEST(Npy, SurvivesTruncationAndFlippedBytes) {
  torture(
      write_npy({{2, 3}, {1, 2, 3, 4, 5, 6}}), [](const Bytes& b) { return read_npy(b).has_value(); },
      [](std::size_t) { return false; });
  torture(
      npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }", packed<double>({1, 2}), 3),
      [](const Bytes& b) { return read_npy(b).has_value(); }, [](std::size_t) { return false; });
}

}  // namespace
}  // namespace mien

#include "mien/render/image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <limits>

#include "mien/base/file.h"
#include "mien/base/random.h"
#include "mien/render/png.h"
#include "mien/render/text.h"

namespace mien {
namespace {

Image noise(int width, int height) {
  Image image(width, height);
  Rng rng(7);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint32_t bits = rng.bits();
      image.at(x, y) = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
                        static_cast<std::uint8_t>(bits >> 16)};
    }
  return image;
}

int count(const Image& image, Rgb8 color) {
  int n = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) n += image.at(x, y) == color ? 1 : 0;
  return n;
}

TEST(Image, BlitAndRectanglesAreClipped) {
  const Rgb8 red{255, 0, 0};
  for (const auto& [x, y, covered] : {std::array{-2, -3, 4}, std::array{8, 9, 2}, std::array{3, 3, 20},
                                      std::array{-4, 0, 0}, std::array{0, 10, 0}, std::array{100, -100, 0}}) {
    Image target(10, 10);
    fill_rectangle(target, x, y, 4, 5, red);
    Image other(10, 10);
    blit(other, Image(4, 5, red), x, y);
    EXPECT_EQ(target, other) << x << " " << y;
    EXPECT_EQ(count(target, red), covered) << x << " " << y;
  }
}

TEST(Image, LinesMayLeaveThePictureOrBeBroken) {
  Image image(20, 20);
  draw_line(image, -100, 10, 100, 10, 1, {255, 255, 255});
  EXPECT_EQ(image.at(0, 10).r, 255);
  EXPECT_EQ(image.at(19, 10).r, 255);
  EXPECT_EQ(image.at(10, 12).r, 0);
  Image same = image;
  draw_line(same, 0, std::numeric_limits<float>::quiet_NaN(), 5, 5, 1, {255, 0, 0});
  draw_line(same, 0, 0, std::numeric_limits<float>::infinity(), 5, 1, {255, 0, 0});
  EXPECT_EQ(same, image);
  draw_line(same, 1e9f, 1e9f, 2e9f, 2e9f, 3, {255, 0, 0});
  EXPECT_EQ(same, image);
}

TEST(Text, EveryPrintableLetterIsDifferentAndOthersAreBoxes) {
  std::vector<Image> seen;
  for (char c = ' '; c <= '~'; ++c) {
    Image image(kTextAdvance, kTextHeight, {255, 255, 255});
    draw_text(image, 0, 0, std::string(1, c));
    for (const Image& other : seen) EXPECT_FALSE(image == other) << c;
    seen.push_back(image);
  }
  Image box(6, 10), other_box(6, 10);
  draw_text(box, 0, 0, "\n");
  draw_text(other_box, 0, 0, "\xc3");
  EXPECT_EQ(box, other_box);
}

TEST(Text, IsClippedAndCut) {
  Image image(10, 10, {255, 255, 255});
  draw_text(image, -3, -3, "MMMM", {{0, 0, 0}, 2});
  draw_text(image, 500, 500, "M");
  EXPECT_GT(count(image, {0, 0, 0}), 5);
  EXPECT_EQ(text_width("abc", 2), 36);
  EXPECT_EQ(fit_text("jawOpen", 100), "jawOpen");
  EXPECT_EQ(fit_text("jawOpen", 30), "jaw..");
  EXPECT_EQ(fit_text("jawOpen", 12), "ja");
  EXPECT_EQ(fit_text("jawOpen", 0), "");
}

TEST(Png, RoundTripsAndRepeatsItsBytes) {
  for (const auto& [w, h] : {std::pair(1, 1), std::pair(37, 5), std::pair(3, 64)}) {
    const Image image = noise(w, h);
    const auto bytes = encode_png(image);
    ASSERT_TRUE(bytes.has_value());
    EXPECT_EQ(*bytes, *encode_png(image));
    const auto back = decode_png(*bytes);
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(*back, image);
  }
  EXPECT_FALSE(encode_png(Image()).has_value());
}

TEST(Png, EveryTruncationIsAnError) {
  const Bytes whole = *encode_png(noise(9, 7));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(decode_png(cut).has_value()) << n;
  }
}

TEST(Png, FlippedBytesDoNotCrash) {
  const Bytes whole = *encode_png(noise(9, 7));
  for (std::size_t n = 0; n < whole.size(); ++n)
    for (const int flip : {0x01, 0x80, 0xff}) {
      Bytes broken = whole;
      broken[n] ^= static_cast<std::byte>(flip);
      const auto image = decode_png(broken);
      if (image.has_value()) {
        EXPECT_LE(image->width(), 8192);
      }
    }
  Bytes huge = whole;  // a width of 2^31 - 1
  huge[16] = std::byte{0x7f}, huge[17] = huge[18] = huge[19] = std::byte{0xff};
  EXPECT_FALSE(decode_png(huge).has_value());
}

TEST(Png, FilesNameTheirProblem) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("mien_png_test_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const Image image = noise(12, 4);
  ASSERT_TRUE(write_png(folder / "a.png", image).has_value());
  EXPECT_EQ(*read_png(folder / "a.png"), image);
  const auto missing = read_png(folder / "b.png");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, Errc::input);
  ASSERT_TRUE(write_file(folder / "c.png", "no picture").has_value());
  const auto text = read_png(folder / "c.png");
  ASSERT_FALSE(text.has_value());
  EXPECT_NE(text.error().message().find("c.png"), std::string::npos);
  EXPECT_FALSE(write_png(folder / "no_folder" / "a.png", image).has_value());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace mien

#include "mien/render/png.h"

#include <png.h>

#include <csetjmp>
#include <cstring>
#include <string>

#include "mien/base/file.h"

namespace mien {
namespace {

constexpr png_uint_32 kMaxPngSide = 8192;

// What libpng's callbacks share. libpng leaves through longjmp, so nothing with a destructor may live in a
// frame that it jumps over: the encoder and the decoder below keep all of that in this struct, outside of
// setjmp.
struct Session {
  std::string message;
  Bytes written;
  std::span<const std::byte> input;
  std::vector<png_bytep> rows;
  std::vector<std::uint8_t> pixels;
  png_uint_32 width = 0, height = 0;
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  static_cast<Session*>(png_get_error_ptr(png))->message = text;
  longjmp(png_jmpbuf(png), 1);
}
void on_warning(png_structp, png_const_charp) {}
void on_write(png_structp png, png_bytep data, png_size_t size) {
  Bytes& out = static_cast<Session*>(png_get_io_ptr(png))->written;
  const auto* p = reinterpret_cast<const std::byte*>(data);
  out.insert(out.end(), p, p + size);
}
void on_flush(png_structp) {}
void on_read(png_structp png, png_bytep data, png_size_t size) {
  auto& session = *static_cast<Session*>(png_get_io_ptr(png));
  if (session.input.size() < size) png_error(png, "the file ends too early");
  std::memcpy(data, session.input.data(), size);
  session.input = session.input.subspan(size);
}

bool run_encoder(Session& session, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &session, on_write, on_flush);
  png_set_IHDR(png, info, session.width, session.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 6);
  png_set_rows(png, info, session.rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  return true;
}

bool run_decoder(Session& session, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &session, on_read);
  png_set_user_limits(png, kMaxPngSide, kMaxPngSide);
  png_set_chunk_malloc_max(png, 1 << 24);
  png_read_info(png, info);
  session.width = png_get_image_width(png, info);
  session.height = png_get_image_height(png, info);
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_strip_alpha(png);
  png_set_gray_to_rgb(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  const std::size_t stride = png_get_rowbytes(png, info);
  if (stride != std::size_t{3} * session.width) png_error(png, "cannot be turned into 8-bit RGB");
  session.pixels.resize(stride * session.height);
  for (png_uint_32 y = 0; y < session.height; ++y) session.rows.push_back(session.pixels.data() + y * stride);
  png_read_image(png, session.rows.data());
  png_read_end(png, nullptr);
  return true;
}

}  // namespace

Result<Bytes> encode_png(const Image& image) {
  if (image.empty()) return Error{Errc::failed, "PNG", "the picture has no pixels", ""};
  static_assert(sizeof(Rgb8) == 3);
  Session session;
  session.width = static_cast<png_uint_32>(image.width());
  session.height = static_cast<png_uint_32>(image.height());
  for (int y = 0; y < image.height(); ++y)  // libpng takes rows to write without const
    session.rows.push_back(const_cast<png_bytep>(reinterpret_cast<png_const_bytep>(image.row(y))));
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool done = info != nullptr && run_encoder(session, png, info);
  png_destroy_write_struct(&png, &info);
  if (!done) return Error{Errc::failed, "PNG", "encoding failed: " + session.message, ""};
  return std::move(session.written);
}

Result<Image> decode_png(std::span<const std::byte> bytes) {
  if (bytes.size() < 8 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
    return Error{Errc::input, "PNG", "the file does not begin as a PNG does", ""};
  Session session;
  session.input = bytes;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool done = info != nullptr && run_decoder(session, png, info);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done) return Error{Errc::input, "PNG", "cannot be decoded: " + session.message, ""};
  Image image(static_cast<int>(session.width), static_cast<int>(session.height));
  std::memcpy(static_cast<void*>(image.row(0)), session.pixels.data(), session.pixels.size());
  return image;
}

Status write_png(const std::filesystem::path& path, const Image& image) {
  auto bytes = encode_png(image);
  if (!bytes) return within(bytes.error(), "'" + path.string() + "'");
  return write_file(path, *bytes);
}

Result<Image> read_png(const std::filesystem::path& path) {
  MIEN_TRY(const auto bytes, read_file(path));
  auto image = decode_png(bytes);
  if (!image) return within(image.error(), "'" + path.string() + "'");
  return image;
}

}  // namespace mien

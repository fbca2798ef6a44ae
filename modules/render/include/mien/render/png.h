#pragma once
#include <filesystem>
#include <span>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/render/image.h"

namespace mien {

/// A PNG file of 8-bit RGB; the same picture gives the same bytes. Errors (Errc::failed): a picture without
/// pixels.
Result<Bytes> encode_png(const Image& image);

/// Any PNG as 8-bit RGB; transparency is dropped. Errors (Errc::input): not a PNG, damaged, or larger than
/// 8192 pixels on a side.
Result<Image> decode_png(std::span<const std::byte> bytes);

/// Appears under its name only when complete. Errors (Errc::failed): cannot be written.
Status write_png(const std::filesystem::path& path, const Image& image);

/// Errors (Errc::input): missing, unreadable, or as decode_png.
Result<Image> read_png(const std::filesystem::path& path);

}  // namespace mien

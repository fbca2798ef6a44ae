#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mien/base/bytes.h"

namespace mien::io {

/// RFC 4648 base64 with the standard alphabet and padding.
std::string base64_encode(std::span<const std::byte> bytes);
/// Nothing when the text is not base64. Missing padding is accepted, since some exporters leave it out.
std::optional<Bytes> base64_decode(std::string_view text);

}  // namespace mien::io

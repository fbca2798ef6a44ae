#pragma once

namespace mien {

/// Whether the libraries carry the address sanitizer: a measurement means nothing there and takes minutes.
[[nodiscard]] bool has_address_sanitizer();

}  // namespace mien

#pragma once
#include "mien/base/result.h"

namespace mien {

/// A field of an encoder's configuration that cannot be.
inline Error encoder_refusal(const std::string& field, const std::string& why) {
  return {Errc::incompatible, "encoder configuration: " + field, why, ""};
}

}  // namespace mien

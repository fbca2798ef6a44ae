#pragma once
#include "mien/base/result.h"

namespace mien {

/// A model file whose parts do not go together.
inline Error unfit(const std::string& why) {
  return {Errc::incompatible, "model", why, "The file may be damaged; import the checkpoint again"};
}

}  // namespace mien

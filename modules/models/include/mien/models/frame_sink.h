#pragma once
#include <functional>
#include <span>

#include "mien/base/result.h"

namespace mien {

/// Receives the next frames of a take, [count, C]. Frames of one take come in order; different takes may come
/// from different threads at once. An error stops the work.
using FrameSink = std::function<Status(int take, std::span<const float> values)>;

}  // namespace mien

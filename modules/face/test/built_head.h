#pragma once
#include "head/head_model.h"
#include "mien/core/arkit.h"
#include "mien/face/default_head.h"

namespace mien::test {

/// Built once per test program.
inline const head::HeadModel& built_model() {
  static const head::HeadModel model = head::build_head_model(2);
  return model;
}
/// With the plain mouth outline of the reference.
inline const head::HeadModel& reference_model() {
  static const head::HeadModel model = head::build_head_model(2, {.mouth_corner_lift = 0});
  return model;
}
inline const DefaultHead& built_head() {
  static const DefaultHead head = build_default_head(2);
  return head;
}

/// Offsets of the skin in centimetres.
inline const head::Offsets& skin_shape(std::string_view name) {
  return built_model().parts.front().shapes[arkit_index(name)];
}

}  // namespace mien::test

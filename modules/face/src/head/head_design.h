#pragma once

namespace mien::head {

/// Knobs of the head's construction.
struct HeadDesign {
  /// How far the corners of the mouth's outline lie above its middle line, cm. The contact line rises by 0.16
  /// towards its corners; an outline that does not follow (0) makes slivers there, which fold over in a
  /// smile.
  double mouth_corner_lift = 0.16;
};

}  // namespace mien::head

#pragma once
#include <functional>
#include <initializer_list>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "head/handles.h"
#include "head/jaw_motion.h"

namespace mien::head {

/// What every shape is built on.
struct ShapeBase {
  const HeadSkin& skin;
  Handles handles;
  std::vector<bool>
      still_or_given;  ///< [V] neck, scalp, back (still), mouth rings and lids (given by formulas)
};
ShapeBase make_shape_base(const HeadSkin& skin);

/// Where a lip vertex sits along the mouth.
struct LipPlace {
  double along;  ///< -1 right corner ... 1 left corner
  bool upper;
  double outline_x, contact_x;  ///< x of the lip's outline and of the contact line here, cm
};
/// Offset of the outline or the contact line, cm.
using LipOffset = std::function<Vec3d(const LipPlace&)>;
/// Additional offset of lip ring `ring` (0 outline, 5 contact, 7 inside).
using LipRoll = std::function<Vec3d(const LipPlace&, int ring)>;

/// Motion of one eye's lids, cm at the middle of the edge; `closed` shuts the eye.
struct LidMove {
  double upper = 0, lower = 0;
  bool closed = false;
};

/// Index into HeadSkin::eyes.
enum class EyeIndex : std::size_t { left = 0, right = 1 };

using HandleMoves = std::vector<std::pair<std::string, Vec3d>>;
/// The moves with "L" after every name.
HandleMoves on_left(const HandleMoves& moves);
/// The moves on the left and, mirrored, on the right.
HandleMoves on_both(const HandleMoves& moves);

/// A shape before spreading: offsets that are prescribed, and which handles are held (spec section 7).
class ShapeTarget {
 public:
  explicit ShapeTarget(const ShapeBase& base);

  ShapeTarget& lips(const LipOffset& outline, const LipOffset& contact, const LipRoll& roll = {});
  ShapeTarget& lids(EyeIndex eye, const LidMove& move);
  /// Everything that hangs on the lower jaw.
  ShapeTarget& jaw(const JawMotion& motion);
  ShapeTarget& handles(const HandleMoves& moves);
  /// Adds to what is already prescribed at a handle or on a vertex.
  ShapeTarget& add_at_handle(const std::string& handle, Vec3d offset);
  void add(std::uint32_t vertex, Vec3d offset) { offsets_[vertex] += offset; }

  [[nodiscard]] const Offsets& offsets() const { return offsets_; }
  [[nodiscard]] const std::set<std::string>& held() const { return held_; }

 private:
  const ShapeBase* base_;
  Offsets offsets_;             // [V] zero where nothing is prescribed
  std::set<std::string> held_;  // handles that are known in the spreading
};

}  // namespace mien::head

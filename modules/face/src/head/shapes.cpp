#include "head/shapes.h"

#include "head/thin_plate.h"
#include "mien/base/parallel.h"
#include "mien/core/arkit.h"

namespace mien::head {
namespace {

// Spreads all targets; shapes that hold the same handles share one factorisation.
std::map<std::string, Offsets> spread(const ShapeBase& base, const ShapeTargets& targets, int num_threads) {
  std::map<std::string, Offsets> fields;
  std::map<std::set<std::string>, std::vector<Offsets*>> by_handles;
  for (const auto& [name, target] : targets) {
    Offsets& field = fields[name] = target.offsets();
    by_handles[target.held()].push_back(&field);
  }
  struct Group {
    std::vector<bool> known;
    std::vector<Offsets*> fields;
  };
  std::vector<Group> groups;
  for (auto& [held, members] : by_handles) {
    Group group{base.still_or_given, members};
    for (const auto& name : held) group.known[base.handles.at(name)] = true;
    groups.push_back(std::move(group));
  }
  const ThinPlate plate(base.skin.positions, base.skin.triangles);
  parallel_for(num_threads, static_cast<std::int64_t>(groups.size()), [&](std::int64_t g) {
    const Group& group = groups[static_cast<std::size_t>(g)];
    plate.spread(group.known, group.fields);
  });
  return fields;
}

Offsets mirrored_field(const Offsets& field, const std::vector<std::uint32_t>& mirror) {
  Offsets out(field.size());
  for (std::size_t v = 0; v < field.size(); ++v) out[v] = mirrored(field[mirror[v]]);
  return out;
}

}  // namespace

std::vector<Offsets> build_skin_shapes(const ShapeBase& base, int num_threads) {
  ShapeTargets targets;
  add_jaw_targets(base, targets);
  add_corner_targets(base, targets);
  add_lip_targets(base, targets);
  add_upper_face_targets(base, targets);
  const auto fields = spread(base, targets, num_threads);

  std::vector<Offsets> shapes;
  for (const auto name : arkit_names()) {
    const bool left = name.ends_with("Left"), right = name.ends_with("Right");
    const std::string built =
        right ? std::string(name.substr(0, name.size() - 5)) + "Left" : std::string(name);
    const auto found = fields.find(built);
    if (found == fields.end()) {  // moves eyeballs or tongue only
      shapes.emplace_back(base.skin.positions.size());
      continue;
    }
    const Offsets other = mirrored_field(found->second, base.skin.mirror);
    if (left) {
      shapes.push_back(found->second);
    } else if (right) {
      shapes.push_back(other);
    } else {  // rounding aside it is symmetric; make it exact
      Offsets mean(other.size());
      for (std::size_t v = 0; v < mean.size(); ++v) mean[v] = 0.5 * (found->second[v] + other[v]);
      shapes.push_back(std::move(mean));
    }
  }
  return shapes;
}

}  // namespace mien::head

#include "head/head_model.h"

#include "head/lashes.h"
#include "head/part_motion.h"
#include "head/shapes.h"

namespace mien::head {

HeadModel build_head_model(int num_threads, const HeadDesign& design) {
  HeadModel model;
  model.skin = build_head_skin(design);
  const ShapeBase base = make_shape_base(model.skin);
  model.handles = base.handles;
  auto skin_shapes = build_skin_shapes(base, num_threads);

  const auto add = [&](std::string name, Part mesh) {
    model.parts.push_back({std::move(name), std::move(mesh), {}});
    return &model.parts.back();
  };
  add("skin", {model.skin.positions, model.skin.triangles, skin_colors(model.skin)});
  for (const auto& [name, side] : {std::pair{"eyeLeft", BodySide::left}, {"eyeRight", BodySide::right}}) {
    MovingPart* eye = add(name, build_eyeball(side));
    eye->shapes = eyeball_shapes(eye->mesh, side);
  }
  add("eyeCornersLeft", build_eye_corners(BodySide::left));
  add("eyeCornersRight", build_eye_corners(BodySide::right));
  for (const auto& [name, jaw] : {std::pair{"teethUpper", Jaw::upper}, {"teethLower", Jaw::lower}}) {
    MovingPart* teeth = add(name, build_teeth(jaw, model.skin.contact_z));
    teeth->shapes = teeth_shapes(teeth->mesh, jaw);
  }
  MovingPart* tongue = add("tongue", build_tongue(model.skin.contact_z));
  tongue->shapes = tongue_shapes(tongue->mesh);
  for (const auto& [name, side] : {std::pair{"browLeft", BodySide::left}, {"browRight", BodySide::right}}) {
    MovingPart* brow = add(name, build_brow(side));
    brow->shapes = follow_skin(brow->mesh, model.skin, skin_shapes);
  }
  for (const auto& [name, eye] : {std::pair{"lashesLeft", 0}, {"lashesRight", 1}}) {
    Lashes lashes = build_lashes(model.skin, static_cast<std::size_t>(eye));
    auto shapes = lash_shapes(lashes, skin_shapes);
    add(name, std::move(lashes.mesh))->shapes = std::move(shapes);
  }
  add("earLeft", build_ear(BodySide::left));
  add("earRight", build_ear(BodySide::right));
  add("hair", build_hair());
  model.parts.front().shapes = std::move(skin_shapes);
  return model;
}

}  // namespace mien::head

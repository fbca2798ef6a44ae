#include "head/head_model.h"

#include "head/part_motion.h"
#include "head/shapes.h"

namespace mien::head {

HeadModel build_head_model(int num_threads) {
  HeadModel model;
  model.skin = build_head_skin();
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
  add("earLeft", build_ear(BodySide::left));
  add("earRight", build_ear(BodySide::right));
  add("hair", build_hair());
  model.parts.front().shapes = std::move(skin_shapes);
  return model;
}

}  // namespace mien::head

#include <array>

#include "mien/io/gltf_animation.h"
#include "mien/io/gltf_reader.h"
#include "mien/io/gltf_writer.h"
#include "target.h"

namespace mien::fuzz {
namespace {

Character small_character() {
  CharacterPart skin;
  skin.name = "skin";
  skin.mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0.1f, 0.1f, 0.02f}, {0, 0.1f, 0}};
  skin.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  skin.mesh.normals = vertex_normals(skin.mesh.positions, skin.mesh.triangles);
  skin.shapes = {{"jawOpen", {0, 1}, {{0, -0.02f, 0.001f}, {0, -0.01f, 0}}, {}},
                 {"mouthClose", {0}, {{0, 0.02f, 0}}, {}}};
  Character character;
  character.name = "small";
  character.parts = {skin};
  character.regions = {{"lips", {0, 1}}};
  return character;
}

const Motion& small_motion() {
  static const Motion motion{
      MotionSpace::arkit, {"jawOpen", "mouthClose", "headYaw"}, 30, {0, 0, 1, 0.5f, 0.1f, 2, 0.2f, 0, 3}};
  return motion;
}

std::vector<Bytes> seeds() {
  const Bytes still = *write_glb(small_character());
  const std::string data(56, 'A');  // 42 bytes of zeros: three positions and three indices
  return {
      still, *animate_glb(still, small_motion(), "a.wav"),
      *animate_glb(still, small_motion(), "", {.name = "s", .quantised = true}),
      bytes_of(
          R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,)"
          R"("children":[1],"translation":[0,1,0]},{"name":"head","scale":[1,2,1]}],"meshes":[{)"
          R"("extras":{"targetNames":["jawOpen"]},"primitives":[{"attributes":{"POSITION":0},)"
          R"("indices":1,"targets":[{"POSITION":0}]}]}],"accessors":[{"bufferView":0,"componentType":5126,)"
          R"("count":3,"type":"VEC3"},{"bufferView":0,"byteOffset":36,"componentType":5123,"count":3,)"
          R"("type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":42}],"buffers":[{"byteLength":42,)"
          R"("uri":"data:application/octet-stream;base64,)" +
          data + "\"}]}")};
}

Outcome read(std::span<const std::byte> bytes) {
  const auto character = read_glb(bytes);
  std::size_t size = 0;
  if (character) {
    for (const auto& part : character->parts) size += part.mesh.positions.size() + part.shapes.size();
    (void)write_glb(*character);  // its contract holds for whatever the reader lets in
  }
  const auto motion = read_glb_motion(bytes);
  const auto animated = animate_glb(bytes, small_motion(), "a.wav");
  Outcome outcome = outcome_of(character, size);
  outcome.how += " | " + outcome_of(motion, motion ? motion->values.size() : 0).how + " | " +
                 outcome_of(animated, 0).how;
  outcome.is_read = outcome.is_read || motion.has_value() || animated.has_value();
  return outcome;
}

constexpr std::array<std::string_view, 26> kWords = {
    "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5125},\"values\":{"
    "\"bufferView\":0}},",
    "\"normalized\":true,",
    "\"byteStride\":4,",
    "\"byteOffset\":8,",
    "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],",
    "\"rotation\":[0,0,0,1],",
    "\"skin\":0,",
    "\"mode\":1,",
    "\"children\":[0],",
    "\"weights\":[1,1],",
    "\"interpolation\":\"STEP\",",
    "\"interpolation\":\"CUBICSPLINE\",",
    "5120",
    "5121",
    "5125",
    "\"VEC4\"",
    "\"SCALAR\"",
    "\"MAT4\"",
    "\"KHR_draco_mesh_compression\"",
    "data:;base64,AAAA",
    "null",
    "[",
    "]",
    "{",
    "}",
    "\"targetNames\":[\"jawOpen\",\"jawOpen\"],"};

}  // namespace

Target gltf_target() { return {"gltf", &seeds, &read, kWords}; }

}  // namespace mien::fuzz

// Writes one .glb of every kind that Mien makes into a folder, for validate.mjs: gltf_samples FOLDER
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/io/character_file.h"
#include "mien/io/gltf_animation.h"
#include "mien/io/gltf_writer.h"
#if MIEN_HAS_FACE
#include "mien/face/default_head.h"
#include "test_paths.h"
#endif

namespace {

using namespace mien;
namespace fs = std::filesystem;

fs::path folder;

void save(const std::string& name, const Result<Bytes>& bytes) {
  if (!bytes) {
    std::cerr << name << ": " << bytes.error().message() << "\n";
    std::exit(1);
  }
  if (const auto done = write_file(folder / name, *bytes); !done) {
    std::cerr << done.error().message() << "\n";
    std::exit(1);
  }
}

Motion motion_of(std::int64_t num_frames) {
  Motion motion{MotionSpace::arkit, arkit_and_head_channels(), 60, {}};
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (std::size_t c = 0; c < motion.channels.size(); ++c) {
      const double wave = std::sin(0.1 * static_cast<double>(n) + static_cast<double>(c));
      motion.values.push_back(static_cast<float>(c < kNumArkit ? 0.5 + 0.5 * wave : 8 * wave));
    }
  return motion;
}

// Still and animated; in full: also without normals, animated with quantised weights, animated twice, and one
// frame.
void save_all(const std::string& name, const Character& character, bool in_full) {
  const auto still = write_glb(character);
  save(name + ".glb", still);
  bool moves = false;
  for (const auto& part : character.parts) moves = moves || !part.shapes.empty();
  if (!moves) return;
  const auto animated = animate_glb(*still, motion_of(90), "voice.wav");
  save(name + "_animated.glb", animated);
  if (!in_full) return;
  save(name + "_plain.glb", write_glb(character, {.normals = false}));
  save(name + "_twice.glb", animate_glb(*animated, motion_of(10), "again.wav", {.name = "again"}));
  save(name + "_quantised.glb",
       animate_glb(*still, motion_of(91), "voice.wav", {.name = "speech", .quantised = true}));
  save(name + "_frame.glb", animate_glb(*still, motion_of(1), ""));
}

// Parts with and without shapes, untouched targets, zero-area triangles and a vertex that no triangle uses.
Character odd_character() {
  Character character;
  character.name = "odd";
  CharacterPart skin{"skin", {}, {}};
  skin.mesh.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0.1f, 0.1f, 0}, {0, 0.1f, 0}, {0.5f, 0.5f, 0.5f}};
  skin.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 0, 1}};
  skin.mesh.colors.assign(5, {0.5f, 2.0f, -1.0f, 1.0f});
  skin.shapes = {{"jawOpen", {0, 1}, {{0, -0.1f, 0}, {0, -0.1f, 0}}, {}},
                 {"mouthClose", {}, {}, {}},
                 {"collapse", {0, 1, 2}, {{0.1f, 0.1f, 0}, {0, 0.1f, 0}, {}}, {}}};
  CharacterPart eyes{"eyes", {}, {}};
  eyes.mesh.positions = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  eyes.mesh.triangles = {{0, 1, 2}};
  eyes.shapes = {{"eyeLookUpLeft", {2}, {{0, 0.01f, 0}}, {}}};
  CharacterPart hair{"hair", {}, {}};
  hair.mesh = eyes.mesh;
  character.parts = {skin, eyes, hair};
  character.regions = {{"lips", {0, 1}}};
  return character;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: gltf_samples FOLDER\n";
    return 2;
  }
  folder = argv[1];
  save_all("odd", odd_character(), true);
#if MIEN_HAS_FACE
  save_all("default_head", default_head(), true);
#endif
  const fs::path faces = shared_path("faces");
  for (const char* name : {"ict_facekit", "makehuman_head", "arkit_reference", "mediapipe_canonical"}) {
    const fs::path path = faces / (std::string(name) + ".safetensors");
    if (!fs::exists(path)) continue;
    const auto character = load_character(path);
    if (!character) {
      std::cerr << character.error().message() << "\n";
      return 1;
    }
    save_all(name, *character, false);
  }

  // A file that is wrong in one number, to see that the check sees it: a normal of length zero.
  Bytes broken = *write_glb(odd_character());
  const float one = 1, zero = 0;
  for (std::size_t at = 20; at + 4 <= broken.size(); at += 4)
    if (std::memcmp(&broken[at], &one, 4) == 0) std::memcpy(&broken[at], &zero, 4);
  save("broken.bin", std::move(broken));
  return 0;
}

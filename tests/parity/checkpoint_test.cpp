// What later systems save, read without Python: Lightning checkpoints, newer zip layouts, pickled face
// models.
#include <gtest/gtest.h>

#include <fstream>

#include "fixture.h"
#include "mien/io/pickle.h"
#include "mien/io/torch_checkpoint.h"

namespace mien::parity {
namespace {

namespace fs = std::filesystem;

// Every tensor that both hold is equal; gives their number.
int compare(const TorchCheckpoint& checkpoint, const SafetensorsFile& recorded) {
  int common = 0;
  for (const auto& tensor : recorded.tensors()) {
    const auto* stored = checkpoint.find(tensor.name);
    if (stored == nullptr) continue;
    ++common;
    EXPECT_EQ(stored->shape, tensor.shape) << tensor.name;
    EXPECT_EQ(checkpoint.read_float(tensor.name).value(), recorded.read_float(tensor.name).value())
        << tensor.name;
  }
  return common;
}

TEST(CheckpointParity, ProbTalk3D) {
  const fs::path folder = fixture_root() / "probtalk3d";
  if (!fs::exists(folder)) GTEST_SKIP() << "no recorded probtalk3d in " << fixture_root();
  const Fixture emotional("probtalk3d", "facediffuser_emo.safetensors");
  for (const char* file : {"facediffuser_emo_state_dict.pth", "facediffuser_emo_state_dict_newzip.pth"}) {
    const auto checkpoint = TorchCheckpoint::open(folder / file);
    ASSERT_TRUE(checkpoint) << checkpoint.error().message();
    EXPECT_EQ(compare(*checkpoint, emotional.file()), static_cast<int>(checkpoint->tensors().size()));
  }
  const auto lightning = TorchCheckpoint::open(folder / "stage2_last.ckpt");
  ASSERT_TRUE(lightning) << lightning.error().message();
  EXPECT_GT(compare(*lightning, Fixture("probtalk3d", "stage2_audio.safetensors").file()), 100);
  std::ifstream list(folder / "stage2_last_tensors.json");
  const auto names = nlohmann::json::parse(list);
  EXPECT_EQ(lightning->tensors().size(), names.size());
  for (const auto& [name, shape] : names.items()) {
    const auto* tensor = lightning->find(name);
    ASSERT_NE(tensor, nullptr) << name;
    EXPECT_EQ(tensor->shape, shape.get<Shape>()) << name;
  }
}

TEST(CheckpointParity, PickledFaceModel) {
  const fs::path file = fixture_root() / "probtalk3d/flame_synthetic.pkl";
  if (!fs::exists(file)) GTEST_SKIP() << "no recorded " << file;
  const auto pickle = Pickle::open(file, {.keep_foreign = true});
  ASSERT_TRUE(pickle) << pickle.error().message();
  const auto root = pickle->root();
  const Fixture recorded("probtalk3d", "flame_synthetic.safetensors");
  const auto expect = [&](const PickleArray* array, const char* name) {
    ASSERT_NE(array, nullptr) << name;
    const auto want = recorded.file().read_float(name).value();
    const auto got = array->to_doubles();
    ASSERT_TRUE(got) << got.error().message();
    ASSERT_EQ(got->size(), want.size()) << name;
    for (std::size_t i = 0; i < want.size(); ++i)
      ASSERT_EQ(static_cast<float>((*got)[i]), want[i]) << name << " " << i;
  };
  expect(root.find("v_template")->array(), "model.v_template");
  expect(root.find("weights")->array(), "model.weights");
  const auto shapes = *root.find("shapedirs");
  EXPECT_EQ(shapes.class_name(), "chumpy.ch.Ch");
  expect(shapes.state()->find("x")->array(), "model.shapedirs");
  const auto faces = root.find("f")->array()->to_doubles().value();
  const auto want_faces = recorded.integers("model.faces");
  ASSERT_EQ(faces.size(), want_faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) ASSERT_EQ(faces[i], static_cast<double>(want_faces[i]));

  const auto sparse = *root.find("J_regressor");
  EXPECT_EQ(sparse.class_name(), "scipy.sparse.csc.csc_matrix");
  const auto member = [&](const char* name) {
    return sparse.state()->find(name)->array()->to_doubles().value();
  };
  const auto rows = member("indices"), starts = member("indptr"), values = member("data");
  const auto want = recorded.doubles("model.J_regressor");
  const std::size_t columns = starts.size() - 1;
  std::vector<double> dense(want.size(), 0.0);
  for (std::size_t c = 0; c < columns; ++c)
    for (auto k = static_cast<std::size_t>(starts[c]); k < static_cast<std::size_t>(starts[c + 1]); ++k)
      dense.at(static_cast<std::size_t>(rows[k]) * columns + c) = values[k];
  EXPECT_EQ(dense, want);
}

}  // namespace
}  // namespace mien::parity

// Preparation of data sets against recorded results.
#include <algorithm>

#include "closeness.h"
#include "fixture.h"
#include "mien/base/file.h"
#include "mien/datasets/scaling.h"
#include "mien/datasets/templates.h"
#include "mien/io/vl.h"

namespace mien::parity {
namespace {

TEST(DatasetsParity, BoxScaling) {
  for_each_case("facexhubert", "preprocess.", ".safetensors", [](const std::string& name) {
    const Fixture fixture("facexhubert", "preprocess." + name + ".safetensors");
    const Tensor original = fixture.tensor("template_orig"), sequence = fixture.tensor("seq_orig");
    const auto scale = box_scale(original.values());
    ASSERT_TRUE(scale) << scale.error().message();
    const auto scaled = [&](const Tensor& values) {
      std::vector<float> result(values.values().begin(), values.values().end());
      apply_scale(*scale, result);
      return std::vector<double>(result.begin(), result.end());
    };
    MIEN_EXPECT_CLOSE(scaled(original), fixture.doubles("expected.template_scaled"), "datasets.scaled");
    MIEN_EXPECT_CLOSE(scaled(sequence), fixture.doubles("expected.seq_scaled"), "datasets.scaled");

    const auto path = fixture_root() / "facexhubert" / "frame_001.vl";  // the first frame of the sequence
    const auto bytes = read_file(path);
    ASSERT_TRUE(bytes) << bytes.error().message();
    const auto frame = read_vl(*bytes);
    ASSERT_TRUE(frame) << frame.error().message();
    ASSERT_LE(3 * frame->size(), sequence.values().size());
    for (std::size_t v = 0; v < frame->size(); ++v) {
      const auto want = sequence.values().subspan(3 * v, 3);
      EXPECT_EQ((*frame)[v], (Vec3{want[0], want[1], want[2]})) << "vertex " << v;
    }
    EXPECT_EQ(write_vl(*frame), *bytes);
  });
}

TEST(DatasetsParity, Templates) {
  for_each_case("facediffuser", "templates_", ".pkl", [](const std::string& name) {
    const Fixture fixture("facediffuser", "templates.safetensors");
    const auto templates = load_templates(fixture_root() / "facediffuser" / ("templates_" + name + ".pkl"));
    ASSERT_TRUE(templates) << templates.error().message();
    std::size_t compared = 0;
    for (const auto& tensor : fixture.file().tensors()) {
      if (!tensor.name.starts_with("template.")) continue;
      const Tensor want = fixture.tensor(tensor.name);  // rounded to float32, as load_templates() does
      const auto got = templates->find(tensor.name.substr(std::string_view("template.").size()));
      ASSERT_NE(got, templates->end()) << tensor.name;
      EXPECT_TRUE(
          std::equal(got->second.begin(), got->second.end(), want.values().begin(), want.values().end()))
          << tensor.name;
      ++compared;
    }
    EXPECT_EQ(compared, templates->size());
  });
}

}  // namespace
}  // namespace mien::parity

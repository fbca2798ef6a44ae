#include "small_model.h"

#include <gtest/gtest.h>

#include "mien/base/hash.h"
#include "mien/base/random.h"

namespace mien {
namespace {

class ListTensors : public ParameterVisitor<ListTensors> {
 public:
  template <class M>
  void matrix(std::string_view name, M&, std::int64_t out, std::int64_t in, Init) {
    tensors.push_back({full_name(name), Dtype::f16, {out, in}});
  }
  template <class T>
  void tensor(std::string_view name, T&, const Shape& shape, Init) {
    tensors.push_back({full_name(name), Dtype::f16, shape});
  }
  template <class T>
  void buffer(std::string_view name, T&, const Shape& shape) {
    tensors.push_back({full_name(name), Dtype::f32, shape});
  }
  std::vector<StoredTensor> tensors;
};

}  // namespace

void write_small_model(const std::filesystem::path& path, bool raises_brows) {
  default_model::ModelMetadata metadata;
  metadata.name = "small";
  metadata.sizes = {16, 8, 24, 12, 12};
  default_model::Network<Tensor> network(metadata.sizes);
  ListTensors list;
  network.visit(list);
  auto writer = SafetensorsWriter::create(path, list.tensors, default_model::to_metadata(metadata));
  ASSERT_TRUE(writer) << writer.error().message();
  for (const auto& t : list.tensors) {
    std::vector<float> values(static_cast<std::size_t>(t.count()));
    NoiseField(hash64(t.name), 0).normal(0, 0, values);
    const bool is_spread = t.name.ends_with("_sd");
    const bool is_scale = t.name.find("norm") != std::string::npos && t.name.ends_with("weight");
    for (float& v : values) v = is_spread ? 0.1f : (is_scale ? 1.0f : 0.0f) + 0.2f * v;
    if (t.name == "brow.out.bias") values[0] += raises_brows ? 2.5f : 100.0f;  // now and then, or never
    ASSERT_TRUE(writer->write_float(t.name, values));
  }
  ASSERT_TRUE(writer->finish());
}

DefaultModel small_model() {
  const auto path = std::filesystem::path(testing::TempDir()) / "mien_small_model.safetensors";
  write_small_model(path);
  auto model = DefaultModel::load(path);
  EXPECT_TRUE(model) << model.error().message();
  return std::move(model).value();
}

}  // namespace mien

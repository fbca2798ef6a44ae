// SAiD's motion codec: imported from the authors' file, run on the recorded windows.
#include <gtest/gtest.h>

#include "closeness.h"
#include "fixture.h"
#include "mien/io/torch_checkpoint.h"
#include "mien/models/import/import_model.h"
#include "mien/models/said/vae.h"
#include "test_folder.h"

namespace mien::parity {
namespace {

template <class T>
T taken(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message());
  return std::move(result).value();
}

/// A recorded codec, by way of `mien import`.
struct VaeCase {
  explicit VaeCase(const std::string& name)
      : weights(fixture_root() / "said" / (name + ".pth")), recorded("said", name + "_encode.safetensors") {
    Progress progress;
    imported = taken(import_model({.sources = {weights}}, folder / "vae.safetensors", progress));
    file.emplace(taken(SafetensorsFile::open(folder / "vae.safetensors")));
    vae.emplace(taken(said::load_vae(folder / "vae.safetensors")));
  }
  TestFolder folder;
  std::filesystem::path weights;
  Fixture recorded;
  ImportedModel imported;
  std::optional<SafetensorsFile> file;
  std::optional<said::Vae<Tensor>> vae;
};

Tensor row(const Tensor& all, std::int64_t i) { return rows(all, i, 1); }

TEST(SaidVae, ImportsTheAuthorsFile) {
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    const VaeCase given(name);
    const auto description = taken(read_model_file(given.file->metadata()));
    EXPECT_EQ(architecture_name(description.architecture), "said_vae");
    EXPECT_EQ(description.output.space, "arkit");
    EXPECT_EQ(description.output.fps, 60);
    EXPECT_EQ(description.output.channels, given.recorded.file().find("coeffs")->shape.at(2));
    EXPECT_EQ(given.vae->encoder.sizes.window, given.recorded.file().find("coeffs")->shape.at(1));
    EXPECT_FALSE(description.encoder);
    EXPECT_EQ(given.imported.num_parameters > 0, true);
    const auto original = taken(TorchCheckpoint::open(given.weights));
    for (const auto& tensor : given.file->tensors())
      EXPECT_EQ(taken(given.file->read_float(tensor.name)), taken(original.read_float(tensor.name)))
          << tensor.name;
    std::size_t num_counters = 0;
    for (const auto& tensor : original.tensors())
      num_counters += tensor.name.ends_with(".num_batches_tracked") ? 1 : 0;
    EXPECT_EQ(given.file->tensors().size() + num_counters, original.tensors().size());
  });
}

TEST(SaidVae, GivesTheRecordedCodes) {
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    const VaeCase given(name);
    const Fixture& recorded = given.recorded;
    const auto& encoder = given.vae->encoder;
    const std::int64_t count = recorded.file().find("coeffs")->shape.at(0);
    for (std::int64_t i = 0; i < count; ++i) {
      SCOPED_TRACE("window " + std::to_string(i));
      const Tensor window = recorded.slice("coeffs", i);
      const Tensor flat = encoder.flattened(window);
      MIEN_EXPECT_CLOSE(flat, row(recorded.tensor("conv_flat"), i), "said code");
      const Tensor hidden = encoder.hidden(flat);
      MIEN_EXPECT_CLOSE(hidden, row(recorded.tensor("fc"), i), "said code");
      MIEN_EXPECT_CLOSE(encoder.mean(hidden), row(recorded.tensor("mean"), i), "said code");
      MIEN_EXPECT_CLOSE(encoder.log_variance(hidden), row(recorded.tensor("log_var"), i), "said code");
      MIEN_EXPECT_CLOSE(given.vae->decoder(row(recorded.tensor("mean"), i)),
                        recorded.slice("decoded_mean", i), "said window");
    }
  });
}

// What the measures use: all windows of a sequence at once, bit for bit.
TEST(SaidVae, SharesConvolutionsBetweenWindows) {
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    const VaeCase given(name);
    const std::int64_t count = given.recorded.file().find("coeffs")->shape.at(0);
    std::vector<Tensor> parts;
    for (std::int64_t i = 0; i < count; ++i) parts.push_back(given.recorded.slice("coeffs", i));
    const Tensor sequence = Operations<Tensor>::concat_rows(parts);
    const std::int64_t window = given.vae->encoder.sizes.window;
    const std::int64_t num_windows = sequence.num_rows() - window + 1;
    const Tensor features = said::window_features(*given.vae, sequence, num_windows);
    ASSERT_EQ(features.num_rows(), num_windows);
    for (std::int64_t w = 0; w < num_windows; w += 7)
      EXPECT_EQ(
          differences(row(features, w), given.vae->feature(rows(sequence, w, window)), {"bits", 0, 0, ""}),
          "")
          << "window " << w;
    const Tensor one = said::window_features(*given.vae, rows(sequence, 3, window), 1);
    EXPECT_EQ(differences(one, row(features, 3), {"bits", 0, 0, ""}), "");
    EXPECT_EQ(said::window_features(*given.vae, Tensor({5, sequence.width()}), 0).num_rows(), 0);
  });
}

}  // namespace
}  // namespace mien::parity

// SAiD's motion codec on LibTorch: recorded codes, losses, gradients and batch statistics; windows and
// schedules of its training.
#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "closeness.h"
#include "fixture.h"
#include "mien/core/arkit.h"
#include "mien/models/import/import_model.h"
#include "mien/train/coefficient_window.h"
#include "mien/train/said_vae_training.h"
#include "test_folder.h"
#include "torch_fixture.h"

namespace mien::parity {
namespace {

using namespace train;

template <class T>
T taken(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message());
  return std::move(result).value();
}

bool is_recorded(const char* file) { return std::filesystem::exists(fixture_root() / "said" / file); }

struct TorchVaeCase {
  explicit TorchVaeCase(const std::string& name) : recorded("said", name + "_encode.safetensors") {
    Progress progress;
    const auto path = folder / "vae.safetensors";
    taken(import_model({.sources = {fixture_root() / "said" / (name + ".pth")}}, path, progress));
    const auto file = taken(SafetensorsFile::open(path));
    vae.emplace(taken(said::vae_sizes_of(file)));
    initialise_as_pytorch(*vae, 1);
    taken(load_parameters(parameters(*vae), file));
  }
  TestFolder folder;
  Fixture recorded;
  std::optional<said::Vae<torch::Tensor>> vae;
};

TEST(TorchSaidVae, GivesTheRecordedCodes) {
  const torch::NoGradGuard no_grad;
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    const TorchVaeCase given(name);
    const auto& encoder = given.vae->encoder;
    const torch::Tensor flat = encoder.flattened(stored(given.recorded, "coeffs")),
                        hidden = encoder.hidden(flat);
    const auto expect = [&](const torch::Tensor& got, const char* stage, const char* tolerance) {
      SCOPED_TRACE(stage);
      MIEN_EXPECT_CLOSE(values_of(got), values_of(stored(given.recorded, stage)), tolerance);
    };
    expect(flat, "conv_flat", "said code");
    expect(hidden, "fc", "said code");
    expect(encoder.mean(hidden), "mean", "said code");
    expect(encoder.log_variance(hidden), "log_var", "said code");
    expect(given.vae->decoder(stored(given.recorded, "mean").unsqueeze(1)), "decoded_mean", "said window");
  });
}

// reconst, regularize, velocity
std::vector<double> parts_of(const VaeLoss& loss) {
  return {loss.reconstruction.item<double>(), loss.divergence.item<double>(), loss.velocity.item<double>()};
}

torch::Tensor published_deviation() {
  std::ifstream file(fixture_root() / "said/data/coeffs_std.csv");
  std::string line;
  std::getline(file, line), std::getline(file, line);
  std::vector<float> values;
  std::stringstream fields(line);
  while (std::getline(fields, line, ',')) values.push_back(std::stof(line));
  return torch::tensor(values);
}

TEST(TorchSaidVae, CostsWhatWasRecorded) {
  const torch::NoGradGuard no_grad;
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    const TorchVaeCase given(name);
    const torch::Tensor windows = stored(given.recorded, "coeffs"),
                        noise = stored(given.recorded, "eps").unsqueeze(1);
    const MeasuredStatistics<torch::Tensor> measured;
    MIEN_EXPECT_CLOSE(parts_of(vae_loss(*given.vae, windows, noise, {}, measured)),
                      given.recorded.doubles("loss_eval"), "said loss");
    const torch::Tensor deviation = published_deviation();
    ASSERT_EQ(deviation.numel(), windows.size(2));
    MIEN_EXPECT_CLOSE(parts_of(vae_loss(*given.vae, windows, noise, deviation, measured)),
                      given.recorded.doubles("loss_eval_std"), "said loss");
  });
}

TEST(TorchSaidVae, LearnsAsRecorded) {
  for_each_case("said", "", "_encode.safetensors", [](const std::string& name) {
    TorchVaeCase given(name);
    const Fixture& recorded = given.recorded;
    const auto entries = parameters(*given.vae);
    for (const auto& e : entries) e.slot->requires_grad_(e.trained);
    const VaeLoss loss = vae_loss(*given.vae, stored(recorded, "coeffs"),
                                  stored(recorded, "eps").unsqueeze(1), {}, BatchStatistics{});
    const double beta = std::stod(recorded.metadata("beta_in_loss_train"));
    const torch::Tensor total = loss.reconstruction + beta * loss.divergence + loss.velocity;
    auto parts = parts_of(loss);
    parts.push_back(total.item<double>());
    MIEN_EXPECT_CLOSE(parts, recorded.doubles("loss_train"), "said loss");
    total.backward();
    double square = 0;
    std::size_t num_gradients = 0, num_recorded = 0;
    for (const auto& tensor : recorded.file().tensors())
      num_recorded += tensor.name.starts_with("grad.") ? 1 : 0;
    for (const auto& e : entries) {
      if (!e.trained) continue;
      ASSERT_TRUE(e.slot->grad().defined()) << e.name;
      square += e.slot->grad().square().sum().item<double>();
      if (!recorded.has("grad." + e.name)) continue;
      ++num_gradients;
      SCOPED_TRACE(e.name);
      EXPECT_LE(relative_distance(e.slot->grad(), stored(recorded, "grad." + e.name)), 1e-4);
    }
    EXPECT_NEAR(std::sqrt(square), recorded.doubles("grad_norm_train")[0],
                1e-4 * recorded.doubles("grad_norm_train")[0]);
    EXPECT_EQ(num_gradients, num_recorded) << "a recorded gradient has no parameter";
    const auto& first = given.vae->encoder.conv_norms.front();
    MIEN_EXPECT_CLOSE(values_of(first.mean), values_of(stored(recorded, "running_mean_after")),
                      "said window");
    MIEN_EXPECT_CLOSE(values_of(first.variance), values_of(stored(recorded, "running_var_after")),
                      "said window");
  });
}

TEST(TorchSaidVae, WeighsTheDivergenceInCycles) {
  if (!is_recorded("metrics.safetensors")) GTEST_SKIP() << "no recorded said/metrics in " << fixture_root();
  const Fixture recorded("said", "metrics.safetensors");
  const auto settings = nlohmann::json::parse(recorded.metadata("beta_cycle"));
  const std::string stops = settings.at("stop").get<std::string>() + ",";
  int count = 0;
  for (const auto& tensor : recorded.file().tensors()) {
    constexpr std::string_view kPrefix = "beta_cycle.";  // beta_cycle.n97_c4
    if (!tensor.name.starts_with(kPrefix)) continue;
    SCOPED_TRACE(tensor.name);
    ++count;
    const std::string key = tensor.name.substr(kPrefix.size());
    const auto cycles = std::stoll(key.substr(key.find("_c") + 2));
    const auto stop = stops.find(key + " ");
    ASSERT_NE(stop, std::string::npos);
    const double highest = std::stod(stops.substr(stop + key.size() + 1));
    EXPECT_EQ(cyclical_weights(tensor.count(), cycles, settings.at("ratio").get<double>(), highest),
              recorded.doubles(tensor.name));
  }
  EXPECT_GT(count, 0);
}

TEST(TorchSaidVae, CutsTheRecordedWindows) {
  if (!is_recorded("train_windows.safetensors"))
    GTEST_SKIP() << "no recorded said/train_windows in " << fixture_root();
  const Fixture recorded("said", "train_windows.safetensors");
  const auto draws = recorded.integers("draws");
  const std::int64_t window = recorded.integers("window").at(0);
  int count = 0;
  for (; recorded.has("item" + std::to_string(count) + ".coeffs"); ++count) {
    const std::string item = "item" + std::to_string(count);
    const auto values = taken(recorded.file().read_float(item + ".coeffs"));
    const std::int64_t width = recorded.file().find(item + ".coeffs")->shape.at(1);
    EXPECT_EQ(replicated_window(values, width, draws.at(static_cast<std::size_t>(3 * count)), window),
              taken(recorded.file().read_float(item + ".coeffs_window")))
        << item;
  }
  EXPECT_GT(count, 0);
  std::vector<std::int64_t> order;
  for (const std::size_t from : mirror_order(arkit_order(ArkitOrder::said)))
    order.push_back(static_cast<std::int64_t>(from));
  EXPECT_EQ(order, recorded.integers("mirror_permutation"));
}

}  // namespace
}  // namespace mien::parity

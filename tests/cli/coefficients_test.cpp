// mien evaluate coefficients, with a codec of random weights.
#include <gmock/gmock.h>

#include <cmath>

#include "import/parameter_list.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/models/model_file.h"
#include "mien/models/said/vae.h"
#include "program.h"

namespace mien {
namespace {

using testing::HasSubstr;

class CoefficientsTest : public ProgramTest {
 protected:
  CoefficientsTest() {
    write_codec();
    for (const char* folder : {"truth", "generated", "audio"})
      for (const char* person : {"/A", "/B"})
        std::filesystem::create_directories(in_folder(std::string(folder) + person));
    for (const char* person : {"A", "B"}) {
      const std::string name = std::string(person) + "/sentence01";
      write("truth/" + name + ".csv", csv(140, 0));
      for (int r = 0; r < 4; ++r)
        write("generated/" + name + "-" + std::to_string(r) + ".csv", csv(139, 0.1 * (r + 1)));
      write_wav("audio/" + name + ".wav", syllables(2.4));
    }
    write("generated/B/sentence32-0.csv", csv(139, 0));
  }

  static std::string csv(int num_frames, double shift) {
    std::string text;
    for (const auto& name : arkit_order(ArkitOrder::said)) text += (text.empty() ? "" : ",") + name;
    for (int n = 0; n < num_frames; ++n) {
      text += '\n';
      for (int k = 0; k < 32; ++k)
        text += (k == 0 ? "" : ",") + std::to_string(0.5 + 0.4 * std::sin(0.05 * (k + 3) * n + shift * k));
    }
    return text + "\n";
  }
  void write_codec() {
    said::VaeSizes sizes;
    sizes.latent = 4;
    said::Vae<Tensor> vae(sizes);
    ListParameters list;
    vae.visit(list);
    ModelFile description;
    description.architecture = Architecture::said_vae;
    description.name = "random";
    description.output = {.space = "arkit", .channels = 32, .fps = 60, .topology = ""};
    std::vector<StoredTensor> tensors;
    for (const auto& entry : list.entries) tensors.push_back({entry.name, Dtype::f32, entry.shape});
    auto writer =
        SafetensorsWriter::create(in_folder("codec.safetensors"), tensors, to_metadata(description));
    ASSERT_TRUE(writer);
    Rng random(5);
    for (const auto& tensor : tensors) {
      std::vector<float> values(static_cast<std::size_t>(tensor.count()));
      const bool is_variance = tensor.name.ends_with("running_var");
      for (float& v : values) v = static_cast<float>(is_variance ? 1 : random.normal(0, 0.15));
      ASSERT_TRUE(writer->write_float(tensor.name, values));
    }
    ASSERT_TRUE(writer->finish());
  }
};

TEST_F(CoefficientsTest, MeasuresAFolderAgainstTheTruth) {
  const auto run = mien({"evaluate", "coefficients", "generated", "truth", "--codec", "codec.safetensors",
                         "--speech", "audio", "--json", "--repeats", "3"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err,
              HasSubstr("1 generated sentences have no truth and are left out, the first is B sentence 32"));
  const auto table = nlohmann::json::parse(run.out);
  // 20 windows a file; of the truth, the last two of 21 do not count.
  EXPECT_THAT(table.at("title").get<std::string>(),
              HasSubstr("8 generated and 2 true sequences, 152 and 38 windows"));
  const auto value = [&](const std::string& name) {
    for (const auto& row : table.at("rows"))
      if (row.at("name") == name) {
        EXPECT_GT(row.at("definition").get<std::string>().size(), 20u);
        return row.at("values").at(0).at("value").get<double>();
      }
    ADD_FAILURE() << "no " << name;
    return 0.0;
  };
  EXPECT_GT(value("FD"), 0);
  EXPECT_GT(value("WInD"), 0);
  EXPECT_GE(value("WInD deviation"), 0);
  EXPECT_GT(value("multimodality"), 0);
  EXPECT_GE(value("beat consistency"), 0);
  EXPECT_LE(value("beat consistency"), 1);
  EXPECT_LE(std::abs(value("lip lag")), 500);

  const auto again = mien({"evaluate", "coefficients", "generated", "truth", "--codec", "codec.safetensors",
                           "--speech", "audio", "--json", "--repeats", "3", "--threads", "3"});
  EXPECT_EQ(again.out, run.out);
}

TEST_F(CoefficientsTest, OfTheTruthWithItselfAreNearZero) {
  const auto run =
      mien({"evaluate", "coefficients", "truth", "truth", "--codec", "codec.safetensors", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  for (const auto& row : report.at("rows")) {
    const auto& value = row.at("values").at(0).at("value");
    if (row.at("name") == "FD") {
      EXPECT_LT(std::abs(value.get<double>()), 1e-6);
    } else if (row.at("name") == "multimodality") {
      EXPECT_TRUE(value.is_null()) << "one repetition";
    }
  }
}

TEST_F(CoefficientsTest, TextSaysWhatEveryNumberIs) {
  const auto run = mien({"evaluate", "coefficients", "generated", "truth", "--codec", "codec.safetensors"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("FD = |m1 - m2|^2"));
  EXPECT_THAT(run.out, HasSubstr("squared Wasserstein-2"));
  EXPECT_THAT(run.out, HasSubstr("codec.safetensors"));
}

TEST_F(CoefficientsTest, WrongUseIsNamed) {
  const auto expect = [&](const std::vector<std::string>& more, int code, const std::string& message) {
    std::vector<std::string> words = {"evaluate", "coefficients"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = mien(words);
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, HasSubstr(message));
  };
  expect({"generated", "truth"}, 2, "--codec");
  expect({"generated", "nowhere", "--codec", "codec.safetensors"}, 3, "nowhere");
  expect({"generated", "truth", "--codec", "small.safetensors"}, 4, "motion codec");
  expect({"generated", "truth", "--codec", "codec.safetensors", "--split", "test"}, 3, "split 'test'");
  expect({"generated", "truth", "--codec", "codec.safetensors", "--speech", "nowhere"}, 3, "sentence01.wav");
  write("generated/A/sentence01-9.csv", "jawOpen\n0.5\n");
  expect({"generated", "truth", "--codec", "codec.safetensors"}, 4, "no column jawForward");
}

}  // namespace
}  // namespace mien

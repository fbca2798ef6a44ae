// mien import, as its users meet it: a small encoder in the layout of the Hugging Face library.
#include <gmock/gmock.h>

#include "import/parameter_list.h"
#include "mien/base/random.h"
#include "mien/io/safetensors.h"
#include "mien/models/speech_encoder/network.h"
#include "mien/nn/runtime_operations.h"
#include "program.h"

namespace mien {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kConfig =
    R"({"model_type":"hubert","hidden_size":16,"num_hidden_layers":1,"num_attention_heads":2,)"
    R"("intermediate_size":24,"conv_dim":[8,8,8,8,8,8,8],"num_conv_pos_embeddings":16,)"
    R"("num_conv_pos_embedding_groups":4})";

class ImportCommand : public ProgramTest {
 protected:
  ImportCommand() {
    std::filesystem::create_directory(in_folder("hubert"));
    write("hubert/config.json", kConfig);
    const auto config = encoder_config_from_json(kConfig);
    SpeechEncoder<Tensor> network(*config);
    ListParameters list;
    network.visit(list);
    std::vector<StoredTensor> tensors;
    for (const auto& entry : list.entries)
      tensors.push_back({"hubert." + entry.name, Dtype::f32, entry.shape});
    tensors.push_back({"lm_head.bias", Dtype::f32, {4}});
    auto writer = SafetensorsWriter::create(in_folder("hubert/model.safetensors"), tensors);
    for (const auto& tensor : tensors) {
      std::vector<float> values(static_cast<std::size_t>(tensor.count()));
      NoiseField(1, static_cast<std::uint32_t>(values.size())).normal(0, 0, values);
      EXPECT_TRUE(writer->write_float(tensor.name, values));
    }
    EXPECT_TRUE(writer->finish());
  }

  void expect(const std::vector<std::string>& words, int exit_code, const std::string& message,
              const std::string& prelude = "") {
    SCOPED_TRACE(message);
    const auto before = files();
    const auto run = mien(words, prelude);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_THAT(run.err, AllOf(HasSubstr("error: "), HasSubstr(message)));
    EXPECT_EQ(files(), before);
  }
};

TEST_F(ImportCommand, AFolderBecomesAModelFile) {
  const auto run = mien({"import", "hubert/", "-o", "a.safetensors"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("wrote a.safetensors: speech_encoder"),
                             HasSubstr("left out what is not the encoder's: 1 tensor")));
  const auto file = SafetensorsFile::open(in_folder("a.safetensors"));
  ASSERT_TRUE(file) << file.error().message();
  EXPECT_NE(file->find("audio_encoder.encoder.layers.0.attention.q_proj.weight"), nullptr);

  const auto facts = nlohmann::json::parse(mien({"inspect", "a.safetensors", "--json"}).out);
  EXPECT_EQ(facts.at("architecture"), "speech_encoder");
  EXPECT_EQ(facts.at("encoder_heads"), 2);
  EXPECT_THAT(mien({"inspect", "a.safetensors"}).out, HasSubstr("encoder width"));

  const auto events = mien({"import", "hubert", "-o", "b.safetensors", "--half", "--json"}).events();
  EXPECT_EQ(events.front().at("type"), "start");
  EXPECT_EQ(events.back().at("type"), "success");
  EXPECT_LT(bytes_of("b.safetensors").size(), bytes_of("a.safetensors").size());
  EXPECT_EQ(mien({"import", "hubert", "-o", "c.safetensors", "--quiet"}).err.find("wrote"),
            std::string::npos);
  EXPECT_EQ(bytes_of("a.safetensors"), bytes_of("c.safetensors"));
}

TEST_F(ImportCommand, AnEncoderAloneDoesNotAnimate) {
  ASSERT_EQ(mien({"import", "hubert", "-o", "a.safetensors"}).exit_code, 0);
  expect({"animate", "speech.wav", "--model", "a.safetensors", "-o", "out.csv"}, 4, "speech_encoder");
}

TEST_F(ImportCommand, WrongOptions) {
  expect({"import", "hubert", "-o", "a.bin"}, 2, "ends in .safetensors");
  expect({"import", "hubert", "-o", "hubert/model.safetensors"}, 2, "is an input");
  expect({"import", "hubert", "-o", "a.safetensors", "--schedule", "square"}, 2, "--schedule");
  expect({"import", "hubert", "-o", "a.safetensors", "--system", "codetalker"}, 2, "facediffuser_v");
  expect({"import", "hubert", "-o", "a.safetensors", "--fps", "25"}, 2, "speech encoder alone");
  expect({"import", "hubert", "hubert/model.safetensors", "-o", "a.safetensors"}, 2, "second model");
  expect({"import", "-o", "a.safetensors"}, 2, "SOURCE");
}

TEST_F(ImportCommand, BadSources) {
  const auto from = [](const std::string& source) {
    return std::vector<std::string>{"import", source, "-o", "out.safetensors"};
  };
  expect(from("absent.pth"), 3, "absent.pth");
  std::filesystem::create_directory(in_folder("empty"));
  expect(from("empty"), 3, "folder without model.safetensors");
  expect(from("speech.wav"), 3, "speech.wav");
  expect(from("small.safetensors"), 4, "no network that Mien knows");
  using namespace std::string_literals;
  write("code.pth",
        "\x80\x02"
        "cposix\nsystem\nX\x02\0\0\0ls\x85R."s);
  expect(from("code.pth"), 4, "'posix.system'");
  write("hubert/config.json", R"({"model_type":"wavlm"})");
  expect(from("hubert"), 4, "model_type");
  write("hubert/config.json", R"({"model_type":"hubert"})");
  expect(from("hubert"), 4, "expected [768");
  expect({"import", "hubert", "-o", "absent/out.safetensors"}, 1, "absent/out.safetensors");
}

TEST_F(ImportCommand, AFullDiskLeavesNothingBehind) {
  expect({"import", "hubert", "-o", "a.safetensors"}, 1, "writing failed", "ulimit -f 8; trap '' XFSZ;");
}

}  // namespace
}  // namespace mien

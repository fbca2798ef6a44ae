#include "program.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>

#include "mien/base/file.h"
#include "small_model.h"
#include "test_paths.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

std::string shell_word(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  return bytes ? std::string(as_text(*bytes)) : "";
}

}  // namespace

std::vector<nlohmann::json> Outcome::events() const {
  std::vector<nlohmann::json> all;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);) {
    all.push_back(nlohmann::json::parse(line, nullptr, false));
    EXPECT_TRUE(all.back().is_object() && all.back().value("mien", 0) == 1) << line;
  }
  return all;
}

ProgramTest::ProgramTest() {
  std::string pattern = (fs::temp_directory_path() / "mien_cli_XXXXXX").string();
  folder_ = ::mkdtemp(pattern.data());
  write_small_model(folder_ / "small.safetensors");
  write_wav("speech.wav", syllables(2));
}

ProgramTest::~ProgramTest() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Outcome ProgramTest::mien(const std::vector<std::string>& arguments, const std::string& prelude) const {
  std::string line = prelude + " " + shell_word(built_path("bin/mien").string());
  for (const auto& argument : arguments) line += " " + shell_word(argument);
  return shell(line);
}

Outcome ProgramTest::shell(const std::string& command_line) const {
  const fs::path out = folder_.string() + ".out", err = folder_.string() + ".err";
  const std::string command = "{ cd " + shell_word(folder_.string()) + "; " + command_line + "; } >" +
                              shell_word(out.string()) + " 2>" + shell_word(err.string()) + " </dev/null";
  const int status = std::system(("exec bash -c " + shell_word(command)).c_str());
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(out),
                  text_of(err)};
  fs::remove(out);
  fs::remove(err);
  return outcome;
}

Outcome ProgramTest::animate(std::vector<std::string> more) const {
  std::vector<std::string> arguments = {"animate", "speech.wav", "--model", "small.safetensors"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return mien(arguments);
}

void ProgramTest::write(const std::string& name, std::string_view content) const {
  ASSERT_TRUE(write_file(in_folder(name), content));
}

void ProgramTest::write_wav(const std::string& name, std::span<const float> samples) const {
  Bytes wav;
  const auto text = [&](std::string_view s) {
    wav.insert(wav.end(), as_bytes(s).begin(), as_bytes(s).end());
  };
  const auto size = static_cast<std::uint32_t>(samples.size() * 2);
  text("RIFF");
  append_le<std::uint32_t>(wav, 36 + size);
  text("WAVEfmt ");
  append_le<std::uint32_t>(wav, 16);
  append_le<std::uint16_t>(wav, 1);  // PCM
  append_le<std::uint16_t>(wav, 1);  // mono
  append_le<std::uint32_t>(wav, 16000);
  append_le<std::uint32_t>(wav, 32000);
  append_le<std::uint16_t>(wav, 2);
  append_le<std::uint16_t>(wav, 16);
  text("data");
  append_le<std::uint32_t>(wav, size);
  for (const float x : samples)
    append_le<std::int16_t>(wav, static_cast<std::int16_t>(std::lround(x * 32767)));
  ASSERT_TRUE(write_file(in_folder(name), std::span<const std::byte>(wav)));
}

Bytes ProgramTest::bytes_of(const std::string& name) const {
  auto bytes = read_file(in_folder(name));
  EXPECT_TRUE(bytes) << bytes.error().message();
  return bytes ? std::move(*bytes) : Bytes{};
}

std::vector<std::string> ProgramTest::files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<float> syllables(double seconds) {
  std::vector<float> samples(static_cast<std::size_t>(seconds * 16000));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = static_cast<double>(i) / 16000, phase = 2 * std::numbers::pi * 130 * t;
    const double swell = std::max(0.0, std::sin(2 * std::numbers::pi * 4 * t));
    double sum = 0;
    for (int k = 1; k <= 12; ++k) sum += std::sin(k * phase) / k;
    samples[i] = static_cast<float>(0.15 * swell * sum);
  }
  return samples;
}

}  // namespace mien

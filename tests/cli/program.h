#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "mien/base/bytes.h"

namespace mien {

/// What a run of the program left behind.
struct Outcome {
  int exit_code = -1;  ///< 128 + n when signal n ended it
  std::string out, err;

  /// The lines of stderr, each a JSON object. Fails the test when one is not.
  [[nodiscard]] std::vector<nlohmann::json> events() const;
};

/// A folder of its own with a small random model and two seconds of a speech-like sound; the program runs
/// there.
class ProgramTest : public testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Runs a command line of bash in the folder.
  [[nodiscard]] Outcome shell(const std::string& command_line) const;
  /// Runs `mien` with the arguments; `prelude` is shell code before it, e.g. "ulimit -f 100;".
  [[nodiscard]] Outcome mien(const std::vector<std::string>& arguments,
                             const std::string& prelude = "") const;
  /// `mien animate speech.wav --model small.safetensors` and more.
  [[nodiscard]] Outcome animate(std::vector<std::string> more) const;

  [[nodiscard]] std::filesystem::path in_folder(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, std::string_view content) const;
  /// A 16-bit mono WAV file.
  void write_wav(const std::string& name, std::span<const float> samples) const;
  [[nodiscard]] Bytes bytes_of(const std::string& name) const;
  /// Names in the folder, sorted, hidden ones too.
  [[nodiscard]] std::vector<std::string> files() const;

 private:
  std::filesystem::path folder_;
};

/// Syllables: tones with overtones that swell four times a second. @param seconds  length at 16 kHz
std::vector<float> syllables(double seconds);

}  // namespace mien

#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mien/io/safetensors.h"
#include "mien/tensor/tensor.h"

namespace mien::parity {

/// Folder of the recorded cases: MIEN_FIXTURES, else ../shared/fixtures beside the project, else the part of them
/// that is committed (tests/data/fixtures).
std::filesystem::path fixture_root();

/// The <name>s of all files <prefix><name><suffix> in a folder of fixture_root(), sorted; without those that
/// hold a dot.
std::vector<std::string> cases(std::string_view folder, std::string_view prefix, std::string_view suffix);

/// Runs body(name) for every case, each traced by its name; skips the test when there is none. Cases are
/// found when the test runs, so that one program replays any folder: a test per case would be listed when the
/// program is built, and would pass without running when the folder is another one.
template <class Body>
void for_each_case(std::string_view folder, std::string_view prefix, std::string_view suffix, Body&& body) {
  const std::vector<std::string> names = cases(folder, prefix, suffix);
  if (names.empty())
    GTEST_SKIP() << "no recorded " << folder << '/' << prefix << '*' << suffix << " in " << fixture_root();
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    try {
      body(name);
    } catch (const std::exception& problem) {
      ADD_FAILURE() << name << ": " << problem.what();
    }
  }
}

/// A recorded file. A tensor that is missing or of another type throws: it fails the test that asked.
class Fixture {
 public:
  /// fixture_root() / folder / file
  Fixture(std::string_view folder, const std::string& file);

  [[nodiscard]] const SafetensorsFile& file() const { return file_; }
  [[nodiscard]] bool has(std::string_view name) const { return file_.find(name) != nullptr; }
  [[nodiscard]] bool has_metadata(const std::string& key) const { return file_.metadata().contains(key); }
  [[nodiscard]] const std::string& metadata(const std::string& key) const;
  /// The configuration that the case was made with.
  [[nodiscard]] nlohmann::json config() const { return nlohmann::json::parse(metadata("config")); }

  /// Values as float32, without leading axes of size 1: [1, N, D] becomes [N, D].
  [[nodiscard]] Tensor tensor(std::string_view name) const;
  /// Slice i of a tensor [K, N, D] as [N, D].
  [[nodiscard]] Tensor slice(std::string_view name, std::int64_t i) const;
  [[nodiscard]] std::vector<double> doubles(std::string_view name) const;
  [[nodiscard]] std::vector<std::int64_t> integers(std::string_view name) const;

 private:
  SafetensorsFile file_;
};

}  // namespace mien::parity

#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mien/base/result.h"

namespace mien::train {

/// A TOML file whose fields are asked for one by one. What is wrong with it is collected: wrong types, and
/// fields that nobody asked for.
class TomlFile {
 public:
  /// Errors: unreadable file (input), not TOML (usage, with the line).
  static Result<TomlFile> open(const std::filesystem::path& path);
  TomlFile(TomlFile&&) noexcept;
  ~TomlFile();

  /// Leaves `value` as it is when the field is absent.
  void read(const char* table, const char* key, std::string& value);
  void read(const char* table, const char* key, std::filesystem::path& value);
  void read(const char* table, const char* key, std::vector<std::string>& value);
  void read(const char* table, const char* key, double& value);
  void read(const char* table, const char* key, std::int64_t& value);
  void read(const char* table, const char* key, std::uint64_t& value);
  void read(const char* table, const char* key, int& value);
  void read(const char* table, const char* key, bool& value);

  void complain(const std::string& problem);
  [[nodiscard]] const std::string& text() const;
  /// After the last read. Error (Errc::usage): everything that is wrong, with lines; `see` tells where the
  /// fields are described.
  [[nodiscard]] Status finish(const std::string& see) const;

 private:
  struct State;
  explicit TomlFile(std::unique_ptr<State> state);
  template <class T, class Stored>
  void read_as(const char* table, const char* key, Stored& value);
  std::unique_ptr<State> state_;
};

}  // namespace mien::train

#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mien/base/result.h"

namespace mien::train {

/// The values that a field may have.
struct Range {
  double least = 0, most = 0;
  bool has_least = true, has_most = true;  ///< whether the ends themselves may be
  std::string words;                       ///< "must be at least 1"

  [[nodiscard]] bool has(double value) const {  // NaN is nowhere
    return (has_least ? value >= least : value > least) && (has_most ? value <= most : value < most);
  }
};
Range at_least(std::int64_t least);
Range above_zero();
Range not_negative();
Range share();            ///< [0, 1]
Range share_below_one();  ///< [0, 1)

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

  /// The same, and complains of a number outside of `range`, also of one that the file does not have.
  template <class Number>
  void read(const char* table, const char* key, Number& value, const Range& range) {
    read(table, key, value);
    if (!range.has(static_cast<double>(value))) complain(field_name(table, key) + " " + range.words);
  }
  /// A word that `parse` knows, std::string_view -> std::optional<Value>. `known` lists them for the
  /// complaint.
  template <class Value, class Parse>
  void read_word(const char* table, const char* key, Value& value, Parse&& parse, const std::string& known) {
    std::string word;
    if (!has(table, key)) return;
    read(table, key, word);
    if (std::optional<Value> found = parse(word))
      value = std::move(*found);
    else
      complain(field_name(table, key) + " '" + word + "' is not " + known);
  }

  [[nodiscard]] bool has_table(const char* table) const;
  void complain(const std::string& problem);
  [[nodiscard]] const std::string& text() const;
  /// After the last read. Error (Errc::usage): everything that is wrong, with lines; `see` tells where the
  /// fields are described.
  [[nodiscard]] Status finish(const std::string& see) const;

 private:
  struct State;
  bool has(const char* table, const char* key);
  static std::string field_name(const char* table, const char* key);
  explicit TomlFile(std::unique_ptr<State> state);
  template <class T, class Stored>
  void read_as(const char* table, const char* key, Stored& value);
  std::unique_ptr<State> state_;
};

}  // namespace mien::train

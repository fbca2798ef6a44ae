#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mien {

/// What `mien inspect` found, in order: for people as aligned lines, for programs as one JSON object.
class Facts {
 public:
  void add(std::string_view name, std::string_view value);
  void add(std::string_view name, const char* value) { add(name, std::string_view(value)); }
  void add(std::string_view name, std::int64_t value);
  /// `unit` is shown in text only; the name carries it for programs. NaN is null.
  void add(std::string_view name, double value, int decimals, std::string_view unit = "");
  void add(std::string_view name, const std::vector<std::string>& values);
  /// A table: its text, and its JSON.
  void add_table(std::string_view name, std::string text, std::string json);

  [[nodiscard]] std::string to_text() const;
  [[nodiscard]] std::string to_json() const;

 private:
  struct Fact {
    std::string name, text, json;
    bool is_table = false;
  };
  std::vector<Fact> facts_;
};

}  // namespace mien

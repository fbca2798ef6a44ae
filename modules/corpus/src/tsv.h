#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/number_text.h"
#include "mien/base/result.h"

namespace mien {

/// Lines of a text without their ends; a last empty line is left out. "\r\n" counts as one end.
std::vector<std::string_view> lines_of(std::string_view text);
std::vector<std::string_view> split_tabs(std::string_view line);

/// Reads the columns of one line in order; the first failure is kept and later reads give defaults.
class TsvRow {
 public:
  TsvRow(std::string_view line, std::string where) : cells_(split_tabs(line)), where_(std::move(where)) {}

  [[nodiscard]] std::size_t num_cells() const { return cells_.size(); }
  std::string_view text(std::string_view column);
  double number(std::string_view column, double low, double high);
  std::int64_t integer(std::string_view column, std::int64_t low, std::int64_t high);
  /// "-" gives nothing.
  std::optional<double> optional_number(std::string_view column, double low, double high);
  /// Value of a cell by a function from text to optional<T>.
  template <class T>
  T named(std::string_view column, std::optional<T> (*parse)(std::string_view)) {
    const std::string_view cell = text(column);
    const auto value = parse(cell);
    if (!value) fail(column, "'" + std::string(cell) + "' is unknown");
    return value.value_or(T{});
  }
  void fail(std::string_view column, std::string why);
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  std::vector<std::string_view> cells_;
  std::string where_;
  std::size_t next_ = 0;
  std::optional<Error> error_;
};

/// Calls read(row) for each line after the header. Errors: another header, another number of columns, a
/// failed row.
Status read_tsv(std::string_view text, std::string_view name, std::string_view header,
                const std::function<void(TsvRow&)>& read);

}  // namespace mien

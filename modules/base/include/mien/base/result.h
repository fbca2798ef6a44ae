#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mien/base/contract.h"
#include "mien/base/error.h"

namespace mien {

/// A value or an Error, plus warnings: oddities that were survived (a clipped file, an unused tensor).
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit by design
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit by design

  [[nodiscard]] bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  /// @pre has_value()
  T& value() & {
    contract(has_value(), "Result::value() on an error");
    return std::get<0>(state_);
  }
  const T& value() const& {
    contract(has_value(), "Result::value() on an error");
    return std::get<0>(state_);
  }
  T&& value() && {
    contract(has_value(), "Result::value() on an error");
    return std::get<0>(std::move(state_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  /// @pre !has_value()
  [[nodiscard]] const Error& error() const {
    contract(!has_value(), "Result::error() on a value");
    return std::get<1>(state_);
  }

  std::vector<std::string> warnings;

 private:
  std::variant<T, Error> state_;
};

/// Result of work that gives nothing back.
struct Done {};
using Status = Result<Done>;

}  // namespace mien

/// Evaluates `expression` (a Result); on error returns it from the current function, else binds its value:
/// MIEN_TRY(auto clip, load_audio(path));
#define MIEN_TRY(declaration, expression)                     \
  MIEN_TRY_(declaration, expression, MIEN_TRY_NAME_(__LINE__))
#define MIEN_TRY_NAME_2_(line) mien_try_result_##line
#define MIEN_TRY_NAME_(line) MIEN_TRY_NAME_2_(line)
#define MIEN_TRY_(declaration, expression, name)              \
  auto name = (expression);                                   \
  if (!name.has_value()) return name.error();                 \
  declaration = std::move(name).value()

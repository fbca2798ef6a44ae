#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "mien/base/result.h"

namespace mien::io {

/// Objects keep their keys sorted, so that the same content gives the same text.
using Json = nlohmann::json;

/// Parses `text`; `what` names the source in errors. Nesting is limited (256 levels), because writing a value
/// back recurses. Errors (Errc::input): not JSON, not UTF-8, nested too deeply, a number outside the range of
/// a double.
Result<Json> parse_json(std::string_view text, std::string_view what);

/// Text of a value; bytes that are not UTF-8 become U+FFFD.
std::string json_text(const Json& value);

/// Tolerant access to a value of unknown shape: a missing key, a wrong type or a non-object gives the empty
/// answer.
const Json& member(const Json& object, const char* key);
/// The member when it is an array, else an empty array.
const Json& array_member(const Json& object, const char* key);
/// The member when it is a whole number >= 0 (2.0 counts).
std::optional<std::size_t> index_member(const Json& object, const char* key);
std::optional<std::size_t> to_index(const Json& value);
std::optional<double> number_member(const Json& object, const char* key);
std::string text_member(const Json& object, const char* key);

}  // namespace mien::io

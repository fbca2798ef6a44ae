#include "json_access.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mien::io {
namespace {

constexpr int kMaxDepth = 256;

// Deepest nesting of brackets outside strings. The text need not be valid.
int nesting(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

Result<Json> parse_json(std::string_view text, std::string_view what) {
  if (nesting(text) > kMaxDepth)
    return Error{Errc::input, std::string(what),
                 "the JSON is nested more than " + std::to_string(kMaxDepth) + " levels deep", ""};
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& e) {
    return Error{Errc::input, std::string(what), "not valid JSON at byte " + std::to_string(e.byte), ""};
  } catch (const Json::exception&) {
    return Error{Errc::input, std::string(what), "the JSON holds a number that is too large", ""};
  }
}

std::string json_text(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

const Json& member(const Json& object, const char* key) {
  static const Json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

const Json& array_member(const Json& object, const char* key) {
  static const Json empty = Json::array();
  const Json& value = member(object, key);
  return value.is_array() ? value : empty;
}

std::optional<std::size_t> to_index(const Json& value) {
  if (value.is_number_unsigned()) return value.get<std::size_t>();
  if (value.is_number_integer() && value.get<std::int64_t>() >= 0) return value.get<std::size_t>();
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number >= 0 && number < 0x1p53 && number == std::floor(number))
      return static_cast<std::size_t>(number);
  }
  return std::nullopt;
}

std::optional<std::size_t> index_member(const Json& object, const char* key) {
  return to_index(member(object, key));
}

std::optional<double> number_member(const Json& object, const char* key) {
  const Json& value = member(object, key);
  if (!value.is_number()) return std::nullopt;
  return value.get<double>();
}

std::string text_member(const Json& object, const char* key) {
  const Json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

}  // namespace mien::io

#include "safetensors_header.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

namespace mien {
namespace {

using Json = nlohmann::json;

struct DtypeRow {
  std::string_view name;
  std::size_t size;
};
constexpr std::array<DtypeRow, 10> kDtypes = {{{"F64", 8},
                                               {"F32", 4},
                                               {"F16", 2},
                                               {"BF16", 2},
                                               {"I64", 8},
                                               {"I32", 4},
                                               {"I16", 2},
                                               {"I8", 1},
                                               {"U8", 1},
                                               {"BOOL", 1}}};

Error bad(std::string what, std::string why) { return {Errc::input, std::move(what), std::move(why), ""}; }

/// Reads the header event by event instead of as a tree: a tree would hide repeated keys, and nesting deeper
/// than the format's three levels stops the parse at once. A handler returns false after storing `error`.
class HeaderEvents final : public nlohmann::json_sax<Json> {
 public:
  SafetensorsHeader header;
  std::optional<Error> error;

  bool start_object(std::size_t) override {
    switch (place_) {
      case Place::start:
        place_ = Place::root;
        return true;
      case Place::root_value:
        if (key_ == "__metadata__") {
          place_ = Place::metadata;
        } else {
          place_ = Place::entry;
          entry_ = {};
          entry_.tensor.name = key_;
          has_dtype_ = has_shape_ = false;
          offsets_.clear();
          has_offsets_ = false;
        }
        return true;
      default:
        return unexpected("an object");
    }
  }
  bool end_object() override {
    switch (place_) {
      case Place::entry:
        if (!has_dtype_) return fail("has no dtype");
        if (!has_shape_) return fail("has no shape");
        if (!has_offsets_) return fail("has no data_offsets");
        entry_.begin = static_cast<std::size_t>(offsets_[0]);
        entry_.end = static_cast<std::size_t>(offsets_[1]);
        header.entries.push_back(std::move(entry_));
        place_ = Place::root;
        return true;
      case Place::metadata:
        place_ = Place::root;
        return true;
      default:
        place_ = Place::done;
        return true;
    }
  }
  bool key(std::string& name) override {
    switch (place_) {
      case Place::root:
        key_ = name;
        member_.clear();
        if (!names_.insert(name).second) return fail("is listed twice");
        place_ = Place::root_value;
        return true;
      case Place::metadata:
        member_ = name;
        if (header.metadata.contains(name)) return fail("has the key '" + name + "' twice");
        place_ = Place::metadata_value;
        return true;
      default:
        member_ = name;
        if (name == "dtype" && !has_dtype_) return has_dtype_ = true, place_ = Place::dtype, true;
        if (name == "shape" && !has_shape_) return has_shape_ = true, place_ = Place::shape, true;
        if (name == "data_offsets" && !has_offsets_)
          return has_offsets_ = true, place_ = Place::offsets, true;
        return fail("has an unexpected or repeated member '" + name + "'");
    }
  }
  bool start_array(std::size_t) override {
    if (place_ == Place::shape) return place_ = Place::shape_items, true;
    if (place_ == Place::offsets) return place_ = Place::offset_items, true;
    return unexpected("an array");
  }
  bool end_array() override {
    if (place_ == Place::offset_items && offsets_.size() != 2)
      return fail("has data_offsets with " + std::to_string(offsets_.size()) + " numbers, expected 2");
    place_ = Place::entry;
    return true;
  }
  bool string(std::string& text) override {
    if (place_ == Place::metadata_value) {
      header.metadata[member_] = text;
      place_ = Place::metadata;
      return true;
    }
    if (place_ != Place::dtype) return unexpected("a string");
    const auto* row =
        std::find_if(kDtypes.begin(), kDtypes.end(), [&](const auto& r) { return r.name == text; });
    if (row == kDtypes.end())
      return fail("has the unknown dtype '" + text +
                  "', expected F64, F32, F16, BF16, I64, I32, I16, I8, U8 or BOOL");
    entry_.tensor.dtype = static_cast<Dtype>(row - kDtypes.begin());
    place_ = Place::entry;
    return true;
  }
  bool number_unsigned(std::uint64_t value) override {
    if (value > static_cast<std::uint64_t>(INT64_MAX)) return fail(member_ + " holds a number beyond 2^63");
    if (place_ == Place::shape_items)
      return entry_.tensor.shape.push_back(static_cast<std::int64_t>(value)), true;
    if (place_ == Place::offset_items) return offsets_.push_back(value), true;
    return unexpected("a number");
  }
  bool number_integer(std::int64_t value) override {
    return unexpected("the negative number " + std::to_string(value));
  }
  bool number_float(double, const std::string& text) override {
    return unexpected("the number " + text + " (not an integer below 2^63)");
  }
  bool null() override { return unexpected("null"); }
  bool boolean(bool) override { return unexpected("true or false"); }
  bool binary(Json::binary_t&) override { return unexpected("binary data"); }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) override {
    error = bad("", "the header is not valid JSON in UTF-8, at its byte " + std::to_string(position));
    return false;
  }

 private:
  enum class Place {
    start,
    root,
    root_value,
    metadata,
    metadata_value,
    entry,
    dtype,
    shape,
    shape_items,
    offsets,
    offset_items,
    done
  };

  bool fail(std::string why) {
    error =
        bad(key_ == "__metadata__" ? "header member __metadata__" : "tensor '" + key_ + "'", std::move(why));
    return false;
  }
  bool unexpected(const std::string& found) {
    if (place_ == Place::start) return error = bad("", "the header is not a JSON object"), false;
    if (place_ == Place::metadata_value)
      return fail("has " + found + " as '" + member_ + "', expected a string");
    return fail("has " + found + " where the format has none" +
                (member_.empty() ? "" : ", at '" + member_ + "'"));
  }

  Place place_ = Place::start;
  std::string key_, member_;
  std::set<std::string> names_;
  SafetensorsHeader::Entry entry_;
  std::vector<std::uint64_t> offsets_;
  bool has_dtype_ = false, has_shape_ = false, has_offsets_ = false;
};

std::string shape_text(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i) text += (i ? ", " : "") + std::to_string(shape[i]);
  return text + "]";
}

}  // namespace

std::string_view dtype_name(Dtype dtype) { return kDtypes[static_cast<std::size_t>(dtype)].name; }
std::size_t dtype_size(Dtype dtype) { return kDtypes[static_cast<std::size_t>(dtype)].size; }

std::int64_t StoredTensor::count() const {
  std::int64_t n = 1;
  for (const auto size : shape) n *= size;
  return n;
}

std::optional<std::size_t> stored_size(const StoredTensor& tensor) {
  // A later 0 must not excuse an overflow before it, so sizes of 0 count as 1 until the end.
  std::optional<std::size_t> size = dtype_size(tensor.dtype);
  bool is_empty = false;
  for (const auto n : tensor.shape) {
    is_empty = is_empty || n == 0;
    size = checked_multiply(*size, static_cast<std::size_t>(std::max<std::int64_t>(n, 1)));
    if (!size || *size > static_cast<std::size_t>(INT64_MAX)) return std::nullopt;
  }
  return is_empty ? 0 : size;
}

Result<SafetensorsHeader> parse_safetensors_header(std::string_view text, std::size_t data_size) {
  // The JSON reader skips a byte-order mark and takes NUL as the end; the format allows neither.
  if (text.empty() || text.front() != '{') return bad("", "the header does not begin with '{'");
  if (text.find('\0') != text.npos) return bad("", "the header contains a NUL byte");
  HeaderEvents events;
  const bool ok = Json::sax_parse(text.begin(), text.end(), &events);
  if (events.error) return *events.error;
  if (!ok) return bad("", "the header is not valid JSON");
  auto& entries = events.header.entries;
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.end < b.end;
  });
  std::size_t covered = 0;
  for (const auto& e : entries) {
    const std::string name = "tensor '" + e.tensor.name + "'";
    const auto range = "[" + std::to_string(e.begin) + ", " + std::to_string(e.end) + ")";
    if (e.begin > e.end) return bad(name, "data_offsets " + range + " are reversed");
    if (e.end > data_size)
      return bad(name, "data_offsets " + range + " reach past the end of the data of " +
                           std::to_string(data_size) + " bytes; the file may be truncated");
    const auto size = stored_size(e.tensor);
    if (!size) return bad(name, "the shape " + shape_text(e.tensor.shape) + " is too large to exist");
    if (*size != e.end - e.begin)
      return bad(name, "shape " + shape_text(e.tensor.shape) + " of " +
                           std::string(dtype_name(e.tensor.dtype)) + " needs " + std::to_string(*size) +
                           " bytes, data_offsets " + range + " give " + std::to_string(e.end - e.begin));
    if (e.begin < covered) return bad(name, "data_offsets " + range + " overlap another tensor");
    // A gap between tensors is harmless: files of which a tool removed a tensor from the header have one.
    covered = e.end;
  }
  if (covered != data_size)
    return bad("", std::to_string(data_size - covered) + " bytes at the end of the data belong to no tensor");
  return std::move(events.header);
}

Result<std::string> format_safetensors_header(const SafetensorsHeader& header) {
  try {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    if (!header.metadata.empty()) json["__metadata__"] = header.metadata;
    for (const auto& e : header.entries)
      json[e.tensor.name] = {{"dtype", dtype_name(e.tensor.dtype)},
                             {"shape", e.tensor.shape},
                             {"data_offsets", {e.begin, e.end}}};
    std::string text = json.dump();
    text.resize((text.size() + 7) / 8 * 8, ' ');
    return text;
  } catch (const nlohmann::json::exception&) {
    return Error{Errc::failed, "safetensors header", "a name or metadata text is not UTF-8", ""};
  }
}

}  // namespace mien

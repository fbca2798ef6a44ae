#include "mien/io/npy.h"

#include <cstring>
#include <optional>

#include "mien/base/number_text.h"

namespace mien {
namespace {

constexpr char kNpyMagic[] = "\x93NUMPY";
constexpr std::size_t kMagicSize = 6;
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMaxNpyHeader = 1 << 20;
constexpr std::size_t kMaxDigits = 21;

Error bad_npy(std::string why) { return {Errc::input, ".npy file", std::move(why), ""}; }

// The header is a Python dictionary: {'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }.
class HeaderParser {
 public:
  explicit HeaderParser(std::string_view text) : text_(text) {}

  std::string type;
  std::optional<bool> fortran_order;
  std::optional<std::vector<std::int64_t>> shape;

  bool parse() {
    if (!take('{')) return false;
    while (!take('}')) {
      const auto key = quoted();
      if (!key || !take(':')) return false;
      const bool fine = *key == "descr"           ? parse_type()
                        : *key == "fortran_order" ? parse_order()
                        : *key == "shape"         ? parse_shape()
                                                  : false;
      if (!fine) return false;
      if (!take(',') && peek() != '}') return false;
    }
    return peek() == '\0' && !type.empty() && fortran_order && shape;
  }

 private:
  char peek() {
    while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\n')) text_.remove_prefix(1);
    return text_.empty() ? '\0' : text_.front();
  }
  bool take(char c) {
    if (peek() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  std::optional<std::string_view> quoted() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') return std::nullopt;
    const auto end = text_.find(quote, 1);
    if (end == std::string_view::npos) return std::nullopt;
    const auto inside = text_.substr(1, end - 1);
    text_.remove_prefix(end + 1);
    return inside;
  }
  bool parse_type() {
    const auto value = quoted();
    if (value) type = *value;
    return value.has_value();
  }
  bool parse_order() {
    peek();
    for (const auto& [word, value] : {std::pair{std::string_view("False"), false}, {"True", true}})
      if (text_.starts_with(word)) {
        text_.remove_prefix(word.size());
        fortran_order = value;
        return true;
      }
    return false;
  }
  bool parse_shape() {
    if (!take('(')) return false;
    shape.emplace();
    while (!take(')')) {
      peek();
      const auto end = std::min(text_.find_first_not_of("0123456789"), text_.size());
      const auto size = parse_int(text_.substr(0, end));
      if (!size || shape->size() >= 32) return false;
      shape->push_back(*size);
      text_.remove_prefix(end);
      if (!take(',') && peek() != ')') return false;
    }
    return true;
  }

  std::string_view text_;
};

}  // namespace

Bytes npy_header(std::span<const std::int64_t> shape, std::size_t item_size, std::size_t growing) {
  contract(item_size == 4 || item_size == 8, "npy_header: floats of 4 or 8 bytes");
  std::string text = "{'descr': '<f" + std::to_string(item_size) + "', 'fortran_order': False, 'shape': (";
  for (std::size_t i = 0; i < shape.size(); ++i) {
    contract(shape[i] >= 0, "npy_header: negative size");
    text += std::to_string(shape[i]);
    if (i + 1 < shape.size() || shape.size() == 1) text += i + 1 < shape.size() ? ", " : ",";
  }
  text += "), }";
  // Room for any size of one axis, as NumPy leaves it: an array can grow without its header.
  if (growing < shape.size()) text.append(kMaxDigits - std::to_string(shape[growing]).size(), ' ');
  const std::size_t before = kMagicSize + 4;  // magic, version, length
  while ((before + text.size() + 1) % kAlignment != 0) text += ' ';
  text += '\n';
  Bytes bytes;
  for (std::size_t i = 0; i < kMagicSize; ++i) bytes.push_back(static_cast<std::byte>(kNpyMagic[i]));
  bytes.push_back(std::byte{1});
  bytes.push_back(std::byte{0});
  contract(text.size() < 65536, "npy_header: too many dimensions");
  append_le(bytes, static_cast<std::uint16_t>(text.size()));
  const auto body = as_bytes(text);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Bytes write_npy(const NpyArray& array) {
  std::size_t count = 1;
  for (const auto size : array.shape) count *= static_cast<std::size_t>(size);
  contract(count == array.values.size(), "write_npy: the shape does not fit the values");
  Bytes bytes = npy_header(array.shape);
  const auto data = std::as_bytes(std::span(array.values));
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

namespace {

// What a header says, and where the data begin.
struct ReadHeader {
  std::string type;
  bool fortran = false;
  std::vector<std::int64_t> shape;
  std::size_t data_offset = 0;
};

Result<ReadHeader> read_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kMagicSize + 4 || std::memcmp(bytes.data(), kNpyMagic, kMagicSize) != 0)
    return bad_npy("it does not start like a NumPy array");
  const int version = std::to_integer<int>(bytes[kMagicSize]);
  if (version < 1 || version > 3)
    return Error{Errc::incompatible, ".npy file", "version " + std::to_string(version) + ", expected 1 to 3",
                 ""};
  const std::size_t header_start = kMagicSize + (version == 1 ? 4 : 6);
  const auto long_size = read_le<std::uint32_t>(bytes, kMagicSize + 2);
  const auto short_size = read_le<std::uint16_t>(bytes, kMagicSize + 2);
  if (version > 1 && !long_size) return bad_npy("it ends inside its header");
  const std::size_t header_size = version == 1 ? *short_size : *long_size;
  if (header_size > kMaxNpyHeader || header_size > bytes.size() - header_start)
    return bad_npy("it ends inside its header");
  HeaderParser header(as_text(bytes.subspan(header_start, header_size)));
  if (!header.parse()) return bad_npy("its header is not understood");
  return ReadHeader{header.type, *header.fortran_order, *header.shape, header_start + header_size};
}

// The bytes behind the header must be as many as shape and type say.
Status check_size(std::span<const std::byte> bytes, const ReadHeader& header, std::size_t item) {
  std::size_t count = 1;
  for (const auto size : header.shape) {
    const auto product = checked_multiply(count, static_cast<std::size_t>(size));
    if (!product) return bad_npy("its shape is too large");
    count = *product;
  }
  const auto size = checked_multiply(count, item);
  const std::size_t num_bytes = bytes.size() - header.data_offset;
  if (!size || num_bytes != *size)
    return bad_npy("it has " + std::to_string(num_bytes) + " bytes of data, its shape needs another number");
  return Done{};
}

}  // namespace

Result<NpyLayout> read_npy_layout(std::span<const std::byte> bytes) {
  MIEN_TRY(const ReadHeader header, read_header(bytes));
  const std::size_t item = header.type == "<f4" ? 4 : header.type == "<f8" ? 8 : 0;
  if (item == 0 || header.fortran)
    return Error{Errc::incompatible, ".npy file",
                 "its type is '" + header.type + "'" + (header.fortran ? " in Fortran order" : "") +
                     ", expected '<f4' or '<f8' in C order",
                 "Save it with numpy.ascontiguousarray(a, dtype='float32')"};
  MIEN_TRY([[maybe_unused]] const auto fits, check_size(bytes, header, item));
  return NpyLayout{header.shape, item, header.data_offset};
}

Result<PickleArray> npy_elements(std::span<const std::byte> bytes) {
  MIEN_TRY(const ReadHeader header, read_header(bytes));
  const std::string& type = header.type;  // "<f8", "|b1"
  const auto item = type.size() >= 3 ? parse_int(std::string_view(type).substr(2)) : std::nullopt;
  if (!item || *item < 1 || *item > 16 || std::string_view("<>|=").find(type[0]) == std::string_view::npos ||
      std::string_view("fiub").find(type[1]) == std::string_view::npos)
    return Error{Errc::incompatible, ".npy file", "its type '" + type + "' is no number", ""};
  MIEN_TRY([[maybe_unused]] const auto fits, check_size(bytes, header, static_cast<std::size_t>(*item)));
  return PickleArray{.kind = type[1],
                     .item_size = static_cast<std::size_t>(*item),
                     .big_endian = type[0] == '>',
                     .fortran = header.fortran,
                     .shape = header.shape,
                     .data = bytes.subspan(header.data_offset)};
}

Result<NpyArray> read_npy(std::span<const std::byte> bytes) {
  MIEN_TRY(const NpyLayout layout, read_npy_layout(bytes));
  const auto data = bytes.subspan(layout.data_offset);
  const std::size_t count = data.size() / layout.item_size;
  NpyArray array{layout.shape, std::vector<float>(count)};
  if (layout.item_size == 4) {
    if (count > 0) std::memcpy(array.values.data(), data.data(), data.size());
  } else {
    for (std::size_t i = 0; i < count; ++i)
      array.values[i] = static_cast<float>(*read_le<double>(data, i * 8));
  }
  return array;
}

}  // namespace mien

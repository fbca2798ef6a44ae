#include <algorithm>
#include <cmath>
#include <optional>

#include "mien/base/number_text.h"
#include "mien/io/mesh_file.h"
#include "polygon.h"

namespace mien {
namespace {

constexpr std::size_t kMaxPlyHeader = 1 << 20;
constexpr std::size_t kMaxElements = 200'000'000;  // of one kind; each takes at least a byte of the file

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<Type> parse_type(std::string_view name) {
  constexpr std::pair<std::string_view, Type> kNames[] = {
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type = Type::f32;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool binary = false;
  std::vector<Element> elements;
};

Error bad_ply(std::string why) { return {Errc::input, "PLY file", std::move(why), ""}; }

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = 0;;) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) return words;
    const auto end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.emplace_back(line.substr(at, end - at));
    at = end;
  }
}

Status read_header_line(const std::vector<std::string>& words, Header& header) {
  const auto fail = [&] {
    return bad_ply("its header has a line '" + words.front() + " ...' that is not understood");
  };
  if (words[0] == "comment" || words[0] == "obj_info" || words[0] == "ply") return Done{};
  if (words[0] == "format" && words.size() == 3) {
    if (words[1] == "binary_big_endian")
      return Error{Errc::incompatible, "PLY file", "it is big-endian",
                   "Save it as ascii or binary little-endian"};
    header.binary = words[1] == "binary_little_endian";
    return header.binary || words[1] == "ascii" ? Status(Done{}) : Status(fail());
  }
  if (words[0] == "element" && words.size() == 3) {
    const auto count = parse_int(words[2]);
    if (!count || *count < 0 || static_cast<std::size_t>(*count) > kMaxElements) return fail();
    header.elements.push_back({words[1], static_cast<std::size_t>(*count), {}});
    return Done{};
  }
  if (words[0] == "property" && !header.elements.empty()) {
    auto& properties = header.elements.back().properties;
    if (words.size() == 3) {
      const auto type = parse_type(words[1]);
      if (!type) return fail();
      properties.push_back({words[2], *type, std::nullopt});
      return Done{};
    }
    if (words.size() == 5 && words[1] == "list") {
      const auto count = parse_type(words[2]), type = parse_type(words[3]);
      if (!count || !type) return fail();
      properties.push_back({words[4], *type, count});
      return Done{};
    }
  }
  return fail();
}

// Numbers of the body, one after the other.
class Body {
 public:
  Body(std::span<const std::byte> bytes, bool binary) : bytes_(bytes), binary_(binary) {}

  std::optional<double> next(Type type) { return binary_ ? next_binary(type) : next_word(); }

 private:
  template <class T>
  std::optional<double> take() {
    const auto value = read_le<T>(bytes_, 0);
    if (!value) return std::nullopt;
    bytes_ = bytes_.subspan(sizeof(T));
    return static_cast<double>(*value);
  }
  std::optional<double> next_binary(Type type) {
    switch (type) {
      case Type::i8:
        return take<std::int8_t>();
      case Type::u8:
        return take<std::uint8_t>();
      case Type::i16:
        return take<std::int16_t>();
      case Type::u16:
        return take<std::uint16_t>();
      case Type::i32:
        return take<std::int32_t>();
      case Type::u32:
        return take<std::uint32_t>();
      case Type::f32:
        return take<float>();
      case Type::f64:
        return take<double>();
    }
    return std::nullopt;
  }
  std::optional<double> next_word() {
    const auto text = as_text(bytes_);
    const auto start = text.find_first_not_of(" \t\r\n");
    if (start == std::string_view::npos) return std::nullopt;
    const auto end = std::min(text.find_first_of(" \t\r\n", start), text.size());
    bytes_ = bytes_.subspan(end);
    return parse_double(text.substr(start, end - start));
  }

  std::span<const std::byte> bytes_;
  bool binary_;
};

Status read_list(Body& body, const Property& property, std::vector<double>& list) {
  const auto count = body.next(*property.count_type);
  if (!count || *count < 0 || *count != std::floor(*count)) return bad_ply("a list has no length");
  list.clear();
  for (double i = 0; i < *count; ++i) {
    const auto value = body.next(property.type);
    if (!value) return bad_ply("it ends inside a list");
    list.push_back(*value);
  }
  return Done{};
}

Status read_element(Body& body, const Element& element, Mesh& mesh) {
  std::vector<double> list;
  std::vector<std::uint32_t> corners;
  const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
  for (std::size_t i = 0; i < element.count; ++i) {
    Vec3 p;
    int num_axes = 0;
    for (const auto& property : element.properties) {
      if (property.count_type) {
        MIEN_TRY([[maybe_unused]] const auto read, read_list(body, property, list));
        if (!is_face || (property.name != "vertex_indices" && property.name != "vertex_index")) continue;
        if (list.size() < 3) return bad_ply("face " + std::to_string(i) + " has fewer than three corners");
        corners.clear();
        for (const double v : list) {
          if (!(v >= 0 && v <= 4294967295.0) || v != std::floor(v))
            return bad_ply("face " + std::to_string(i) + " names no vertex");
          corners.push_back(static_cast<std::uint32_t>(v));
        }
        io::add_fan(corners, mesh.triangles);
        continue;
      }
      const auto value = body.next(property.type);
      if (!value) return bad_ply("it ends inside " + element.name + " " + std::to_string(i));
      float* axis = property.name == "x"   ? &p.x
                    : property.name == "y" ? &p.y
                    : property.name == "z" ? &p.z
                                           : nullptr;
      if (!is_vertex || axis == nullptr) continue;
      *axis = static_cast<float>(*value), ++num_axes;
      if (!std::isfinite(*axis)) return bad_ply("vertex " + std::to_string(i) + " is not finite");
    }
    if (!is_vertex) continue;
    if (num_axes != 3) return bad_ply("its vertices do not have one x, one y and one z");
    mesh.positions.push_back(p);
  }
  return Done{};
}

}  // namespace

Result<Mesh> read_ply(std::span<const std::byte> bytes) {
  const auto text = as_text(bytes.subspan(0, std::min(bytes.size(), kMaxPlyHeader)));
  if (!text.starts_with("ply")) return bad_ply("it does not start with 'ply'");
  Header header;
  bool ended = false;
  std::size_t at = 0;
  while (!ended) {
    const auto end = text.find('\n', at);
    if (end == std::string_view::npos) return bad_ply("its header has no end");
    const auto words = words_of(text.substr(at, end - at));
    at = end + 1;
    if (words.empty()) continue;
    ended = words[0] == "end_header";
    if (ended) break;
    MIEN_TRY([[maybe_unused]] const auto read, read_header_line(words, header));
  }
  Mesh mesh;
  Body body(bytes.subspan(at), header.binary);
  for (const auto& element : header.elements) {
    // A number takes a byte at least, so a count beyond the bytes left is damage; elements without properties
    // hold nothing.
    if (element.properties.empty()) continue;
    if (element.count > bytes.size() - at)
      return bad_ply("it announces " + std::to_string(element.count) + " of '" + element.name +
                     "', more than its bytes");
    MIEN_TRY([[maybe_unused]] const auto read, read_element(body, element, mesh));
  }
  if (const auto stray = io::stray_vertex(mesh))
    return bad_ply("a face names vertex " + std::to_string(*stray) + " of " +
                   std::to_string(mesh.positions.size()));
  return mesh;
}

}  // namespace mien

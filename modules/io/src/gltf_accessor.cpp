#include "gltf_accessor.h"

#include <algorithm>
#include <cmath>

#include "gltf_component_type.h"

namespace mien::io {
namespace {

Error bad_accessor(std::size_t accessor, std::string why) {
  return {Errc::input, "glTF accessor " + std::to_string(accessor), std::move(why), ""};
}

std::size_t component_size(std::uint32_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

int components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  return 0;
}

template <class T>
T load(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

// One stored component, before normalisation.
double component(const std::byte* at, std::uint32_t type) {
  switch (type) {
    case kByte:
      return load<std::int8_t>(at);
    case kUnsignedByte:
      return load<std::uint8_t>(at);
    case kShort:
      return load<std::int16_t>(at);
    case kUnsignedShort:
      return load<std::uint16_t>(at);
    case kUnsignedInt:
      return load<std::uint32_t>(at);
    default:
      return load<float>(at);
  }
}

// Divisor of normalised integers; signed ones are cut at -1.
double full_scale(std::uint32_t type) {
  switch (type) {
    case kByte:
      return 127;
    case kUnsignedByte:
      return 255;
    case kShort:
      return 32767;
    case kUnsignedShort:
      return 65535;
    default:
      return 1;
  }
}

// Rows of `row_size` bytes, `stride` apart.
struct Rows {
  std::span<const std::byte> data;
  std::size_t stride = 0;
  [[nodiscard]] const std::byte* row(std::size_t i) const { return data.data() + i * stride; }
};

Result<Rows> locate(const GltfDocument& document, std::size_t accessor, const Json& source, std::size_t count,
                    std::size_t row_size, bool may_stride) {
  const auto view = index_member(source, "bufferView");
  if (!view) return bad_accessor(accessor, "names no bufferView");
  MIEN_TRY(const auto bytes, view_bytes(document, *view));
  const std::size_t offset = index_member(source, "byteOffset").value_or(0);
  const std::size_t stride =
      may_stride ? index_member(document.json["bufferViews"][*view], "byteStride").value_or(row_size)
                 : row_size;
  if (stride < row_size || stride > 65536)
    return bad_accessor(accessor, "the stride does not hold one element");
  if (offset > bytes.size()) return bad_accessor(accessor, "lies outside its bufferView");
  const std::size_t room = bytes.size() - offset;
  if (room < row_size || (room - row_size) / stride < count - 1)
    return bad_accessor(accessor, "lies outside its bufferView");
  return Rows{bytes.subspan(offset), stride};
}

Result<std::vector<std::uint32_t>> read_sparse_indices(const GltfDocument& document, std::size_t accessor,
                                                       const Json& indices, std::size_t sparse_count,
                                                       std::size_t count) {
  const auto type = static_cast<std::uint32_t>(index_member(indices, "componentType").value_or(0));
  if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)
    return bad_accessor(accessor, "its sparse indices are not unsigned integers");
  MIEN_TRY(const auto rows, locate(document, accessor, indices, sparse_count, component_size(type), false));
  std::vector<std::uint32_t> out(sparse_count);
  for (std::size_t i = 0; i < sparse_count; ++i) {
    out[i] = static_cast<std::uint32_t>(component(rows.row(i), type));
    if (out[i] >= count || (i > 0 && out[i] <= out[i - 1]))
      return bad_accessor(accessor, "its sparse indices do not rise or do not fit");
  }
  return out;
}

template <class T>
Result<std::vector<T>> read(const GltfDocument& document, std::size_t accessor, int components,
                            std::size_t expected_count) {
  MIEN_TRY(const AccessorInfo info, accessor_info(document, accessor));
  if (info.components != components)
    return bad_accessor(accessor, "has " + std::to_string(info.components) + " components, expected " +
                                      std::to_string(components));
  if (expected_count != 0 && info.count != expected_count)
    return bad_accessor(accessor, "has " + std::to_string(info.count) + " elements, expected " +
                                      std::to_string(expected_count));
  const Json& entry = document.json["accessors"][accessor];
  const bool normalised = member(entry, "normalized") == Json(true);
  const double scale = normalised ? full_scale(info.component_type) : 1.0;
  const auto width = static_cast<std::size_t>(components);
  const std::size_t size = component_size(info.component_type);

  const auto convert = [&](const std::byte* row, T* out) {
    for (std::size_t c = 0; c < width; ++c) {
      const double value = component(row + c * size, info.component_type);
      out[c] = static_cast<T>(scale == 1.0 ? value : std::max(value / scale, -1.0));
    }
  };

  const bool has_view = index_member(entry, "bufferView").has_value();
  if (!has_view && expected_count == 0) return bad_accessor(accessor, "names no bufferView");
  std::vector<T> values;
  if (has_view) {
    MIEN_TRY(const auto rows, locate(document, accessor, entry, info.count, width * size, true));
    values.resize(info.count * width);
    for (std::size_t i = 0; i < info.count; ++i) convert(rows.row(i), &values[i * width]);
  } else {
    values.resize(info.count * width);
  }

  if (const Json& sparse = member(entry, "sparse"); sparse.is_object()) {
    const std::size_t sparse_count = index_member(sparse, "count").value_or(0);
    if (sparse_count == 0 || sparse_count > info.count)
      return bad_accessor(accessor, "its sparse count does not fit");
    MIEN_TRY(const auto indices,
             read_sparse_indices(document, accessor, member(sparse, "indices"), sparse_count, info.count));
    MIEN_TRY(const auto rows,
             locate(document, accessor, member(sparse, "values"), sparse_count, width * size, false));
    for (std::size_t i = 0; i < sparse_count; ++i) convert(rows.row(i), &values[indices[i] * width]);
  }
  return values;
}

}  // namespace

Result<AccessorInfo> accessor_info(const GltfDocument& document, std::size_t accessor) {
  const Json& accessors = array_member(document.json, "accessors");
  if (accessor >= accessors.size()) return bad_accessor(accessor, "does not exist");
  const Json& entry = accessors[accessor];
  const auto count = index_member(entry, "count");
  const auto type = index_member(entry, "componentType").value_or(0);
  const AccessorInfo info{count.value_or(0), components_of(text_member(entry, "type")),
                          static_cast<std::uint32_t>(std::min<std::size_t>(type, 65535))};
  if (info.count == 0 || info.count > 0x7fffffff) return bad_accessor(accessor, "has no usable count");
  if (info.components == 0 || component_size(info.component_type) == 0)
    return bad_accessor(accessor, "has a type or componentType that glTF does not know");
  return info;
}

Result<std::vector<float>> read_floats(const GltfDocument& document, std::size_t accessor, int components,
                                       std::size_t expected_count) {
  auto values = read<float>(document, accessor, components, expected_count);
  if (values && !std::all_of(values->begin(), values->end(), [](float v) { return std::isfinite(v); }))
    return bad_accessor(accessor, "holds a number that is not finite");
  return values;
}

Result<std::vector<std::uint32_t>> read_integers(const GltfDocument& document, std::size_t accessor,
                                                 int components, std::size_t expected_count) {
  MIEN_TRY(const AccessorInfo info, accessor_info(document, accessor));
  if (info.component_type != kUnsignedByte && info.component_type != kUnsignedShort &&
      info.component_type != kUnsignedInt)
    return bad_accessor(accessor, "holds no unsigned integers");
  return read<std::uint32_t>(document, accessor, components, expected_count);
}

}  // namespace mien::io

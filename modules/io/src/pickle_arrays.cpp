// NumPy's part of PickleCalls: element types, arrays, scalars. Layout: numpy/core/src/multiarray, versions 1
// to 2.
#include <algorithm>
#include <charconv>

#include "pickle_calls.h"

namespace mien {

PickleRef PickleCalls::add_array(PickleArray array) {
  const PickleRef ref =
      add({.kind = PickleKind::array, .record = static_cast<std::uint32_t>(heap_.arrays.size())});
  if (ref != kNoRef) heap_.arrays.push_back(std::move(array));
  return ref;
}

// dtype("f8", align, copy): a letter and the bytes of an element. Types without numbers keep their letter.
PickleRef PickleCalls::numpy_dtype(PickleRef args) {
  const auto name = items(args).empty() ? std::nullopt : text(items(args)[0]);
  if (!name || name->empty()) return fail("has a NumPy type without a name");
  NumpyType type{.kind = (*name)[0]};
  const auto digits = name->substr(1);
  if (!digits.empty()) {
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), type.item_size);
    if (problem != std::errc() || end != digits.data() + digits.size())
      return fail("has the NumPy type '" + std::string(*name) + "', which Mien does not read",
                  Errc::incompatible);
  }
  if (type.kind == 'U') type.item_size = type.item_size < 1u << 30 ? 4 * type.item_size : 0;  // UTF-32
  const PickleRef ref =
      add({.kind = PickleKind::dtype, .record = static_cast<std::uint32_t>(heap_.dtypes.size())});
  if (ref != kNoRef) heap_.dtypes.push_back(type);
  return ref;
}

// (version, byte order, sub-array, names, fields, ...)
bool PickleCalls::build_dtype(PickleRef object, PickleRef state) {
  if (node(state).kind != PickleKind::tuple || items(state).size() < 5)
    return fail("has a damaged NumPy type"), false;
  for (std::size_t i = 2; i < 5; ++i)
    if (node(items(state)[i]).kind != PickleKind::none)
      return fail("has a NumPy type with fields", Errc::incompatible), false;
  const auto order = text(items(state)[1]);
  if (!order || order->size() != 1 || std::string_view("<>=|").find((*order)[0]) == std::string_view::npos)
    return fail("has a NumPy type without a byte order"), false;
  heap_.dtypes[node(object).record].big_endian = *order == ">";
  return true;
}

bool PickleCalls::check_array(const PickleArray& array) {
  std::optional<std::size_t> size = array.item_size;
  for (const auto n : array.shape) size = size ? checked_multiply(*size, static_cast<std::size_t>(n)) : size;
  // An empty array may name absurd other sizes; nothing is stored for it.
  const bool is_empty = std::ranges::find(array.shape, 0) != array.shape.end();
  if (is_empty) size = 0;
  if (size && *size == array.data.size()) return true;
  return fail("has an array whose shape does not fit its " + std::to_string(array.data.size()) +
              " bytes of data"),
         false;
}

// (version, shape, dtype, is_fortran, data)
bool PickleCalls::build_array(PickleRef object, PickleRef state) {
  if (node(state).kind != PickleKind::tuple || items(state).size() != 5)
    return fail("has an array without a description"), false;
  const auto& parts = items(state);
  auto shape = sizes(parts[1]);
  const auto fortran = integer(parts[3]);
  if (!shape || !fortran || node(parts[2]).kind != PickleKind::dtype)
    return fail("has an array with a damaged description"), false;
  const NumpyType type = heap_.dtypes[node(parts[2]).record];
  PickleArray& array = heap_.arrays[node(object).record];
  array = {.kind = type.kind,
           .item_size = type.item_size,
           .big_endian = type.big_endian,
           .fortran = *fortran != 0,
           .shape = std::move(*shape),
           .data = {}};
  if (type.kind == 'O') {  // objects: a list of values, of which none is read
    array.shape = {0};
    return true;
  }
  const auto& data = node(parts[4]);
  if (data.kind != PickleKind::bytes && data.kind != PickleKind::text)
    return fail("has an array without data"), false;
  array.data = as_bytes(data.text);
  return check_array(array);
}

// _frombuffer(data, dtype, shape, order), of protocol 5
PickleRef PickleCalls::numpy_from_buffer(PickleRef args) {
  const auto& parts = items(args);
  if (parts.size() != 4 || node(parts[0]).kind != PickleKind::bytes ||
      node(parts[1]).kind != PickleKind::dtype)
    return fail("has an array with a damaged description");
  auto shape = sizes(parts[2]);
  const auto order = text(parts[3]);
  if (!shape || !order) return fail("has an array with a damaged description");
  const NumpyType type = heap_.dtypes[node(parts[1]).record];
  PickleArray array{.kind = type.kind,
                    .item_size = type.item_size,
                    .big_endian = type.big_endian,
                    .fortran = *order == "F",
                    .shape = std::move(*shape),
                    .data = as_bytes(node(parts[0]).text)};
  if (!check_array(array)) return kNoRef;
  return add_array(std::move(array));
}

// scalar(dtype, data)
PickleRef PickleCalls::numpy_scalar(PickleRef args) {
  const auto& parts = items(args);
  if (parts.size() != 2 || node(parts[0]).kind != PickleKind::dtype)
    return fail("has a NumPy scalar with a damaged description");
  const NumpyType type = heap_.dtypes[node(parts[0]).record];
  if (node(parts[1]).kind != PickleKind::bytes && node(parts[1]).kind != PickleKind::text)
    return add({});  // of an object: not read
  const PickleArray one{.kind = type.kind,
                        .item_size = type.item_size,
                        .big_endian = type.big_endian,
                        .fortran = false,
                        .shape = {},
                        .data = as_bytes(node(parts[1]).text)};
  if (!check_array(one)) return kNoRef;
  const auto value = one.to_doubles();
  if (!value) return add({});
  if (type.kind == 'f') return add({.kind = PickleKind::real, .real = value->front()});
  if (type.kind == 'b') return add({.kind = PickleKind::boolean, .integer = value->front() != 0});
  std::int64_t integer = 0;  // bit by bit: a double would round beyond 2^53
  for (std::size_t i = 0; i < type.item_size; ++i) {
    const auto byte = one.data[type.big_endian ? i : type.item_size - 1 - i];
    integer = static_cast<std::int64_t>((static_cast<std::uint64_t>(integer) << 8) |
                                        static_cast<std::uint64_t>(byte));
  }
  if (type.kind == 'i' && type.item_size < 8 && (integer >> (8 * type.item_size - 1)) != 0)
    integer -= std::int64_t{1} << (8 * type.item_size);
  return add({.kind = PickleKind::integer, .integer = integer});
}

}  // namespace mien

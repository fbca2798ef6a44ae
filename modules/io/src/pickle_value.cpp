#include <bit>

#include "mien/base/contract.h"
#include "pickle_heap.h"

namespace mien {
namespace {

// Calls use(i, value) for every element in the order it is stored.
template <class T, class Use>
void for_each_element(const PickleArray& array, Use&& use) {
  const std::size_t count = array.data.size() / sizeof(T);
  for (std::size_t i = 0; i < count; ++i) {
    std::byte raw[sizeof(T)];
    for (std::size_t b = 0; b < sizeof(T); ++b)
      raw[b] = array.data[i * sizeof(T) + (array.big_endian ? sizeof(T) - 1 - b : b)];
    use(i, *read_le<T>(raw, 0));
  }
}

template <class Use>
bool for_each_number(const PickleArray& array, Use&& use) {
  const auto as_double = [&](std::size_t i, auto value) { use(i, static_cast<double>(value)); };
  switch (array.kind) {
    case 'f':
      if (array.item_size == 8) return for_each_element<double>(array, as_double), true;
      if (array.item_size == 4) return for_each_element<float>(array, as_double), true;
      if (array.item_size == 2)
        return for_each_element<std::uint16_t>(
                   array, [&](std::size_t i, std::uint16_t h) { use(i, half_to_float(h)); }),
               true;
      return false;
    case 'i':
      if (array.item_size == 8) return for_each_element<std::int64_t>(array, as_double), true;
      if (array.item_size == 4) return for_each_element<std::int32_t>(array, as_double), true;
      if (array.item_size == 2) return for_each_element<std::int16_t>(array, as_double), true;
      if (array.item_size == 1) return for_each_element<std::int8_t>(array, as_double), true;
      return false;
    case 'u':
    case 'b':
      if (array.item_size == 8) return for_each_element<std::uint64_t>(array, as_double), true;
      if (array.item_size == 4) return for_each_element<std::uint32_t>(array, as_double), true;
      if (array.item_size == 2) return for_each_element<std::uint16_t>(array, as_double), true;
      if (array.item_size == 1) return for_each_element<std::uint8_t>(array, as_double), true;
      return false;
    default:
      return false;
  }
}

// Place in row-major order of the element that is stored at `i` with the first index fastest.
std::size_t from_fortran(std::size_t i, const std::vector<std::int64_t>& shape) {
  std::size_t place = 0, stride = 1;
  for (const auto size : shape) stride *= static_cast<std::size_t>(size);
  for (const auto size : shape) {
    stride /= static_cast<std::size_t>(size);
    place += i % static_cast<std::size_t>(size) * stride;
    i /= static_cast<std::size_t>(size);
  }
  return place;
}

template <class T>
Result<std::vector<T>> convert(const PickleArray& array) {
  std::vector<T> values(static_cast<std::size_t>(array.count()));
  const bool fortran = array.fortran && array.shape.size() > 1;
  if (!for_each_number(array, [&](std::size_t i, double value) {
        values[fortran ? from_fortran(i, array.shape) : i] = static_cast<T>(value);
      }))
    return Error{Errc::incompatible, "array",
                 std::string("has elements of NumPy type '") + array.kind + std::to_string(array.item_size) +
                     "', which are no numbers that Mien reads",
                 ""};
  return values;
}

}  // namespace

std::int64_t PickleArray::count() const {
  std::int64_t count = 1;
  for (const auto size : shape) count *= size;
  return count;
}
Result<std::vector<double>> PickleArray::to_doubles() const { return convert<double>(*this); }
Result<std::vector<float>> PickleArray::to_floats() const { return convert<float>(*this); }

PickleKind PickleValue::kind() const { return heap_->nodes[index_].kind; }

std::optional<bool> PickleValue::boolean() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind != PickleKind::boolean) return std::nullopt;
  return node.integer != 0;
}
std::optional<std::int64_t> PickleValue::integer() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind != PickleKind::integer) return std::nullopt;
  return node.integer;
}
std::optional<double> PickleValue::number() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind == PickleKind::integer) return static_cast<double>(node.integer);
  if (node.kind == PickleKind::real) return node.real;
  return std::nullopt;
}
std::optional<std::string_view> PickleValue::text() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind != PickleKind::text) return std::nullopt;
  return node.text;
}
std::optional<std::span<const std::byte>> PickleValue::bytes() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind != PickleKind::text && node.kind != PickleKind::bytes && node.kind != PickleKind::big_integer)
    return std::nullopt;
  return as_bytes(node.text);
}
const PickleArray* PickleValue::array() const {
  const auto& node = heap_->nodes[index_];
  return node.kind == PickleKind::array ? &heap_->arrays[node.record] : nullptr;
}
const PickleStorage* PickleValue::storage() const {
  const auto& node = heap_->nodes[index_];
  return node.kind == PickleKind::storage ? &heap_->node_storages[node.record] : nullptr;
}
const PickleTensor* PickleValue::tensor() const {
  const auto& node = heap_->nodes[index_];
  return node.kind == PickleKind::tensor ? &heap_->tensors[node.record] : nullptr;
}
std::string_view PickleValue::class_name() const {
  const auto& node = heap_->nodes[index_];
  const bool has_name = node.kind == PickleKind::global || node.kind == PickleKind::object;
  return has_name ? node.text : std::string_view();
}

std::size_t PickleValue::size() const {
  const auto& node = heap_->nodes[index_];
  if (node.kind == PickleKind::object) return heap_->nodes[node.record].items.size();
  return node.kind == PickleKind::dict ? node.items.size() / 2 : node.items.size();
}
PickleValue PickleValue::operator[](std::size_t i) const {
  contract(i < size(), "PickleValue: item out of range");
  const auto& node = heap_->nodes[index_];
  if (node.kind == PickleKind::object) return {heap_, heap_->nodes[node.record].items[i]};
  return {heap_, node.items[node.kind == PickleKind::dict ? 2 * i + 1 : i]};
}
PickleValue PickleValue::key(std::size_t i) const {
  contract(kind() == PickleKind::dict && i < size(), "PickleValue: key out of range");
  return {heap_, heap_->nodes[index_].items[2 * i]};
}
std::optional<PickleValue> PickleValue::find(std::string_view wanted) const {
  if (kind() != PickleKind::dict) return std::nullopt;
  for (std::size_t i = size(); i-- > 0;)
    if (key(i).text() == wanted) return (*this)[i];
  return std::nullopt;
}
std::optional<PickleValue> PickleValue::state() const {
  const auto& node = heap_->nodes[index_];
  if (node.state == kNoRef) return std::nullopt;
  return PickleValue(heap_, node.state);
}

Pickle::Pickle(std::unique_ptr<PickleHeap> heap) : heap_(std::move(heap)) {}
Pickle::Pickle(Pickle&&) noexcept = default;
Pickle& Pickle::operator=(Pickle&&) noexcept = default;
Pickle::~Pickle() = default;
PickleValue Pickle::root() const { return {heap_.get(), heap_->root}; }
std::size_t Pickle::size() const { return heap_->size; }
const std::vector<PickleStorage>& Pickle::storages() const { return heap_->storages; }

}  // namespace mien

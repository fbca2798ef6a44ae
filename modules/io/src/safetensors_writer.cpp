#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <unordered_map>

#include "mien/base/file.h"
#include "mien/io/safetensors.h"
#include "safetensors_header.h"

namespace mien {
namespace {

std::uint16_t float_to_bfloat(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if (std::isnan(value)) return static_cast<std::uint16_t>((bits >> 16) | 0x40u);  // stays a NaN
  return static_cast<std::uint16_t>((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

}  // namespace

struct SafetensorsWriter::State {
  struct Slot {
    StoredTensor tensor;
    std::size_t begin = 0, end = 0;  ///< bytes of the file
    std::size_t cursor = 0;          ///< bytes from `begin`, where write() goes on
    std::size_t written = 0;
  };
  AtomicFile file;
  std::vector<Slot> slots;
  std::unordered_map<std::string, std::size_t> index;

  explicit State(AtomicFile f) : file(std::move(f)) {}

  Slot& slot(std::string_view tensor) {
    const auto found = index.find(std::string(tensor));
    contract(found != index.end(), "SafetensorsWriter: '" + std::string(tensor) + "' was not declared");
    return slots[found->second];
  }
  /// `offset` in bytes from the tensor's begin.
  Status fill(Slot& s, std::size_t offset, std::span<const std::byte> bytes) {
    const std::size_t size = s.end - s.begin;
    contract(offset <= size && bytes.size() <= size - offset && bytes.size() <= size - s.written,
             "SafetensorsWriter: more elements than the declared shape of '" + s.tensor.name + "' has");
    MIEN_TRY([[maybe_unused]] const auto done, file.write_at(s.begin + offset, bytes));
    s.written += bytes.size();
    return Done{};
  }
};

SafetensorsWriter::SafetensorsWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SafetensorsWriter::SafetensorsWriter(SafetensorsWriter&&) noexcept = default;
SafetensorsWriter& SafetensorsWriter::operator=(SafetensorsWriter&&) noexcept = default;
SafetensorsWriter::~SafetensorsWriter() = default;

Result<SafetensorsWriter> SafetensorsWriter::create(const std::filesystem::path& path,
                                                    std::vector<StoredTensor> tensors,
                                                    const Metadata& metadata) {
  std::stable_sort(tensors.begin(), tensors.end(),
                   [](const auto& a, const auto& b) { return dtype_size(a.dtype) > dtype_size(b.dtype); });
  SafetensorsHeader header{metadata, {}};
  std::set<std::string> names;
  std::size_t offset = 0;
  for (const auto& tensor : tensors) {
    contract(!tensor.name.empty() && tensor.name != "__metadata__" && names.insert(tensor.name).second,
             "SafetensorsWriter: empty, reserved or repeated tensor name '" + tensor.name + "'");
    contract(std::ranges::all_of(tensor.shape, [](auto n) { return n >= 0; }),
             "SafetensorsWriter: negative size in the shape of '" + tensor.name + "'");
    const auto size = stored_size(tensor);
    contract(size.has_value() && *size <= static_cast<std::size_t>(INT64_MAX) - offset,
             "SafetensorsWriter: the shape of '" + tensor.name + "' is too large to exist");
    header.entries.push_back({tensor, offset, offset + *size});
    offset += *size;
  }
  auto text = format_safetensors_header(header);
  if (!text) return within(text.error(), "'" + path.string() + "'");
  MIEN_TRY(auto file, AtomicFile::create(path));
  Bytes start;
  append_le<std::uint64_t>(start, text->size());
  const auto text_bytes = as_bytes(*text);
  start.insert(start.end(), text_bytes.begin(), text_bytes.end());

  auto state = std::make_unique<State>(std::move(file));
  for (auto& entry : header.entries) {
    state->index[entry.tensor.name] = state->slots.size();
    state->slots.push_back(
        {std::move(entry.tensor), start.size() + entry.begin, start.size() + entry.end, 0, 0});
  }
  MIEN_TRY([[maybe_unused]] const auto done, state->file.write(start));
  return SafetensorsWriter(std::move(state));
}

Status SafetensorsWriter::write_elements(std::string_view name, bool (*holds)(Dtype),
                                         std::span<const std::byte> bytes) {
  auto& slot = state_->slot(name);
  contract(holds(slot.tensor.dtype),
           "SafetensorsWriter: '" + slot.tensor.name + "' has another element type");
  MIEN_TRY([[maybe_unused]] const auto done, state_->fill(slot, slot.cursor, bytes));
  slot.cursor += bytes.size();
  return Done{};
}

Status SafetensorsWriter::write_elements_at(std::string_view name, std::int64_t first, bool (*holds)(Dtype),
                                            std::span<const std::byte> bytes) {
  auto& slot = state_->slot(name);
  contract(holds(slot.tensor.dtype),
           "SafetensorsWriter: '" + slot.tensor.name + "' has another element type");
  const std::size_t size = dtype_size(slot.tensor.dtype);
  contract(first >= 0 && static_cast<std::size_t>(first) <= (slot.end - slot.begin) / size,
           "SafetensorsWriter: first element outside '" + slot.tensor.name + "'");
  return state_->fill(slot, static_cast<std::size_t>(first) * size, bytes);
}

Status SafetensorsWriter::write_float(std::string_view name, std::span<const float> values) {
  auto& slot = state_->slot(name);
  const std::size_t size = dtype_size(slot.tensor.dtype);
  MIEN_TRY([[maybe_unused]] const auto done,
           write_float_at(name, static_cast<std::int64_t>(slot.cursor / size), values));
  slot.cursor += values.size() * size;
  return Done{};
}

Status SafetensorsWriter::write_float_at(std::string_view name, std::int64_t first,
                                         std::span<const float> values) {
  const Dtype dtype = state_->slot(name).tensor.dtype;
  const auto convert = [&](auto element_of) {
    std::vector<decltype(element_of(0.0f))> elements(values.size());
    std::ranges::transform(values, elements.begin(), element_of);
    return write_at(name, first, std::span<const decltype(element_of(0.0f))>(elements));
  };
  switch (dtype) {
    case Dtype::f32:
      return write_at(name, first, values);
    case Dtype::f64:
      return convert([](float x) { return static_cast<double>(x); });
    case Dtype::f16:
      return convert([](float x) { return float_to_half(x); });
    case Dtype::bf16:
      return convert([](float x) { return float_to_bfloat(x); });
    default:
      contract(false,
               "SafetensorsWriter::write_float: '" + std::string(name) + "' is not a floating-point tensor");
  }
  return Done{};
}

Status SafetensorsWriter::finish() {
  for (const auto& slot : state_->slots)
    contract(slot.written == slot.end - slot.begin,
             "SafetensorsWriter::finish: '" + slot.tensor.name + "' is incomplete");
  return state_->file.commit();
}

}  // namespace mien

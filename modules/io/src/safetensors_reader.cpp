#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "float_elements.h"
#include "mien/io/mapped_file.h"
#include "mien/io/safetensors.h"
#include "safetensors_header.h"

namespace mien {
namespace {

constexpr std::size_t kMaxHeaderSize = 100'000'000;  // limit of the format

std::string shape_text(std::span<const std::int64_t> shape) {
  std::string text = "[";
  for (std::size_t i = 0; i < shape.size(); ++i)
    text += (i ? ", " : "") + (shape[i] < 0 ? std::string("any") : std::to_string(shape[i]));
  return text + "]";
}

}  // namespace

template <class T>
bool dtype_holds(Dtype dtype) {
  if constexpr (std::is_same_v<T, double>) return dtype == Dtype::f64;
  if constexpr (std::is_same_v<T, float>) return dtype == Dtype::f32;
  if constexpr (std::is_same_v<T, std::uint16_t>) return dtype == Dtype::f16 || dtype == Dtype::bf16;
  if constexpr (std::is_same_v<T, std::int64_t>) return dtype == Dtype::i64;
  if constexpr (std::is_same_v<T, std::int32_t>) return dtype == Dtype::i32;
  if constexpr (std::is_same_v<T, std::int16_t>) return dtype == Dtype::i16;
  if constexpr (std::is_same_v<T, std::int8_t>) return dtype == Dtype::i8;
  if constexpr (std::is_same_v<T, std::uint8_t>) return dtype == Dtype::u8 || dtype == Dtype::boolean;
  return false;
}
template bool dtype_holds<double>(Dtype);
template bool dtype_holds<float>(Dtype);
template bool dtype_holds<std::uint16_t>(Dtype);
template bool dtype_holds<std::int64_t>(Dtype);
template bool dtype_holds<std::int32_t>(Dtype);
template bool dtype_holds<std::int16_t>(Dtype);
template bool dtype_holds<std::int8_t>(Dtype);
template bool dtype_holds<std::uint8_t>(Dtype);

struct SafetensorsFile::State {
  std::string name;  ///< for messages
  MappedFile file;
  Bytes memory;
  Metadata metadata;
  std::vector<StoredTensor> tensors;
  std::vector<std::span<const std::byte>> data;  ///< of each tensor
  std::unordered_map<std::string_view, std::size_t> index;
  /// Copies of tensors that the file stores unaligned (headers of old writers have any length). Words of 8
  /// bytes.
  std::vector<std::vector<std::uint64_t>> copies;

  [[nodiscard]] Error absent(std::string_view tensor) const {
    return {Errc::incompatible, name, "has no tensor '" + std::string(tensor) + "'",
            "It holds " + std::to_string(tensors.size()) + " tensors, of another model perhaps"};
  }
  Result<std::size_t> position(std::string_view tensor) const {
    const auto found = index.find(tensor);
    if (found == index.end()) return absent(tensor);
    return found->second;
  }
  Result<std::size_t> floating(std::string_view tensor) const {
    MIEN_TRY(const auto i, position(tensor));
    if (!is_floating(tensors[i].dtype))
      return Error{
          Errc::incompatible, name + ": tensor '" + tensors[i].name + "'",
          "has dtype " + std::string(dtype_name(tensors[i].dtype)) + ", expected F64, F32, F16 or BF16", ""};
    return i;
  }
};

SafetensorsFile::SafetensorsFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
SafetensorsFile::SafetensorsFile(SafetensorsFile&&) noexcept = default;
SafetensorsFile& SafetensorsFile::operator=(SafetensorsFile&&) noexcept = default;
SafetensorsFile::~SafetensorsFile() = default;

Result<SafetensorsFile> SafetensorsFile::open(const std::filesystem::path& path) {
  auto state = std::make_unique<State>();
  state->name = "'" + path.string() + "'";
  MIEN_TRY(state->file, MappedFile::open(path));
  return check(std::move(state));
}

Result<SafetensorsFile> SafetensorsFile::parse(Bytes bytes, std::string_view name) {
  auto state = std::make_unique<State>();
  state->name = name;
  state->memory = std::move(bytes);
  return check(std::move(state));
}

Result<SafetensorsFile> SafetensorsFile::check(std::unique_ptr<State> state) {
  const std::span<const std::byte> bytes = state->memory.empty() ? state->file.bytes() : state->memory;
  const auto reject = [&](std::string why) {
    return Error{Errc::input, state->name, "is not a safetensors file: " + std::move(why), ""};
  };
  const auto header_size = read_le<std::uint64_t>(bytes, 0);
  if (!header_size)
    return reject("it has " + std::to_string(bytes.size()) + " bytes, fewer than the 8 of a header");
  if (*header_size > kMaxHeaderSize)
    return reject("the header length of " + std::to_string(*header_size) +
                  " bytes is over the limit of 100 MB");
  if (*header_size > bytes.size() - 8)
    return reject("the header length of " + std::to_string(*header_size) + " bytes is beyond the file of " +
                  std::to_string(bytes.size()) + " bytes; it may be truncated");
  const auto size = static_cast<std::size_t>(*header_size);
  const auto data = bytes.subspan(8 + size);
  auto parsed = parse_safetensors_header(as_text(bytes.subspan(8, size)), data.size());
  if (!parsed) return within(parsed.error(), state->name);
  state->metadata = std::move(parsed->metadata);
  for (auto& entry : parsed->entries) {
    auto stored = data.subspan(entry.begin, entry.end - entry.begin);
    const std::size_t alignment = dtype_size(entry.tensor.dtype);
    if (stored.empty()) {
      stored = {};
    } else if (reinterpret_cast<std::uintptr_t>(stored.data()) % alignment != 0) {
      auto& copy = state->copies.emplace_back((stored.size() + 7) / 8);
      std::memcpy(copy.data(), stored.data(), stored.size());
      stored = {reinterpret_cast<const std::byte*>(copy.data()), stored.size()};
    }
    state->tensors.push_back(std::move(entry.tensor));
    state->data.push_back(stored);
  }
  for (std::size_t i = 0; i < state->tensors.size(); ++i) state->index[state->tensors[i].name] = i;
  return SafetensorsFile(std::move(state));
}

const Metadata& SafetensorsFile::metadata() const { return state_->metadata; }
const std::vector<StoredTensor>& SafetensorsFile::tensors() const { return state_->tensors; }

const StoredTensor* SafetensorsFile::find(std::string_view name) const {
  const auto found = state_->index.find(name);
  return found == state_->index.end() ? nullptr : &state_->tensors[found->second];
}

Result<const StoredTensor*> SafetensorsFile::expect(std::string_view name,
                                                    std::span<const std::int64_t> shape) const {
  const StoredTensor* tensor = find(name);
  if (tensor == nullptr) return state_->absent(name);
  bool matches = tensor->shape.size() == shape.size();
  for (std::size_t i = 0; matches && i < shape.size(); ++i)
    matches = shape[i] < 0 || shape[i] == tensor->shape[i];
  if (!matches)
    return Error{Errc::incompatible, state_->name + ": tensor '" + tensor->name + "'",
                 "has shape " + shape_text(tensor->shape) + ", expected " + shape_text(shape), ""};
  return tensor;
}

Result<std::span<const std::byte>> SafetensorsFile::raw(std::string_view name) const {
  MIEN_TRY(const auto i, state_->position(name));
  return state_->data[i];
}

Result<std::span<const std::byte>> SafetensorsFile::typed(std::string_view name, bool (*holds)(Dtype),
                                                          std::size_t size) const {
  MIEN_TRY(const auto i, state_->position(name));
  const auto dtype = state_->tensors[i].dtype;
  if (!holds(dtype))
    return Error{Errc::incompatible, state_->name + ": tensor '" + state_->tensors[i].name + "'",
                 "has dtype " + std::string(dtype_name(dtype)) + ", which is not the type of " +
                     std::to_string(size * 8) + " bits asked for",
                 ""};
  return state_->data[i];
}

Result<std::vector<float>> SafetensorsFile::read_float(std::string_view name) const {
  MIEN_TRY(const auto i, state_->floating(name));
  const auto& tensor = state_->tensors[i];
  std::vector<float> values(static_cast<std::size_t>(tensor.count()));
  for_each_float(tensor.dtype, state_->data[i], [&](std::size_t k, float value) { values[k] = value; });
  return values;
}

Result<std::optional<std::int64_t>> SafetensorsFile::first_non_finite(std::string_view name) const {
  MIEN_TRY(const auto i, state_->floating(name));
  std::optional<std::int64_t> first;
  for_each_float(state_->tensors[i].dtype, state_->data[i], [&](std::size_t k, float value) {
    if (!first && !std::isfinite(value)) first = static_cast<std::int64_t>(k);
  });
  return first;
}

}  // namespace mien

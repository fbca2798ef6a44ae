#include "mien/io/torch_checkpoint.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "float_elements.h"
#include "mien/io/mapped_file.h"
#include "torch_container.h"

namespace mien {
namespace {

constexpr std::array<std::string_view, 5> kStateDicts = {"state_dict", "model_state_dict", "model", "module",
                                                         "net"};

bool holds_tensors(const PickleValue& dict) {
  if (dict.kind() != PickleKind::dict) return false;
  for (std::size_t i = 0; i < dict.size(); ++i)
    if (dict[i].tensor() != nullptr) return true;
  return false;
}

std::string keys_of(const PickleValue& dict) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(dict.size(), 8); ++i)
    if (const auto key = dict.key(i).text())
      text += (text.empty() ? "'" : ", '") + std::string(key->substr(0, 60)) + "'";
  return text.empty() ? "no names" : text + (dict.size() > 8 ? " ..." : "");
}

Result<PickleValue> find_state_dict(const PickleValue& root, const std::string& name) {
  if (holds_tensors(root)) return root;
  for (const auto key : kStateDicts)
    if (const auto member = root.find(key); member && holds_tensors(*member)) return *member;
  if (const auto class_name = root.class_name(); !class_name.empty())
    return Error{Errc::incompatible, name,
                 "holds an object of class '" + std::string(class_name) + "', not a state dict",
                 "Nothing of it was run. Save the module's state_dict() with torch.save instead"};
  if (root.kind() == PickleKind::dict)
    return Error{Errc::incompatible, name, "holds no state dict with tensors; it holds " + keys_of(root), ""};
  return Error{Errc::incompatible, name, "holds no dictionary of tensors", ""};
}

// Elements that the tensor spans in its storage, from its first to behind its last; nothing when it does not
// fit.
std::optional<std::int64_t> span_of(const PickleTensor& tensor) {
  std::int64_t last = 0;
  if (__builtin_add_overflow(tensor.offset, tensor.storage.view_offset, &last)) return std::nullopt;
  for (std::size_t d = 0; d < tensor.shape.size(); ++d) {
    std::int64_t reach = 0;
    if (tensor.shape[d] == 0) return 0;
    if (__builtin_mul_overflow(tensor.shape[d] - 1, tensor.strides[d], &reach) ||
        __builtin_add_overflow(last, reach, &last))
      return std::nullopt;
  }
  if (last == INT64_MAX) return std::nullopt;
  return last + 1;
}

bool is_contiguous(const PickleTensor& tensor) {
  std::int64_t stride = 1;
  for (std::size_t d = tensor.shape.size(); d-- > 0; stride *= tensor.shape[d])
    if (tensor.shape[d] != 1 && tensor.strides[d] != stride) return false;
  return true;
}

// The elements of a tensor where they lie in its storage one behind the other; else gathered into `copy`.
std::span<const std::byte> elements_of(const PickleTensor& tensor, std::span<const std::byte> storage,
                                       std::size_t count, Bytes& copy) {
  if (count == 0) return {};
  const std::size_t size = dtype_size(tensor.dtype);
  const auto start = static_cast<std::size_t>(tensor.offset + tensor.storage.view_offset);
  if (is_contiguous(tensor)) return storage.subspan(start * size, count * size);
  const std::byte* first = storage.data() + start * size;
  copy.resize(count * size);
  std::vector<std::int64_t> index(tensor.shape.size(), 0);
  std::int64_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(copy.data() + i * size, first + static_cast<std::size_t>(at) * size, size);
    for (std::size_t d = index.size(); d-- > 0;) {
      at += tensor.strides[d];
      if (++index[d] < tensor.shape[d]) break;
      at -= tensor.strides[d] * tensor.shape[d];
      index[d] = 0;
    }
  }
  return copy;
}

}  // namespace

struct TorchCheckpoint::State {
  std::string name;
  MappedFile file;
  Bytes memory;
  Bytes unpacked_pickle;
  TorchContainer container;
  std::vector<StoredTensor> tensors;
  std::vector<const PickleTensor*> views;
  std::unordered_map<std::string, std::size_t> index;
  // The storage that was read last: tensors that share one follow each other.
  mutable std::string last_key;
  mutable std::span<const std::byte> last;
  mutable Bytes unpacked;

  Result<std::span<const std::byte>> storage(const std::string& key) const {
    if (!container.zip) return container.storages.at(key);
    if (key == last_key) return last;
    last_key.clear();
    MIEN_TRY(last, container.zip->read(*container.entries.at(key), unpacked));
    last_key = key;
    return last;
  }
};

TorchCheckpoint::TorchCheckpoint(std::unique_ptr<State> state) : state_(std::move(state)) {}
TorchCheckpoint::TorchCheckpoint(TorchCheckpoint&&) noexcept = default;
TorchCheckpoint& TorchCheckpoint::operator=(TorchCheckpoint&&) noexcept = default;
TorchCheckpoint::~TorchCheckpoint() = default;

Result<TorchCheckpoint> TorchCheckpoint::open(const std::filesystem::path& path) {
  auto state = std::make_unique<State>();
  state->name = "'" + path.string() + "'";
  MIEN_TRY(state->file, MappedFile::open(path));
  return check(std::move(state));
}

Result<TorchCheckpoint> TorchCheckpoint::parse(Bytes bytes, std::string_view name) {
  auto state = std::make_unique<State>();
  state->name = name;
  state->memory = std::move(bytes);
  return check(std::move(state));
}

Result<TorchCheckpoint> TorchCheckpoint::check(std::unique_ptr<State> state) {
  const std::span<const std::byte> bytes = state->memory.empty() ? state->file.bytes() : state->memory;
  if (ZipFile::looks_like(bytes)) {
    MIEN_TRY(state->container, open_torch_zip(bytes, state->name, state->unpacked_pickle));
  } else {
    MIEN_TRY(state->container, open_torch_legacy(bytes, state->name));
  }
  MIEN_TRY(const auto dict, find_state_dict(state->container.pickle->root(), state->name));
  // Tensors may share memory, but a file of a few bytes must not describe terabytes.
  std::size_t budget = 64 * bytes.size() + (1u << 20);
  for (std::size_t i = 0; i < dict.size(); ++i) {
    const auto key = dict.key(i).text();
    const auto value = dict[i];
    if (const auto foreign = value.class_name(); !foreign.empty())
      return Error{Errc::incompatible, state->name,
                   "has a state dict with " + (key ? "'" + std::string(*key) + "'" : std::string("a value")) +
                       " of '" + std::string(foreign) +
                       "', which is program code or a class that Mien does not know",
                   "Nothing of it was run. Save a state dict of tensors only"};
    const PickleTensor* tensor = value.tensor();
    if (!key || key->empty() || tensor == nullptr) continue;
    const std::string what = state->name + ": tensor '" + std::string(*key) + "'";
    StoredTensor stored{std::string(*key), tensor->dtype, tensor->shape};
    std::optional<std::size_t> size = dtype_size(tensor->dtype);
    const bool is_empty = std::ranges::find(tensor->shape, 0) != tensor->shape.end();
    for (const auto n : tensor->shape)
      size = size ? checked_multiply(*size, static_cast<std::size_t>(n)) : size;
    if (is_empty) size = 0;
    const auto reach = span_of(*tensor);
    const std::int64_t room = tensor->storage.count;
    if (!size || !reach || *reach > room)
      return Error{Errc::input, what, "reaches outside its storage of " + std::to_string(room) + " elements",
                   ""};
    if (*size > budget)
      return Error{Errc::input, what, "is one of views that describe more than 64 times the file's size", ""};
    budget -= *size;
    if (const auto [place, is_new] = state->index.try_emplace(stored.name, state->tensors.size()); !is_new) {
      state->tensors[place->second] = std::move(stored);
      state->views[place->second] = tensor;
    } else {
      state->tensors.push_back(std::move(stored));
      state->views.push_back(tensor);
    }
  }
  return TorchCheckpoint(std::move(state));
}

const std::vector<StoredTensor>& TorchCheckpoint::tensors() const { return state_->tensors; }
PickleValue TorchCheckpoint::root() const { return state_->container.pickle->root(); }

const StoredTensor* TorchCheckpoint::find(std::string_view name) const {
  const auto found = state_->index.find(std::string(name));
  return found == state_->index.end() ? nullptr : &state_->tensors[found->second];
}

Result<std::span<const std::byte>> TorchCheckpoint::elements(std::string_view name, Bytes& copy) const {
  const auto found = state_->index.find(std::string(name));
  if (found == state_->index.end())
    return Error{Errc::incompatible, state_->name, "has no tensor '" + std::string(name) + "'", ""};
  const PickleTensor& tensor = *state_->views[found->second];
  MIEN_TRY(const auto storage, state_->storage(std::string(tensor.storage.key)));
  return elements_of(tensor, storage, static_cast<std::size_t>(state_->tensors[found->second].count()), copy);
}

Result<Bytes> TorchCheckpoint::read(std::string_view name) const {
  Bytes copy;
  MIEN_TRY(const auto stored, elements(name, copy));
  return copy.empty() ? Bytes(stored.begin(), stored.end()) : std::move(copy);
}

Result<std::vector<float>> TorchCheckpoint::read_float(std::string_view name) const {
  const StoredTensor* tensor = find(name);
  if (tensor != nullptr && !is_floating(tensor->dtype))
    return Error{Errc::incompatible, state_->name + ": tensor '" + tensor->name + "'",
                 "has dtype " + std::string(dtype_name(tensor->dtype)) + ", expected F64, F32, F16 or BF16",
                 ""};
  Bytes copy;
  MIEN_TRY(const auto stored, elements(name, copy));
  std::vector<float> values(static_cast<std::size_t>(tensor->count()));
  for_each_float(tensor->dtype, stored, [&](std::size_t i, float value) { values[i] = value; });
  return values;
}

}  // namespace mien

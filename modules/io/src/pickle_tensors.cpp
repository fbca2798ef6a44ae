// PyTorch's part of PickleCalls: storages and tensors, as torch.save writes them.
#include <array>

#include "pickle_calls.h"

namespace mien {
namespace {

struct TorchType {
  std::string_view storage, tensor;
  Dtype dtype;
};
constexpr std::array kTypes = std::to_array<TorchType>({
    {"torch.DoubleStorage", "torch.float64", Dtype::f64},
    {"torch.FloatStorage", "torch.float32", Dtype::f32},
    {"torch.HalfStorage", "torch.float16", Dtype::f16},
    {"torch.BFloat16Storage", "torch.bfloat16", Dtype::bf16},
    {"torch.LongStorage", "torch.int64", Dtype::i64},
    {"torch.IntStorage", "torch.int32", Dtype::i32},
    {"torch.ShortStorage", "torch.int16", Dtype::i16},
    {"torch.CharStorage", "torch.int8", Dtype::i8},
    {"torch.ByteStorage", "torch.uint8", Dtype::u8},
    {"torch.BoolStorage", "torch.bool", Dtype::boolean},
});

std::string_view without_device(std::string_view name, std::string& buffer) {
  if (!name.starts_with("torch.cuda.")) return name;
  return buffer = "torch." + std::string(name.substr(11));
}

}  // namespace

// ('storage', class, key, device, count[, view]); view = (key, offset, count) in files before PyTorch 0.4
PickleRef PickleCalls::persistent(PickleRef id) {
  const auto& parts = items(id);
  if (node(id).kind != PickleKind::tuple || parts.size() < 5 || text(parts[0]) != "storage")
    return fail("refers to something outside the file that is no tensor storage");
  PickleStorage storage;
  const auto key = text(parts[2]);
  const auto count = integer(parts[4]);
  if (node(parts[1]).kind != PickleKind::global || !key || !count || *count < 0)
    return fail("describes a tensor storage without class, key or size");
  storage.key = *key;
  storage.count = *count;
  std::string buffer;
  const auto name = without_device(node(parts[1]).text, buffer);
  for (const auto& type : kTypes)
    if (type.storage == name) storage.dtype = type.dtype;
  if (!storage.dtype && !name.ends_with("UntypedStorage"))
    return fail("has a tensor storage of class '" + std::string(name) + "', which Mien does not read",
                Errc::incompatible);
  if (parts.size() > 5 && node(parts[5]).kind != PickleKind::none) {
    const auto& view = items(parts[5]);
    const auto offset = view.size() == 3 ? integer(view[1]) : std::nullopt;
    if (!offset || *offset < 0) return fail("describes a damaged view of a tensor storage");
    storage.view_offset = *offset;
  }
  const auto [place, is_new] = heap_.storage_index.try_emplace(*key, heap_.storages.size());
  if (is_new)
    heap_.storages.push_back(storage);
  else if (heap_.storages[place->second].dtype != storage.dtype ||
           heap_.storages[place->second].count != storage.count)
    return fail("describes the tensor storage '" + std::string(*key) + "' in two ways");
  const PickleRef ref =
      add({.kind = PickleKind::storage, .record = static_cast<std::uint32_t>(heap_.node_storages.size())});
  if (ref != kNoRef) heap_.node_storages.push_back(storage);
  return ref;
}

// (storage, offset, size, stride[, requires_grad, hooks[, dtype or metadata ...]])
PickleRef PickleCalls::torch_tensor(PickleRef args, bool has_dtype) {
  const auto& parts = items(args);
  if (parts.size() < (has_dtype ? 7u : 4u) || node(parts[0]).kind != PickleKind::storage)
    return fail("has a tensor without a storage");
  PickleTensor tensor;
  tensor.storage = heap_.node_storages[node(parts[0]).record];
  const auto offset = integer(parts[1]);
  auto shape = sizes(parts[2]), strides = sizes(parts[3]);
  if (!offset || *offset < 0 || !shape || !strides || shape->size() != strides->size())
    return fail("has a tensor with a damaged shape");
  if (has_dtype) {
    const bool counts_bytes = !tensor.storage.dtype;
    tensor.storage.dtype.reset();
    for (const auto& type : kTypes)
      if (node(parts[6]).kind == PickleKind::global && type.tensor == node(parts[6]).text)
        tensor.storage.dtype = type.dtype;
    if (!tensor.storage.dtype)
      return fail("has a tensor of an element type that Mien does not read", Errc::incompatible);
    if (counts_bytes) tensor.storage.count /= static_cast<std::int64_t>(dtype_size(*tensor.storage.dtype));
  }
  if (!tensor.storage.dtype) return fail("has a tensor without an element type");
  tensor.dtype = *tensor.storage.dtype;
  tensor.offset = *offset;
  tensor.shape = std::move(*shape);
  tensor.strides = std::move(*strides);
  const PickleRef ref =
      add({.kind = PickleKind::tensor, .record = static_cast<std::uint32_t>(heap_.tensors.size())});
  if (ref != kNoRef) heap_.tensors.push_back(std::move(tensor));
  return ref;
}

}  // namespace mien

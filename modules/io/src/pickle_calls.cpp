#include "pickle_calls.h"

#include <algorithm>
#include <array>

namespace mien {
namespace {

// Far above real files (a checkpoint of 1000 tensors has some 20 000 values), far below what hurts.
constexpr std::size_t kMaxValues = 2'000'000;
constexpr std::size_t kMaxReferences = 16'000'000;
constexpr std::size_t kMaxNameLength = 256;

enum class Known : std::uint32_t {
  foreign,
  type_name,  // a class that may be mentioned but not called
  dict_type,
  list_type,
  tuple_type,
  set_type,
  bytes_type,
  encode,
  reconstruct_object,
  numpy_array_type,
  numpy_dtype,
  numpy_reconstruct,
  numpy_scalar,
  numpy_from_buffer,
  torch_tensor,
  torch_tensor_with_dtype,
  torch_parameter,
};

struct KnownName {
  std::string_view name;
  Known meaning;
};

constexpr std::array kKnown = std::to_array<KnownName>({
    {"collections.OrderedDict", Known::dict_type},
    {"collections.defaultdict", Known::dict_type},
    {"builtins.dict", Known::dict_type},
    {"builtins.list", Known::list_type},
    {"builtins.tuple", Known::tuple_type},
    {"builtins.set", Known::set_type},
    {"builtins.frozenset", Known::set_type},
    {"builtins.bytes", Known::bytes_type},
    {"builtins.bytearray", Known::bytes_type},
    {"builtins.object", Known::type_name},
    {"builtins.int", Known::type_name},
    {"builtins.long", Known::type_name},
    {"builtins.float", Known::type_name},
    {"builtins.bool", Known::type_name},
    {"builtins.str", Known::type_name},
    {"builtins.unicode", Known::type_name},
    {"_codecs.encode", Known::encode},
    {"copyreg._reconstructor", Known::reconstruct_object},
    {"numpy.ndarray", Known::numpy_array_type},
    {"numpy.dtype", Known::numpy_dtype},
    {"numpy.core.multiarray._reconstruct", Known::numpy_reconstruct},
    {"numpy.core.multiarray.scalar", Known::numpy_scalar},
    {"numpy.core.numeric._frombuffer", Known::numpy_from_buffer},
    {"torch.Size", Known::tuple_type},
    {"torch._utils._rebuild_tensor", Known::torch_tensor},
    {"torch._utils._rebuild_tensor_v2", Known::torch_tensor},
    {"torch._utils._rebuild_tensor_v3", Known::torch_tensor_with_dtype},
    {"torch._utils._rebuild_parameter", Known::torch_parameter},
});

// The names that Python 2 and NumPy 2 use for the same things.
std::string current_name(std::string_view module, std::string_view name) {
  if (module == "__builtin__") module = "builtins";
  if (module == "copy_reg") module = "copyreg";
  std::string full(module);
  if (full.starts_with("numpy._core.")) full.replace(0, 12, "numpy.core.");
  return full + "." + std::string(name);
}

Known meaning_of(std::string_view name) {
  const auto found =
      std::find_if(kKnown.begin(), kKnown.end(), [&](const auto& k) { return k.name == name; });
  if (found != kKnown.end()) return found->meaning;
  if (name.starts_with("torch.") && (name.ends_with("Storage") || name.find('.', 6) == name.npos))
    return Known::type_name;  // element types of storages and tensors: torch.FloatStorage, torch.float32
  return Known::foreign;
}

}  // namespace

PickleRef PickleCalls::add(PickleNode value) {
  if (heap_.nodes.size() >= kMaxValues)
    return fail("holds more than " + std::to_string(kMaxValues) + " values");
  heap_.nodes.push_back(std::move(value));
  return static_cast<PickleRef>(heap_.nodes.size() - 1);
}

bool PickleCalls::spend(std::size_t count) {
  references_ += count;
  if (references_ <= kMaxReferences) return true;
  return fail("holds more than " + std::to_string(kMaxReferences) + " items in lists and dictionaries"),
         false;
}

std::optional<std::int64_t> PickleCalls::integer(PickleRef ref) {
  if (node(ref).kind != PickleKind::integer && node(ref).kind != PickleKind::boolean) return std::nullopt;
  return node(ref).integer;
}

std::optional<std::string_view> PickleCalls::text(PickleRef ref) {
  if (node(ref).kind != PickleKind::text) return std::nullopt;
  return node(ref).text;
}

std::optional<std::vector<std::int64_t>> PickleCalls::sizes(PickleRef ref) {
  if (node(ref).kind != PickleKind::tuple && node(ref).kind != PickleKind::list) return std::nullopt;
  if (items(ref).size() > 32) return std::nullopt;  // NumPy's limit is 32, PyTorch's 64: files have up to 5
  std::vector<std::int64_t> numbers;
  for (const PickleRef item : items(ref)) {
    const auto number = integer(item);
    if (!number || *number < 0) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

PickleRef PickleCalls::global(std::string_view module, std::string_view name) {
  if (module.size() + name.size() > kMaxNameLength) return fail("names a class of more than 256 letters");
  const std::string full = current_name(module, name);
  if (const auto found = globals_.find(full); found != globals_.end()) return found->second;
  const Known meaning = meaning_of(full);
  if (meaning == Known::foreign && !keep_foreign_) {
    error = Error{Errc::incompatible, "",
                  "asks for '" + full + "', which is program code or a class that Mien does not know",
                  "Nothing of it was run. Save plain arrays, tensors, lists and dictionaries instead"};
    return kNoRef;
  }
  PickleNode made{.kind = PickleKind::global, .record = static_cast<std::uint32_t>(meaning)};
  const auto bytes = as_bytes(full);
  made.text = heap_.keep(Bytes(bytes.begin(), bytes.end()));
  const PickleRef ref = add(std::move(made));
  if (ref != kNoRef) globals_.emplace(full, ref);
  return ref;
}

PickleRef PickleCalls::foreign(std::string_view name, PickleRef args) {
  return add({.kind = PickleKind::object, .record = args, .text = name});
}

PickleRef PickleCalls::collect(PickleKind kind, PickleRef args) {
  PickleNode made{.kind = kind};
  if (items(args).size() > 1) return fail("makes a collection of more than one argument");
  if (!items(args).empty()) {
    const PickleNode& source = node(items(args)[0]);
    if (source.kind != PickleKind::list && source.kind != PickleKind::tuple && source.kind != PickleKind::set)
      return fail("makes a collection of something that is none");
    if (!spend(source.items.size())) return kNoRef;
    made.items = source.items;
  }
  return add(std::move(made));
}

// Python 2 writes the pairs as the argument; Python 3, and a defaultdict, set the items afterwards.
PickleRef PickleCalls::ordered_dict(PickleRef args) {
  PickleNode made{.kind = PickleKind::dict};
  if (!items(args).empty() && node(items(args)[0]).kind == PickleKind::list) {
    const auto& pairs = items(items(args)[0]);
    if (!spend(2 * pairs.size())) return kNoRef;
    for (const PickleRef pair : pairs) {
      const auto kind = node(pair).kind;
      if ((kind != PickleKind::list && kind != PickleKind::tuple) || items(pair).size() != 2)
        return fail("makes a dictionary of something other than pairs");
      made.items.insert(made.items.end(), items(pair).begin(), items(pair).end());
    }
  }
  return add(std::move(made));
}

// Bytes in protocols 0 to 2 of Python 3: text whose code points are the bytes, to be encoded as Latin-1.
PickleRef PickleCalls::encode(PickleRef args) {
  const auto& arguments = items(args);
  const auto source = arguments.empty() ? std::nullopt : text(arguments[0]);
  const auto encoding = arguments.size() < 2 ? std::nullopt : text(arguments[1]);
  if (!source || !encoding || (*encoding != "latin1" && *encoding != "latin-1"))
    return fail("encodes something other than Latin-1 text");
  const auto [place, is_new] = heap_.latin1.try_emplace(source->data());
  if (is_new) {
    Bytes bytes;
    bytes.reserve(source->size());
    for (std::size_t i = 0; i < source->size(); ++i) {
      const auto c = static_cast<unsigned char>((*source)[i]);
      if (c < 0x80) {
        bytes.push_back(static_cast<std::byte>(c));
        continue;
      }
      const auto next = i + 1 < source->size() ? static_cast<unsigned char>((*source)[i + 1]) : 0u;
      if ((c != 0xc2 && c != 0xc3) || (next & 0xc0u) != 0x80) return fail("has text that is not Latin-1");
      bytes.push_back(static_cast<std::byte>(((c & 3u) << 6) | (next & 0x3fu)));
      ++i;
    }
    place->second = heap_.keep(std::move(bytes));
  }
  return add({.kind = PickleKind::bytes, .text = place->second});
}

PickleRef PickleCalls::byte_array(PickleRef args) {
  if (items(args).empty()) return add({.kind = PickleKind::bytes});
  const PickleNode& source = node(items(args)[0]);
  if (source.kind == PickleKind::text) return encode(args);
  if (source.kind != PickleKind::bytes) return fail("makes bytes of something else");
  return add({.kind = PickleKind::bytes, .text = source.text});
}

PickleRef PickleCalls::call(PickleRef callee, PickleRef args) {
  if (node(args).kind != PickleKind::tuple) return fail("calls something without a tuple of arguments");
  if (node(callee).kind == PickleKind::object) return foreign(node(callee).text, args);
  if (node(callee).kind != PickleKind::global) return fail("calls something that is no function");
  switch (static_cast<Known>(node(callee).record)) {
    case Known::dict_type:
      return ordered_dict(args);
    case Known::list_type:
      return collect(PickleKind::list, args);
    case Known::tuple_type:
      return collect(PickleKind::tuple, args);
    case Known::set_type:
      return collect(PickleKind::set, args);
    case Known::bytes_type:
      return byte_array(args);
    case Known::encode:
      return encode(args);
    case Known::reconstruct_object:  // (class, base, state of the base)
      if (items(args).empty()) return fail("restores an object without a class");
      if (node(items(args)[0]).kind != PickleKind::global) return fail("restores an object of no class");
      return foreign(node(items(args)[0]).text, args);
    case Known::numpy_dtype:
      return numpy_dtype(args);
    case Known::numpy_reconstruct:
    case Known::numpy_array_type:
      return add_array({});
    case Known::numpy_scalar:
      return numpy_scalar(args);
    case Known::numpy_from_buffer:
      return numpy_from_buffer(args);
    case Known::torch_tensor:
      return torch_tensor(args, false);
    case Known::torch_tensor_with_dtype:
      return torch_tensor(args, true);
    case Known::torch_parameter:
      if (items(args).empty() || node(items(args)[0]).kind != PickleKind::tensor)
        return fail("has a parameter without a tensor");
      return items(args)[0];
    case Known::foreign:
    case Known::type_name:
      break;
  }
  if (keep_foreign_) return foreign(node(callee).text, args);
  return fail("makes an object of '" + std::string(node(callee).text) + "', which Mien does not read",
              Errc::incompatible);
}

bool PickleCalls::build(PickleRef object, PickleRef state) {
  if (object == state) return fail("restores a value from itself"), false;
  switch (node(object).kind) {
    case PickleKind::dtype:
      return build_dtype(object, state);
    case PickleKind::array:
      return build_array(object, state);
    case PickleKind::object:
      node(object).state = state;
      return true;
    case PickleKind::dict:  // the "_metadata" of a state_dict, and the like
    case PickleKind::list:
    case PickleKind::set:
    case PickleKind::tensor:
      return true;
    default:
      return fail("restores a value that has no state"), false;
  }
}

}  // namespace mien

#include "torch_container.h"

#include <algorithm>
#include <array>

namespace mien {
namespace {

constexpr PickleOptions kKeepForeign{.keep_foreign = true};

std::optional<std::size_t> storage_bytes(const PickleStorage& storage) {
  return checked_multiply(static_cast<std::size_t>(storage.count),
                          storage.dtype ? dtype_size(*storage.dtype) : 1);
}

// The file that people download instead of a large one when something went wrong.
Error no_checkpoint(std::span<const std::byte> bytes, const std::string& name) {
  const auto start = as_text(bytes.first(std::min<std::size_t>(bytes.size(), 512)));
  if (bytes.empty()) return {Errc::input, name, "is empty", "Copy or download the file again"};
  if (start.starts_with("version https://git-lfs"))
    return {Errc::input, name, "is a Git LFS pointer, not the weights themselves",
            "Fetch the file with `git lfs pull`"};
  if (const auto letter = start.find_first_not_of(" \t\r\n"); letter != start.npos && start[letter] == '<')
    return {Errc::input, name, "is a web page, not a checkpoint", "Download the file itself"};
  return {Errc::input, name, "is no checkpoint that torch.save wrote; it may be truncated", ""};
}

// 119547037146038801333356, the number that begins the older form
constexpr std::array<unsigned char, 10> kLegacyMagic = {0x6c, 0xfc, 0x9c, 0x46, 0xf9,
                                                        0x20, 0x6a, 0xa8, 0x50, 0x19};

bool is_magic(const PickleValue& value) {
  const auto bytes = value.bytes();
  return value.kind() == PickleKind::big_integer && bytes && bytes->size() == kLegacyMagic.size() &&
         std::ranges::equal(*bytes, kLegacyMagic, {},
                            [](std::byte b) { return static_cast<unsigned char>(b); });
}

}  // namespace

Result<TorchContainer> open_torch_zip(std::span<const std::byte> bytes, const std::string& name,
                                      Bytes& unpacked) {
  TorchContainer container;
  MIEN_TRY(container.zip, ZipFile::parse(bytes, name));
  const ZipFile& zip = *container.zip;
  const auto find_suffix = [&](std::string_view suffix) -> const ZipEntry* {
    for (const auto& entry : zip.entries())
      if (entry.name.ends_with(suffix)) return &entry;
    return nullptr;
  };
  const ZipEntry* pickle = find_suffix("/data.pkl");
  if (pickle == nullptr)
    return Error{Errc::incompatible, name, "is a zip archive without data.pkl, so not a PyTorch checkpoint",
                 ""};
  const std::string root = pickle->name.substr(0, pickle->name.size() - 8);  // with the slash
  if (const ZipEntry* order = zip.find(root + "byteorder")) {
    Bytes copy;
    MIEN_TRY(const auto text, zip.read(*order, copy));
    if (as_text(text) != "little")
      return Error{Errc::incompatible, name, "was written by a big-endian computer", ""};
  }
  if (zip.find(root + "constants.pkl") != nullptr)
    return Error{Errc::incompatible, name, "is a TorchScript program, not a state dict",
                 "Save the module's state_dict() instead"};
  MIEN_TRY(const auto text, zip.read(*pickle, unpacked));
  MIEN_TRY(container.pickle, Pickle::parse(text, name, kKeepForeign));
  for (const auto& storage : container.pickle->storages()) {
    const std::string key(storage.key);
    const ZipEntry* entry = zip.find(root + "data/" + key);
    const auto size = storage_bytes(storage);
    if (entry == nullptr || !size || entry->size < *size)
      return Error{Errc::input, name + ": storage '" + key + "'",
                   entry == nullptr ? "is missing"
                                    : "has " + std::to_string(entry->size) + " bytes, fewer than its " +
                                          std::to_string(storage.count) + " elements need",
                   "Copy or download the file again"};
    container.entries.emplace(key, entry);
  }
  return container;
}

// Pickles: magic number, protocol, description of the computer, the object, keys of the storages; then for
// each key 8 bytes of element count and the elements.
Result<TorchContainer> open_torch_legacy(std::span<const std::byte> bytes, const std::string& name) {
  std::size_t at = 0;
  const auto next = [&](const PickleOptions& options) {
    auto pickle = Pickle::parse(bytes.subspan(at), name, options);
    if (pickle) at += pickle->size();
    return pickle;
  };
  const auto magic = next({});
  if (!magic && magic.error().code == Errc::incompatible) return magic.error();
  if (!magic || !is_magic(magic->root())) return no_checkpoint(bytes, name);
  MIEN_TRY(const auto protocol, next({}));
  if (protocol.root().integer() != 1001)
    return Error{Errc::incompatible, name, "has an unknown version of PyTorch's old file format", ""};
  MIEN_TRY(const auto computer, next({}));
  if (const auto little = computer.root().find("little_endian"); !little || little->boolean() != true)
    return Error{Errc::incompatible, name, "was written by a big-endian computer", ""};
  TorchContainer container;
  MIEN_TRY(container.pickle, next(kKeepForeign));
  MIEN_TRY(const auto keys, next({}));
  std::unordered_map<std::string_view, const PickleStorage*> described;
  for (const auto& storage : container.pickle->storages()) described[storage.key] = &storage;
  const auto damaged = [&](const std::string& why) {
    return Error{Errc::input, name, why + "; the file may be truncated", "Copy or download the file again"};
  };
  for (std::size_t i = 0; i < keys.root().size(); ++i) {
    const auto key = keys.root()[i].text();
    const auto found = key ? described.find(*key) : described.end();
    const auto count = read_le<std::int64_t>(bytes, at);
    if (found == described.end() || !count) return damaged("its list of storages is damaged");
    const auto size = storage_bytes(*found->second);
    if (*count != found->second->count || !size || *size > bytes.size() - at - 8)
      return damaged("its storage '" + std::string(*key) + "' is cut");
    container.storages.emplace(std::string(*key), bytes.subspan(at + 8, *size));
    at += 8 + *size;
  }
  if (container.storages.size() != described.size()) return damaged("it lacks a storage");
  return container;
}

}  // namespace mien

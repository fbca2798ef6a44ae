#pragma once
#include <optional>
#include <string>
#include <unordered_map>

#include "mien/io/pickle.h"
#include "mien/io/zip_file.h"

namespace mien {

/// The two forms in which torch.save packs a pickle and the storages of its tensors.
struct TorchContainer {
  std::optional<Pickle> pickle;
  std::optional<ZipFile> zip;
  std::unordered_map<std::string, const ZipEntry*> entries;              ///< of storages, in the zip form
  std::unordered_map<std::string, std::span<const std::byte>> storages;  ///< in the older form
};

/// `bytes` must outlive the container. Errors as TorchCheckpoint::open().
Result<TorchContainer> open_torch_zip(std::span<const std::byte> bytes, const std::string& name,
                                      Bytes& unpacked);
Result<TorchContainer> open_torch_legacy(std::span<const std::byte> bytes, const std::string& name);

}  // namespace mien

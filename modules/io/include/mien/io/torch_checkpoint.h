#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/io/pickle.h"
#include "mien/io/safetensors.h"

namespace mien {

/// The named tensors of a file that torch.save wrote (.pth, .pt, .bin, .ckpt): the zip form and the older one
/// of several pickles in a row. The file is mapped, nothing in it is run, and the device that a tensor was on
/// does not matter. One thread at a time: the storage that was read last is kept.
///
/// The state dict is the file's dictionary itself when it holds tensors, else its member "state_dict"
/// (Lightning), "model_state_dict", "model" (fairseq), "module" or "net". Whatever else such a file holds
/// (options, optimisers) may be of foreign classes and is passed over.
class TorchCheckpoint {
 public:
  /// Errors (Errc::input): unreadable, truncated, damaged, or no checkpoint at all (a Git LFS pointer, a web
  /// page); (Errc::incompatible): no state dict, or one with values of foreign classes, by name.
  static Result<TorchCheckpoint> open(const std::filesystem::path& path);
  /// The same from memory; `name` stands for the file in messages.
  static Result<TorchCheckpoint> parse(Bytes bytes, std::string_view name = "checkpoint data");
  TorchCheckpoint(TorchCheckpoint&&) noexcept;
  TorchCheckpoint& operator=(TorchCheckpoint&&) noexcept;
  ~TorchCheckpoint();

  /// In the order of the state dict.
  [[nodiscard]] const std::vector<StoredTensor>& tensors() const;
  /// nullptr when there is no such tensor.
  [[nodiscard]] const StoredTensor* find(std::string_view name) const;
  /// Row-major little-endian elements. Errors (Errc::incompatible): absent; (Errc::input): damaged.
  [[nodiscard]] Result<Bytes> read(std::string_view name) const;
  /// The same as float32, from F64 (rounded), F32, F16 or BF16. Errors as read(), and (Errc::incompatible):
  /// not a floating-point tensor.
  [[nodiscard]] Result<std::vector<float>> read_float(std::string_view name) const;
  /// The whole value tree of the file, for readers of what surrounds the state dict.
  [[nodiscard]] PickleValue root() const;

 private:
  struct State;
  explicit TorchCheckpoint(std::unique_ptr<State> state);
  static Result<TorchCheckpoint> check(std::unique_ptr<State> state);
  Result<std::span<const std::byte>> elements(std::string_view name, Bytes& copy) const;
  std::unique_ptr<State> state_;
};

}  // namespace mien

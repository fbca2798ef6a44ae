#pragma once
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mien/base/progress.h"
#include "prepared_entry.h"

namespace mien {

/// Facts about a prepared set that go into its metadata, key "mien.set".
struct SetDescription {
  std::uint64_t seed = 0;
  double hours = 0;                  ///< of distinct speech, before copies
  std::vector<std::string> engines;  ///< names with versions
};

/// Writes the prepared training set of `mien-train` (docs/corpus.md): entries go to a spool file beside the
/// output as they come, because the tensors can be laid out only when all sizes are known. Memory: one entry.
class SetWriter {
 public:
  /// Error (Errc::failed): the spool file cannot be written.
  static Result<SetWriter> create(const std::filesystem::path& path, int num_takes);
  SetWriter(SetWriter&&) noexcept = default;
  SetWriter& operator=(SetWriter&&) noexcept = default;
  ~SetWriter();

  /// @pre the entry has num_takes takes and its vectors agree in length
  Status add(const PreparedEntry& entry);
  /// Writes the safetensors file and removes the spool. Error (Errc::failed): no entries, or the disk.
  Status finish(const SetDescription& description, Progress& progress);

  [[nodiscard]] std::int64_t num_entries() const { return static_cast<std::int64_t>(sizes_.size()); }

 private:
  struct Size {
    std::int64_t bytes, mel, frames;
  };
  SetWriter(std::filesystem::path path, int num_takes) : path_(std::move(path)), num_takes_(num_takes) {}
  std::filesystem::path path_, spool_path_;
  int num_takes_ = 0;
  std::fstream spool_;
  std::vector<Size> sizes_;
};

}  // namespace mien

#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "input_file.h"

namespace mien {

/// The families of WAV files: 4-letter names and 32-bit sizes (RIFF; RIFX is its big-endian form), the same
/// with a table of 64-bit sizes (RF64, EBU Tech 3306), and Sony's Wave64 with 16-byte names and 64-bit sizes.
enum class RiffKind { none, riff, rifx, rf64, wave64 };

/// The family of a file that begins with `head`; none unless it holds waves.
RiffKind riff_kind(std::span<const std::byte> head);

struct RiffChunk {
  std::array<char, 4> id{};
  std::int64_t start = 0;   // of its content
  std::int64_t size = 0;    // of its content, as declared: may reach beyond the file
  std::int64_t next = 0;    // where the next chunk begins
  bool is_endless = false;  // written by a pipe that did not know the size: up to the end of the file

  [[nodiscard]] bool is(std::string_view name) const { return std::string_view(id.data(), 4) == name; }
};

/// Chunk after chunk of a WAV file.
class RiffChunks {
 public:
  RiffChunks(InputFile& file, RiffKind kind);
  /// The next chunk, or nothing at the end of the file (or of what can be understood).
  std::optional<RiffChunk> next();

 private:
  std::optional<RiffChunk> read_header();

  InputFile& file_;
  RiffKind kind_;
  std::int64_t position_;
  int num_read_ = 0;
  std::optional<std::int64_t> long_data_size_;  // RF64
};

/// Whether the rest of a RIFF file, from `position` on, is a sequence of chunks that ends where the file
/// ends.
bool only_chunks_follow(InputFile& file, RiffKind kind, std::int64_t position);

}  // namespace mien

#include "riff_chunks.h"

#include <algorithm>
#include <cstring>

namespace mien {
namespace {

using namespace std::string_view_literals;

// Writers that cannot seek back put a size near 2 or 4 GiB.
constexpr std::int64_t kEndlessSize = 0x7FFFF000;
// Keeps sums of positions and sizes far from overflow.
constexpr std::int64_t kLargestSize = std::int64_t{1} << 60;
// A file of nothing but empty chunks is given up after so many.
constexpr int kMaxChunks = 100000;
constexpr std::string_view kWave64Riff = "riff\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\x00\x00"sv;

std::int64_t clamp_size(std::uint64_t size) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(size, static_cast<std::uint64_t>(kLargestSize)));
}

}  // namespace

RiffKind riff_kind(std::span<const std::byte> head) {
  const std::string_view text = as_text(head);
  if (text.starts_with(kWave64Riff) && text.size() >= 40 && text.substr(24, 4) == "wave")
    return RiffKind::wave64;
  if (text.size() < 12 || text.substr(8, 4) != "WAVE") return RiffKind::none;
  const auto id = text.substr(0, 4);
  return id == "RIFF"   ? RiffKind::riff
         : id == "RIFX" ? RiffKind::rifx
         : id == "RF64" ? RiffKind::rf64
                        : RiffKind::none;
}

RiffChunks::RiffChunks(InputFile& file, RiffKind kind)
    : file_(file), kind_(kind), position_(kind == RiffKind::wave64 ? 40 : 12) {}

std::optional<RiffChunk> RiffChunks::read_header() {
  const bool is_wave64 = kind_ == RiffKind::wave64;
  std::array<std::byte, 24> buffer;
  const auto bytes = std::span(buffer).first(is_wave64 ? 24 : 8);
  file_.seek(position_);
  if (file_.read(bytes) != bytes.size()) return std::nullopt;
  RiffChunk chunk;
  std::memcpy(chunk.id.data(), bytes.data(), 4);
  chunk.start = position_ + static_cast<std::int64_t>(bytes.size());
  if (is_wave64) {
    const auto with_header = clamp_size(*read_le<std::uint64_t>(bytes, 16));
    if (with_header < 24) return std::nullopt;
    chunk.size = with_header - 24;
    chunk.next = position_ + (with_header + 7) / 8 * 8;
  } else {
    chunk.size = *read_le<std::uint32_t>(bytes, 4);
    chunk.next = chunk.start + chunk.size + chunk.size % 2;
  }
  return chunk;
}

std::optional<RiffChunk> RiffChunks::next() {
  if (num_read_++ >= kMaxChunks) return std::nullopt;
  auto chunk = read_header();
  if (!chunk) return std::nullopt;
  if (kind_ == RiffKind::rf64 && chunk->is("ds64")) {
    std::array<std::byte, 16> sizes;  // of the whole file, of the data chunk
    if (file_.read(sizes) == sizes.size()) long_data_size_ = clamp_size(*read_le<std::uint64_t>(sizes, 8));
  }
  if (chunk->is("data") && chunk->size == 0xFFFFFFFF && long_data_size_) {
    chunk->size = *long_data_size_;
    chunk->next = chunk->start + chunk->size + chunk->size % 2;
  } else if (kind_ != RiffKind::wave64) {
    chunk->is_endless = chunk->size >= kEndlessSize && chunk->start + chunk->size > file_.size();
  }
  position_ = chunk->next;
  return chunk;
}

bool only_chunks_follow(InputFile& file, RiffKind kind, std::int64_t position) {
  if (kind == RiffKind::wave64) return false;
  for (int i = 0; i < kMaxChunks && position < file.size(); ++i) {
    std::array<std::byte, 8> header;
    file.seek(position);
    if (file.read(header) != header.size()) return false;
    const auto id = as_text(header).substr(0, 4);
    if (!std::all_of(id.begin(), id.end(), [](char c) { return c >= ' ' && c <= '~'; })) return false;
    const std::int64_t size = *read_le<std::uint32_t>(header, 4);
    if (position + 8 + size > file.size()) return false;
    position += 8 + size + size % 2;
  }
  return true;
}

}  // namespace mien

#include "mien/io/zip_file.h"

#include <algorithm>
#include <optional>

#include "crc32.h"
#include "inflate.h"

// Layout: PKWARE's APPNOTE 6.3, sections 4.3 and 4.4.
namespace mien {
namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50, kDirectoryEntry = 0x02014b50, kEnd = 0x06054b50;
constexpr std::uint32_t kEnd64 = 0x06064b50, kEnd64Locator = 0x07064b50;
constexpr std::size_t kEndSize = 22, kLocatorSize = 20, kLocalSize = 30, kEntrySize = 46,
                      kMaxComment = 0xffff;
constexpr std::uint64_t kIn64 = 0xffffffff;  // "see the 64-bit field"
constexpr std::uint64_t kMaxRatio = 100, kAlwaysUnpacked = 64u << 20;

struct Directory {
  std::uint64_t offset = 0, size = 0, count = 0;
};

template <class T>
std::uint64_t field(std::span<const std::byte> bytes, std::size_t offset) {
  return read_le<T>(bytes, offset).value_or(0);
}

// The record at the end of the file, behind which only a comment may stand.
std::optional<std::size_t> find_end(std::span<const std::byte> bytes) {
  if (bytes.size() < kEndSize) return std::nullopt;
  const std::size_t first = bytes.size() - kEndSize;
  const std::size_t last = first > kMaxComment ? first - kMaxComment : 0;
  for (std::size_t at = first + 1; at-- > last;)
    if (read_le<std::uint32_t>(bytes, at) == kEnd &&
        field<std::uint16_t>(bytes, at + 20) == bytes.size() - at - kEndSize)
      return at;
  return std::nullopt;
}

Directory read_end(std::span<const std::byte> bytes, std::size_t end) {
  Directory directory{field<std::uint32_t>(bytes, end + 16), field<std::uint32_t>(bytes, end + 12),
                      field<std::uint16_t>(bytes, end + 10)};
  if (end < kLocatorSize || read_le<std::uint32_t>(bytes, end - kLocatorSize) != kEnd64Locator)
    return directory;
  const auto at = field<std::uint64_t>(bytes, end - kLocatorSize + 8);
  if (at < bytes.size() && read_le<std::uint32_t>(bytes, at) == kEnd64)
    directory = {field<std::uint64_t>(bytes, at + 48), field<std::uint64_t>(bytes, at + 40),
                 field<std::uint64_t>(bytes, at + 32)};
  return directory;
}

// Replaces the sizes and the offset that do not fit in 32 bits, in this order, from extra field 1.
void read_extra64(std::span<const std::byte> extra, std::uint64_t& size, std::uint64_t& stored,
                  std::uint64_t& offset) {
  for (std::size_t at = 0; at + 4 <= extra.size();) {
    const auto id = field<std::uint16_t>(extra, at);
    const auto length = field<std::uint16_t>(extra, at + 2);
    std::size_t value = at + 4;
    if (id == 1)
      for (auto* number : {&size, &stored, &offset})
        if (*number == kIn64 && value + 8 <= std::min<std::size_t>(extra.size(), at + 4 + length))
          *number = field<std::uint64_t>(extra, value), value += 8;
    at += 4 + length;
  }
}

}  // namespace

bool ZipFile::looks_like(std::span<const std::byte> bytes) {
  return read_le<std::uint32_t>(bytes, 0) == kLocalHeader;
}

Result<ZipFile> ZipFile::parse(std::span<const std::byte> bytes, std::string_view name) {
  const auto reject = [&](const std::string& why) {
    return Error{Errc::input, std::string(name), "is not a whole zip archive: " + why, ""};
  };
  const auto end = find_end(bytes);
  if (!end) return reject("it has no directory at its end; it may be truncated");
  const Directory directory = read_end(bytes, *end);
  if (directory.offset > *end || directory.size > *end - directory.offset)
    return reject("its directory lies outside the file");
  if (directory.count > directory.size / kEntrySize) return reject("its directory is cut");
  ZipFile zip;
  zip.bytes_ = bytes, zip.name_ = name;
  std::size_t at = static_cast<std::size_t>(directory.offset);
  const std::size_t stop = at + static_cast<std::size_t>(directory.size);
  for (std::uint64_t i = 0; i < directory.count; ++i) {
    if (stop - at < kEntrySize || read_le<std::uint32_t>(bytes, at) != kDirectoryEntry)
      return reject("its directory is damaged");
    const auto flags = field<std::uint16_t>(bytes, at + 8), method = field<std::uint16_t>(bytes, at + 10);
    ZipEntry entry{.crc = static_cast<std::uint32_t>(field<std::uint32_t>(bytes, at + 16)),
                   .deflated = method == 8};
    entry.stored_size = field<std::uint32_t>(bytes, at + 20);
    entry.size = field<std::uint32_t>(bytes, at + 24);
    entry.offset = field<std::uint32_t>(bytes, at + 42);
    const std::size_t name_size = field<std::uint16_t>(bytes, at + 28);
    const std::size_t extra_size = field<std::uint16_t>(bytes, at + 30);
    const std::size_t comment_size = field<std::uint16_t>(bytes, at + 32);
    if (stop - at - kEntrySize < name_size + extra_size + comment_size)
      return reject("its directory is damaged");
    entry.name = as_text(bytes.subspan(at + kEntrySize, name_size));
    read_extra64(bytes.subspan(at + kEntrySize + name_size, extra_size), entry.size, entry.stored_size,
                 entry.offset);
    at += kEntrySize + name_size + extra_size + comment_size;
    const auto bad = [&](const std::string& why) { return reject("its entry '" + entry.name + "' " + why); };
    if ((flags & 1u) != 0) return bad("is encrypted");
    if (method != 0 && method != 8) return bad("is compressed by another method than deflate");
    if (!entry.deflated && entry.size != entry.stored_size) return bad("has two sizes");
    if (entry.deflated && entry.size > kAlwaysUnpacked && entry.size / kMaxRatio > entry.stored_size)
      return bad("would unpack to more than 100 times its size");
    if (entry.offset > directory.offset || directory.offset - entry.offset < kLocalSize ||
        read_le<std::uint32_t>(bytes, static_cast<std::size_t>(entry.offset)) != kLocalHeader)
      return bad("begins outside the file");
    const auto local = static_cast<std::size_t>(entry.offset);
    entry.offset +=
        kLocalSize + field<std::uint16_t>(bytes, local + 26) + field<std::uint16_t>(bytes, local + 28);
    if (entry.offset > directory.offset || entry.stored_size > directory.offset - entry.offset)
      return bad("ends outside the file");
    zip.entries_.push_back(std::move(entry));
  }
  // Entries on top of each other would unpack the same bytes many times.
  std::ranges::sort(zip.entries_, {}, &ZipEntry::offset);
  for (std::size_t i = 1; i < zip.entries_.size(); ++i)
    if (zip.entries_[i - 1].offset + zip.entries_[i - 1].stored_size > zip.entries_[i].offset)
      return reject("its entries overlap");
  std::ranges::sort(zip.entries_, {}, &ZipEntry::name);
  for (std::size_t i = 1; i < zip.entries_.size(); ++i)
    if (zip.entries_[i - 1].name == zip.entries_[i].name)
      return reject("it has two entries '" + zip.entries_[i].name + "'");
  return zip;
}

const ZipEntry* ZipFile::find(std::string_view entry_name) const {
  const auto found = std::ranges::lower_bound(entries_, entry_name, {}, &ZipEntry::name);
  return found != entries_.end() && found->name == entry_name ? &*found : nullptr;
}

Result<std::span<const std::byte>> ZipFile::read(const ZipEntry& entry, Bytes& unpacked) const {
  const std::string what = name_ + ": entry '" + entry.name + "'";
  auto content =
      bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.stored_size));
  if (entry.deflated) {
    auto made = inflate(content, static_cast<std::size_t>(entry.size));
    if (!made) return within(made.error(), what);
    unpacked = std::move(*made);
    content = unpacked;
  }
  if (crc32(content) != entry.crc)
    return Error{Errc::input, what, "is damaged: its checksum differs", "Copy or download the file again"};
  return content;
}

}  // namespace mien

#include "sniff.h"

#include <algorithm>
#include <string_view>

#include "mien/base/bytes.h"

namespace mien {
namespace {

struct Magic {
  std::string_view bytes;
  const char* what;
};

using namespace std::string_view_literals;
constexpr Magic kNotSound[] = {
    {"\x89PNG"sv, "a PNG picture"},
    {"\xff\xd8\xff"sv, "a JPEG picture"},
    {"GIF8"sv, "a GIF picture"},
    {"%PDF"sv, "a PDF document"},
    {"PK\x03\x04"sv, "a ZIP archive (or an office document)"},
    {"\x1f\x8b"sv, "a gzip archive"},
    {"7z\xbc\xaf"sv, "a 7z archive"},
    {"\x7f"
     "ELF"sv,
     "a program (ELF)"},
    {"MZ"sv, "a Windows program"},
    {"glTF"sv, "a glTF model"},
    {"MThd"sv, "a MIDI file, which holds notes and no sound"},
    {"SQLite format 3"sv, "a database"},
    {"\x93NUMPY"sv, "a NumPy array"},
};

// Printable ASCII, white space, or bytes of UTF-8 sequences, and nothing else.
bool is_text(std::string_view head) {
  return std::all_of(head.begin(), head.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u >= 0x80   ? u >= 0x80 && u < 0xf5
           : u >= 0x20 ? u != 0x7f
                       : u == '\n' || u == '\r' || u == '\t' || u == '\f';
  });
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

}  // namespace

Sniffed sniff(std::span<const std::byte> head) {
  const std::string_view text = as_text(head);
  if (text.starts_with("version https://git-lfs"))
    return {"a Git LFS pointer, not the recording itself", "Run: git lfs pull", true};
  for (const Magic& magic : kNotSound)
    if (text.starts_with(magic.bytes)) return {magic.what, "", true};
  const auto ascii = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; });
  if (text.size() >= 16 && is_text(text) && 2 * ascii > static_cast<std::ptrdiff_t>(text.size()))
    return {text.find("<html") != text.npos || text.find("<HTML") != text.npos ? "a web page" : "a text file",
            "", true};
  if (std::all_of(text.begin(), text.end(), [](char c) { return c == 0; }))
    return {"zero bytes only", "The copy or download may be incomplete", false};
  if (text.starts_with("RIFF"))
    return {text.size() < 12 ? "the first " + std::to_string(text.size()) + " bytes of a RIFF file"
                             : "a RIFF file of type '" + printable(text.substr(8, 4)) + "'",
            "", false};
  if (text.starts_with("OggS")) return {"a damaged Ogg file", "", false};
  if (text.starts_with("fLaC")) return {"a damaged FLAC file", "", false};
  return {"unknown binary data", "", false};
}

}  // namespace mien

#include "ogg_end.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace mien {

// RFC 3533: a page is a header of 27 bytes with its flags in byte 5 (4: last page) and the number of segments
// in byte 26, the length of every segment, and the segments.
bool ogg_is_complete(InputFile& file) {
  std::vector<std::byte> tail(static_cast<std::size_t>(std::min<std::int64_t>(file.size(), 1 << 17)));
  file.seek(file.size() - static_cast<std::int64_t>(tail.size()));
  tail.resize(file.read(tail));
  const std::size_t page = as_text(tail).rfind("OggS");
  if (page == std::string_view::npos || tail.size() - page < 27) return false;
  const std::size_t num_segments = static_cast<std::size_t>(tail[page + 26]);
  std::size_t size = 27 + num_segments;
  if (tail.size() - page < size) return false;
  for (std::size_t i = 0; i < num_segments; ++i) size += static_cast<std::size_t>(tail[page + 27 + i]);
  return (tail[page + 5] & std::byte{4}) != std::byte{0} && tail.size() - page >= size;
}

}  // namespace mien

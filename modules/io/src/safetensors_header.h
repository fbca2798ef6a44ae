#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "mien/io/safetensors.h"

namespace mien {

/// Header of a file without its length prefix: what is stored, and where in the data.
struct SafetensorsHeader {
  struct Entry {
    StoredTensor tensor;
    std::size_t begin = 0, end = 0;  ///< bytes from the start of the data
  };
  Metadata metadata;
  std::vector<Entry> entries;  ///< in the order of the data
};

/// Parses and checks `text` against `data_size` bytes of data. The error's `what` is the tensor or member, or
/// empty.
Result<SafetensorsHeader> parse_safetensors_header(std::string_view text, std::size_t data_size);

/// JSON of a header, padded with spaces to a multiple of 8 bytes. Error: a text that is not UTF-8.
Result<std::string> format_safetensors_header(const SafetensorsHeader& header);

/// Size in bytes of a tensor, or nothing when it does not fit. @pre no negative size
std::optional<std::size_t> stored_size(const StoredTensor& tensor);

}  // namespace mien

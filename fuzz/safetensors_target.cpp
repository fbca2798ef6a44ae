#include <array>

#include "mien/io/safetensors.h"
#include "target.h"

namespace mien::fuzz {
namespace {

Bytes file_of(std::string header, std::size_t data_bytes) {
  while (header.size() % 8 != 0) header += ' ';
  Bytes file;
  append_le<std::uint64_t>(file, header.size());
  const auto text = as_bytes(header);
  file.insert(file.end(), text.begin(), text.end());
  for (std::size_t i = 0; i < data_bytes; ++i) file.push_back(static_cast<std::byte>(i * 37));
  return file;
}

std::vector<Bytes> seeds() {
  return {file_of(R"({"x":{"dtype":"F32","shape":[2,3],"data_offsets":[0,24]}})", 24),
          file_of(R"({"__metadata__":{"mien.model":"{\"format_version\":1}"},)"
                  R"("a":{"dtype":"F16","shape":[3],"data_offsets":[0,6]},)"
                  R"("b":{"dtype":"BF16","shape":[1],"data_offsets":[6,8]},)"
                  R"("c":{"dtype":"I64","shape":[],"data_offsets":[8,16]},)"
                  R"("d":{"dtype":"BOOL","shape":[0,4],"data_offsets":[16,16]},)"
                  R"("e":{"dtype":"F64","shape":[1,1,1],"data_offsets":[16,24]}})",
                  24)};
}

Outcome read(std::span<const std::byte> bytes) {
  const auto file = SafetensorsFile::parse({bytes.begin(), bytes.end()});
  if (file) {
    for (const auto& tensor : file->tensors()) {
      (void)file->raw(tensor.name);
      (void)file->read_float(tensor.name);
      (void)file->first_non_finite(tensor.name);
      (void)file->as<float>(tensor.name);
    }
  }
  return outcome_of(file, file ? file->tensors().size() : 0);
}

constexpr std::array<std::string_view, 14> kWords = {
    "__metadata__",
    "\"F64\"",
    "\"U8\"",
    "\"BOOL\"",
    "[",
    "]",
    "{",
    "}",
    ",",
    "\\u0000",
    "\xff",
    "\"x\":{\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[0,8]},",
    "[4294967296,4294967296]",
    "null"};

}  // namespace

Target safetensors_target() { return {"safetensors", &seeds, &read, kWords}; }

}  // namespace mien::fuzz

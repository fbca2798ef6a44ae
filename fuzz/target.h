#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mien/base/bytes.h"
#include "mien/base/result.h"

namespace mien::fuzz {

/// What became of an input. Inputs of equal outcome took much the same way through the reader.
struct Outcome {
  bool is_read = false;
  std::string how;  ///< the error, or the warnings and a rough size of what was read
};

/// A reader of hostile files. `read` may refuse; it may not crash, hang, throw, allocate without limit, or
/// accept what its own writer then refuses.
struct Target {
  std::string_view name;
  std::vector<Bytes> (*seeds)();  ///< small valid files to damage
  Outcome (*read)(std::span<const std::byte>);
  std::span<const std::string_view> words;  ///< pieces of the format that are worth inserting
};

Target wav_target();
Target safetensors_target();
Target gltf_target();
Target motion_csv_target();
Target motion_json_target();
Target npy_target();
Target flame_csv_target();
Target flame_target();  ///< a FLAME model as an archive of arrays
Target direction_csv_target();
Target direction_json_target();
Target zip_target();
Target pickle_target();
Target torch_state_target();  ///< the pickle inside a checkpoint
Target torch_target();
Target obj_target();
Target ply_target();
Target vl_target();
Target mask_csv_target();
Target keys_csv_target();

/// The outcome of a reader: `size` tells how much was read.
template <class T>
Outcome outcome_of(const Result<T>& result, std::size_t size) {
  if (!result) return {false, result.error().message()};
  Outcome outcome{true, ""};
  for (std::size_t left = size; left > 0; left /= 4) outcome.how += '+';
  for (const auto& warning : result.warnings) outcome.how += "; " + warning;
  return outcome;
}

inline Bytes bytes_of(std::string_view text) {
  const auto bytes = as_bytes(text);
  return {bytes.begin(), bytes.end()};
}

}  // namespace mien::fuzz

#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "mien/base/result.h"
#include "mien/io/safetensors.h"

namespace mien::train {

/// The prepared training set of `mien-corpus prepare` (docs/corpus.md), mapped into memory: n entries of
/// speech, each with K takes of the performance, as log-mel frames at 100 Hz and curves at 60 fps.
class TrainingSet {
 public:
  /// Errors: unreadable file (input), missing tensors or shapes that disagree (incompatible), all named.
  static Result<TrainingSet> open(const std::filesystem::path& path);

  struct Entry {
    std::int64_t mel_start, num_mel;       ///< 100 Hz frames
    std::int64_t frame_start, num_frames;  ///< 60 fps frames
    int emotion;                           ///< 0 neutral ... 7
    float intensity;                       ///< 0 ... 1
    bool is_valid;                         ///< belongs to the validation split
  };
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::int64_t num_takes() const { return num_takes_; }
  [[nodiscard]] int style(std::int64_t take, std::size_t entry) const;
  /// [3] take-level strengths of jaw, lips and expression.
  [[nodiscard]] std::span<const float> latents(std::int64_t take, std::size_t entry) const;

  /// log-mel frame t (of the whole file), minus its running level: 64 numbers.
  void relative_mel(std::int64_t t, std::span<float> out) const;
  /// The 45 face numbers (face_space.h) of a take at 60 fps frame n of the whole file.
  void face(std::int64_t take, std::int64_t n, std::span<float> out) const;
  [[nodiscard]] int viseme(std::int64_t n) const { return visemes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] bool lips_closed(std::int64_t n) const { return closures_[static_cast<std::size_t>(n)] != 0; }
  [[nodiscard]] bool accent(std::int64_t n) const { return accents_[static_cast<std::size_t>(n)] != 0; }
  [[nodiscard]] bool blink_onset(std::int64_t take, std::int64_t n) const;
  /// Amplitude of the brow raise whose centre is in this frame, 0 ... 1; 0 for none.
  [[nodiscard]] float brow_raise(std::int64_t take, std::int64_t n) const;
  /// The set's own description (JSON text).
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  explicit TrainingSet(SafetensorsFile file) : file_(std::move(file)) {}
  Status map();

  SafetensorsFile file_;
  std::vector<Entry> entries_;
  std::int64_t num_takes_ = 0, num_frames_ = 0;
  std::span<const std::uint16_t> mel_, curves_;  // half floats
  std::span<const float> level_, latents_;
  std::span<const std::uint8_t> visemes_, closures_, accents_, blink_onsets_, brow_raises_, styles_;
  std::string description_;
};

}  // namespace mien::train

#include "mien/io/motion_json.h"

#include <cmath>
#include <set>

#include "even_motion.h"
#include "frame_text.h"
#include "json_access.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "shape_names.h"

namespace mien {
namespace {

using namespace io;

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxVertices = 1'000'000;
constexpr std::pair<MotionSpace, std::string_view> kSpaces[] = {{MotionSpace::arkit, "arkit"},
                                                                {MotionSpace::flame, "flame"},
                                                                {MotionSpace::vertices, "vertices"},
                                                                {MotionSpace::rig, "rig"}};

Error bad_json(std::string why) { return {Errc::input, "motion JSON", std::move(why), ""}; }

Result<double> read_rate(const Json& json, const char* key) {
  const auto fps = number_member(json, key);
  if (!fps || !is_frame_rate(*fps))
    return bad_json(std::string("'") + key + "' is no frame rate between 0.1 and 10000");
  return *fps;
}

Result<std::vector<std::string>> read_names(const Json& json, const char* key) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const Json& entry : array_member(json, key)) {
    if (!entry.is_string()) return bad_json(std::string("'") + key + "' holds something that is no name");
    names.push_back(entry.get<std::string>());
    if (!seen.insert(names.back()).second) return bad_json("two channels are called '" + names.back() + "'");
  }
  if (names.empty()) return bad_json(std::string("'") + key + "' is missing or empty");
  return names;
}

// [N, width] numbers from a list of lists.
Result<std::vector<float>> read_frames(const Json& json, const char* key, std::size_t width) {
  const Json& frames = member(json, key);
  if (!frames.is_array()) return bad_json(std::string("'") + key + "' is not a list");
  std::vector<float> values;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const Json& frame = frames[n];
    if (!frame.is_array() || frame.size() != width)
      return bad_json("frame " + std::to_string(n) + " is not a list of " + std::to_string(width) +
                      " numbers");
    for (const Json& entry : frame) {
      const float value = entry.is_number() ? entry.get<float>() : NAN;
      if (!std::isfinite(value))
        return bad_json("frame " + std::to_string(n) + " holds something that is no number");
      values.push_back(value);
    }
  }
  return values;
}

Result<Motion> read_ours(const Json& json) {
  if (const auto version = index_member(json, "mien_motion"); version != kVersion)
    return Error{Errc::incompatible, "motion JSON", "this version of the format is not known, expected 1",
                 "Update the program"};
  Motion motion;
  const std::string space = text_member(json, "space");
  bool known = false;
  for (const auto& [value, name] : kSpaces)
    if (name == space) motion.space = value, known = true;
  if (!known) return bad_json("'space' is '" + space + "', expected arkit, flame, vertices or rig");
  MIEN_TRY(motion.fps, read_rate(json, "fps"));
  if (motion.space == MotionSpace::vertices) {
    const auto count = index_member(member(json, "topology"), "vertices");
    if (!count || *count == 0 || *count > kMaxVertices)
      return bad_json("'topology' does not say how many vertices move");
    motion.topology = {text_member(member(json, "topology"), "name"), static_cast<std::int64_t>(*count)};
  } else {
    MIEN_TRY(motion.channels, read_names(json, "channels"));
  }
  MIEN_TRY(motion.values, read_frames(json, "frames", static_cast<std::size_t>(motion.num_channels())));
  return motion;
}

Result<Motion> read_audio2face(const Json& json) {
  Motion poses;
  MIEN_TRY(poses.fps, read_rate(json, "exportFps"));
  MIEN_TRY(poses.channels, read_names(json, "facsNames"));
  MIEN_TRY(poses.values, read_frames(json, "weightMat", poses.channels.size()));
  const auto matched = arkit_of(poses.channels);
  std::vector<std::size_t> kept;
  std::vector<std::string> left_out;
  Motion motion{MotionSpace::arkit, {}, poses.fps, {}};
  for (const auto name : arkit_names())
    for (std::size_t c = 0; c < matched.size(); ++c)
      if (matched[c] == name && (motion.channels.empty() || motion.channels.back() != name)) {
        motion.channels.emplace_back(name);
        kept.push_back(c);
      }
  if (kept.empty()) {
    poses.space = MotionSpace::rig;
    return poses;
  }
  for (std::size_t c = 0; c < matched.size(); ++c)
    if (std::find(kept.begin(), kept.end(), c) == kept.end()) left_out.push_back(poses.channels[c]);
  for (std::int64_t n = 0; n < poses.num_frames(); ++n)
    for (const std::size_t c : kept) motion.values.push_back(poses.frame(n)[c]);
  Result<Motion> result(std::move(motion));
  if (!left_out.empty()) result.warnings.push_back("poses without an ARKit name: " + listed(left_out));
  return result;
}

class JsonText final : public FrameText {
 public:
  JsonText(const Motion& format, std::string_view audio_name) {
    std::string_view space;
    for (const auto& [value, name] : kSpaces)
      if (value == format.space) space = name;
    head_ = "{\"mien_motion\": " + std::to_string(kVersion) + ", \"space\": \"" + std::string(space) +
            "\", \"fps\": " + json_text(format.fps);
    if (!audio_name.empty()) head_ += ", \"audio\": " + json_text(std::string(audio_name));
    if (format.space == MotionSpace::vertices)
      head_ += ",\n\"topology\": {\"name\": " + json_text(format.topology.name) +
               ", \"vertices\": " + std::to_string(format.topology.num_vertices) + "}";
    else
      head_ += ",\n\"channels\": " + json_text(format.channels);
    head_ += ",\n\"frames\": [";
  }
  [[nodiscard]] std::string_view name() const override { return "motion JSON"; }
  [[nodiscard]] std::string head() const override { return head_; }
  void append(std::string& text, std::int64_t n, std::span<const float> frame) const override {
    text += n == 0 ? "\n[" : ",\n[";
    for (std::size_t c = 0; c < frame.size(); ++c) {
      if (c > 0) text += ',';
      text += shortest(frame[c]);
    }
    text += ']';
  }
  [[nodiscard]] std::string_view tail() const override { return "\n]}\n"; }

 private:
  std::string head_;
};

}  // namespace

std::unique_ptr<FrameText> io::motion_json_text(const Motion& format, std::string_view audio_name) {
  return std::make_unique<JsonText>(format, audio_name);
}

Status write_motion_json(const Motion& motion, std::string_view audio_name, const TextSink& sink) {
  return write_text(*motion_json_text(motion, audio_name), motion, sink);
}

Result<std::string> motion_json(const Motion& motion, std::string_view audio_name) {
  std::string text;
  MIEN_TRY([[maybe_unused]] const auto done,
           write_motion_json(motion, audio_name, [&](std::string_view piece) -> Status {
             text += piece;
             return Done{};
           }));
  return text;
}

Result<Motion> read_motion_json(std::string_view text) {
  MIEN_TRY(const Json json, parse_json(text, "motion JSON"));
  if (json.is_object() && json.contains("mien_motion")) return read_ours(json);
  if (json.is_object() && json.contains("facsNames")) return read_audio2face(json);
  return Error{Errc::incompatible, "motion JSON",
               "it has neither 'mien_motion' nor the 'facsNames' of Audio2Face", ""};
}

}  // namespace mien

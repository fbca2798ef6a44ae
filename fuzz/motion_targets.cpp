#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/io/live_link_csv.h"
#include "mien/io/motion_json.h"
#include "mien/io/npy.h"
#include "target.h"

namespace mien::fuzz {
namespace {

const Motion& small_motion() {
  static const Motion motion{MotionSpace::arkit,
                             {"jawOpen", "mouthClose", "headYaw"},
                             30,
                             {0, 0, 1, 0.5f, 0.1f, 2, 0.2f, 0, 3, 0.25f, 0, 0}};
  return motion;
}

// What every reader of motion promises, and what every writer asks for.
Outcome check(const Result<Motion>& motion) {
  if (motion) {
    contract(motion->fps > 0 && std::isfinite(motion->fps), "fuzz: the rate is a positive number");
    contract(motion->num_channels() > 0 && static_cast<std::int64_t>(motion->values.size()) ==
                                               motion->num_frames() * motion->num_channels(),
             "fuzz: frames are whole");
    for (const float v : motion->values) contract(std::isfinite(v), "fuzz: coefficients are finite");
    const auto json = motion_json(*motion);
    contract(json.has_value(), "fuzz: what was read can be written");
    const auto again = read_motion_json(*json);
    contract(again.has_value() && again->values == motion->values, "fuzz: JSON gives back what it was given");
    if (motion->space == MotionSpace::arkit) (void)live_link_csv(*motion);
  }
  return outcome_of(motion, motion ? motion->values.size() : 0);
}

std::vector<Bytes> csv_seeds() {
  return {
      bytes_of(*live_link_csv(small_motion())),
      bytes_of(
          "timeCode,blendShapes.JawOpen,blendShapes.EyeBlinkLeft\n0.0,0.1,0\n0.0333,0.2,0\n0.0667,0.3,1\n"),
      bytes_of("jawOpen,mouthSmile_L\n0.1,0.2\n0.3,0.4\n"),
      bytes_of(
          "Timecode,BlendShapeCount,JawOpen,HeadYaw\n23:59:59:58.500,61,0.1,0\n23:59:59:59.499,61,0.2,0.1\n"
          "00:00:00:00.500,0,0.2,0.1\n00:00:00:01.500,61,0.2,0.1\n")};
}
Outcome read_csv(std::span<const std::byte> bytes) { return check(read_live_link_csv(as_text(bytes))); }
constexpr std::array<std::string_view, 15> kCsvWords = {",",
                                                        "\n",
                                                        "\r\n",
                                                        "\"",
                                                        ";",
                                                        "\xef\xbb\xbf",
                                                        "23:59:59:59.999",
                                                        "00:00:00:00.000",
                                                        "BlendShapeCount",
                                                        "Timecode",
                                                        "JawOpen",
                                                        "HeadYaw",
                                                        "blendShapes.",
                                                        "1e38",
                                                        " "};

std::vector<Bytes> json_seeds() {
  return {bytes_of(*motion_json(small_motion(), "a.wav")),
          bytes_of(R"({"exportFps":60.0,"trackPath":"a.wav","numPoses":2,"numFrames":3,)"
                   R"("facsNames":["JawOpen","mouthClose"],"weightMat":[[0.1,0],[0.2,0],[0.3,0.5]]})"),
          bytes_of(R"({"mien_motion":1,"space":"vertices","fps":25,"topology":{"name":"t","vertices":2},)"
                   R"("frames":[[0,0,0,1,1,1],[0,0,0,1,1,2]]})")};
}
Outcome read_json(std::span<const std::byte> bytes) { return check(read_motion_json(as_text(bytes))); }
constexpr std::array<std::string_view, 16> kJsonWords = {"null",
                                                         "true",
                                                         "[",
                                                         "]",
                                                         "{",
                                                         "}",
                                                         ",",
                                                         "\"space\":\"rig\",",
                                                         "\"space\":\"vertices\",",
                                                         "\"frames\":[],",
                                                         "\"channels\":[],",
                                                         "\"fps\":0,",
                                                         "1e400",
                                                         "\\ud800",
                                                         "\"vertices\":2305843009213693952",
                                                         "\"weightMat\":[[]],"};

std::vector<Bytes> npy_seeds() {
  Bytes doubles = bytes_of(std::string("\x93NUMPY\x01\x00", 8));
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
  header.resize(117, ' ');
  header += '\n';
  append_le<std::uint16_t>(doubles, static_cast<std::uint16_t>(header.size()));
  const auto text = as_bytes(header);
  doubles.insert(doubles.end(), text.begin(), text.end());
  for (int i = 0; i < 6; ++i) append_le<double>(doubles, i);
  return {write_npy({{2, 3}, {1, 2, 3, 4, 5, 6}}), write_npy({{}, {1}}), write_npy({{0, 52}, {}}), doubles};
}
Outcome read_array(std::span<const std::byte> bytes) {
  const auto array = read_npy(bytes);
  if (array) {
    std::size_t count = 1;
    for (const auto size : array->shape) count *= static_cast<std::size_t>(size);
    contract(count == array->values.size(), "fuzz: the array has the size of its shape");
    (void)write_npy(*array);
  }
  return outcome_of(array, array ? array->values.size() : 0);
}
constexpr std::array<std::string_view, 14> kNpyWords = {"'<f4'",
                                                        "'>f4'",
                                                        "'<f8'",
                                                        "True",
                                                        "False",
                                                        "(",
                                                        ")",
                                                        ", ",
                                                        "'shape': ",
                                                        "9223372036854775807",
                                                        "4294967296, 4294967296, 0",
                                                        "\x93NUMPY\x02",
                                                        "'descr': '<f4', ",
                                                        "-1"};

}  // namespace

Target motion_csv_target() { return {"motion-csv", &csv_seeds, &read_csv, kCsvWords}; }
Target motion_json_target() { return {"motion-json", &json_seeds, &read_json, kJsonWords}; }
Target npy_target() { return {"npy", &npy_seeds, &read_array, kNpyWords}; }

}  // namespace mien::fuzz

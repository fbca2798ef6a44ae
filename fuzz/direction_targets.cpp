#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/models/direction.h"
#include "target.h"

namespace mien::fuzz {
namespace {

// A direction that was read can be asked at any time.
Outcome check(const Result<Direction>& direction) {
  if (direction)
    for (const double seconds : {0.0, 0.5, 1e6}) {
      const float strength = direction->strength(seconds);
      contract(strength >= 0 && strength <= 1, "fuzz: the strength of a direction lies in 0 ... 1");
    }
  return outcome_of(direction, direction ? direction->keys().size() : 0);
}

std::vector<Bytes> csv_seeds() {
  return {bytes_of("time,emotion,intensity\n0,neutral,0\n1.5,happy,0.8\n1.5,sad,0.2\n"),
          bytes_of("time,emotion,intensity,style\n0,angry,3,S01\n2,angry,1,S11\n")};
}
Outcome read_csv(std::span<const std::byte> bytes) { return check(parse_direction_csv(as_text(bytes))); }
constexpr std::array<std::string_view, 10> kCsvWords = {",", "\n",  "\r\n", "contempt", "S05",
                                                        "3", "0.5", " ",    "\"",       "\xef\xbb\xbf"};

std::vector<Bytes> json_seeds() {
  return {bytes_of(
      R"([{"time":0,"emotion":"neutral","intensity":0},{"time":1.5,"emotion":"happy","intensity":0.8,)"
      R"("style":"S03"},{"time":1.5,"emotion":"angry","intensity":2}])")};
}
Outcome read_json(std::span<const std::byte> bytes) { return check(parse_direction_json(as_text(bytes))); }
constexpr std::array<std::string_view, 12> kJsonWords = {
    "null",  "true",    "[",  "]", "{", "}", ",", "\"style\":\"S05\",", "\"emotion\":\"fear\",",
    "1e400", "\\ud800", "{},"};

}  // namespace

Target direction_csv_target() { return {"direction-csv", &csv_seeds, &read_csv, kCsvWords}; }
Target direction_json_target() { return {"direction-json", &json_seeds, &read_json, kJsonWords}; }

}  // namespace mien::fuzz

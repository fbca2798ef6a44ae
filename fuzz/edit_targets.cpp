// What an edit keeps: masks and keys set by hand.
#include <array>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/io/edit_csv.h"
#include "target.h"

namespace mien::fuzz {
namespace {

std::vector<Bytes> mask_seeds() {
  return {bytes_of("jawOpen,mouthSmileLeft\n1,0\n0.25,1.0\r\n\n0,1e-3\n"),
          bytes_of("\xef\xbb\xbfTimecode,BlendShapeCount, JawOpen \n00:00:00:00.000,61,1\n")};
}
Outcome read_mask(std::span<const std::byte> bytes) {
  const auto table = read_mask_csv(as_text(bytes));
  if (table) {
    contract(!table->channels.empty() && table->weights.size() % table->channels.size() == 0,
             "fuzz: a mask has whole frames");
    for (const float w : table->weights) contract(w >= 0 && w <= 1, "fuzz: weights lie in 0 ... 1");
  }
  return outcome_of(table, table ? table->weights.size() : 0);
}

std::vector<Bytes> keys_seeds() {
  return {bytes_of("time,channel,value\n1.5,jawOpen,0.3\n0.25,headYaw,-12\n2,jawOpen,\n")};
}
Outcome read_keys(std::span<const std::byte> bytes) {
  const auto keys = read_keys_csv(as_text(bytes));
  if (keys)
    for (const MotionKey& key : *keys)
      contract(key.seconds >= 0 && std::isfinite(key.seconds) && !key.channel.empty() &&
                   (!key.value || std::isfinite(*key.value)),
               "fuzz: keys have a time, a channel and a finite value");
  return outcome_of(keys, keys ? keys->size() : 0);
}

constexpr std::array<std::string_view, 12> kWords = {
    ",", "\n", "\r\n", "\"", ";", "\xef\xbb\xbf", "time", "Timecode", "jawOpen", "1e38", "nan", "-0"};

}  // namespace

Target mask_csv_target() { return {"mask-csv", &mask_seeds, &read_mask, kWords}; }
Target keys_csv_target() { return {"keys-csv", &keys_seeds, &read_keys, kWords}; }

}  // namespace mien::fuzz

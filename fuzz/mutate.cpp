#include "mutate.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace mien::fuzz {
namespace {

constexpr std::size_t kMaxBytes = 1 << 18;

std::size_t below(Rng& rng, std::size_t n) { return static_cast<std::size_t>(rng.below(n)); }
auto at(Bytes& bytes, std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); }

// Short pieces more often than long ones.
std::size_t some_length(Rng& rng, std::size_t most) {
  return 1 + below(rng, std::min<std::size_t>(most, std::size_t{1} << below(rng, 10)));
}

void set_integer(Bytes& input, Rng& rng) {
  constexpr std::array<std::uint64_t, 14> kValues = {0,
                                                     1,
                                                     2,
                                                     4,
                                                     0x7f,
                                                     0x80,
                                                     0xff,
                                                     0x7fff,
                                                     0xffff,
                                                     0x7fffffff,
                                                     0x80000000,
                                                     0xffffffff,
                                                     0x7fffffffffffffff,
                                                     0xffffffffffffffff};
  const std::size_t width = std::size_t{1} << below(rng, 4);
  if (input.size() < width) return;
  std::uint64_t value = kValues[below(rng, kValues.size())];
  if (rng.chance(0.3)) value = input.size() + below(rng, 17) - 8;
  const std::size_t where = below(rng, input.size() - width + 1);
  std::uint64_t old = 0;
  std::memcpy(&old, input.data() + where, width);
  if (rng.chance(0.3)) value = old + below(rng, 9) - 4;
  std::memcpy(input.data() + where, &value, width);
}

void insert(Bytes& input, std::span<const std::byte> piece, Rng& rng) {
  if (input.size() + piece.size() > kMaxBytes) return;
  const Bytes own(piece.begin(), piece.end());  // the piece may lie in `input`
  input.insert(at(input, below(rng, input.size() + 1)), own.begin(), own.end());
}

// Some run of digits becomes another number.
void set_text_number(Bytes& input, Rng& rng) {
  constexpr std::array<std::string_view, 14> kNumbers = {"0",
                                                         "-1",
                                                         "1e999",
                                                         "-1e-999",
                                                         "nan",
                                                         "inf",
                                                         "4294967296",
                                                         "9223372036854775807",
                                                         "-9223372036854775809",
                                                         "18446744073709551616",
                                                         "0.0000000001",
                                                         "1e9",
                                                         "",
                                                         "\"x\""};
  const auto is_digit = [](std::byte b) { return b >= std::byte{'0'} && b <= std::byte{'9'}; };
  const auto from = at(input, below(rng, input.size()));
  const auto first = std::find_if(from, input.end(), is_digit);
  if (first == input.end()) return;
  const auto last = std::find_if_not(first, input.end(), is_digit);
  const auto text = as_bytes(kNumbers[below(rng, kNumbers.size())]);
  const auto where = input.erase(first, last);
  input.insert(where, text.begin(), text.end());
}

}  // namespace

void mutate(Bytes& input, const Bytes& other, std::span<const std::string_view> words, Rng& rng) {
  if (input.empty()) {
    input = other;
    return;
  }
  const std::size_t where = below(rng, input.size());
  const std::size_t length = std::min(some_length(rng, input.size()), input.size() - where);
  switch (rng.below(10)) {
    case 0:
      input[where] ^= static_cast<std::byte>(1u << rng.below(8));
      break;
    case 1:
      input[where] = static_cast<std::byte>(rng.below(256));
      break;
    case 2:
      set_integer(input, rng);
      break;
    case 3:
      input.erase(at(input, where), at(input, where + length));
      break;
    case 4:
      insert(input, std::span(input).subspan(where, length), rng);
      break;
    case 5:
      if (!other.empty()) {
        const std::size_t start = below(rng, other.size());
        insert(input, std::span(other).subspan(start, std::min(length, other.size() - start)), rng);
      }
      break;
    case 6:
      if (!words.empty()) insert(input, as_bytes(words[below(rng, words.size())]), rng);
      break;
    case 7:
      set_text_number(input, rng);
      break;
    case 8:
      std::swap_ranges(at(input, where), at(input, where + length),
                       at(input, below(rng, input.size() - length + 1)));
      break;
    default:
      if (rng.chance(0.2))
        input.resize(where);  // cut
      else
        std::fill(at(input, where), at(input, where + length), static_cast<std::byte>(rng.below(256)));
  }
}

}  // namespace mien::fuzz

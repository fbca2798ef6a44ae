#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace mien {

/// The 28 mouth shapes of the corpus (specification, sections 2 and 4). The order is part of the file
/// formats.
// clang-format off
enum class Viseme : std::uint8_t {
  sil, PP, FF, TH, DD, NN, LL, KK, CH, SS, RR, WW, YY, HH,  // pause and consonants
  AA, AE, AH, AX, AO, OW, UH, UW, EH, IH, IY, ER, UY, OE,   // vowels
};
// clang-format on
inline constexpr int kNumVisemes = 28;

/// "sil", "PP" ... "OE", indexed by the value of Viseme.
std::span<const std::string_view, kNumVisemes> viseme_names();
std::string_view name_of(Viseme viseme);
std::optional<Viseme> parse_viseme(std::string_view name);
constexpr bool is_vowel(Viseme viseme) { return viseme >= Viseme::AA; }

/// What a phone looks like: one viseme, or two (diphthong, vowel + off-glide): the first holds the first 55 %
/// of the segment, the second the rest.
struct Visemes {
  Viseme first = Viseme::sil;
  std::optional<Viseme> second = std::nullopt;
  bool operator==(const Visemes&) const = default;
};

/// "AA" or "AA+IH".
std::optional<Visemes> parse_visemes(std::string_view text);

/// Visemes of a phone string of espeak-ng (IPA). Length, stress, tie and other marks are ignored; an empty
/// string or "_" is a pause; a letter that is not in the table is AX. Anything after two visemes is dropped.
Visemes visemes_of_ipa(std::string_view phone);

/// Visemes of an ARPABET-like label of flite or festival ("aa", "AH0", "pau"); nothing when the label is
/// unknown.
std::optional<Visemes> visemes_of_arpabet(std::string_view phone);

/// Visemes of a label of the festvox-ru recordings ("pp", "ae", "sch"); nothing when the label is unknown.
std::optional<Visemes> visemes_of_festvox_ru(std::string_view phone);

/// True for p and b in any of the three alphabets, false for m: only stops build pressure behind the lips.
/// @param phone  the label of a segment whose viseme is PP
bool is_bilabial_stop(std::string_view phone);

/// The blended channels of the articulatory model, each 0 ... 1 at default gains (specification, section 4).
enum class Articulator : std::uint8_t {
  jaw_open,    ///< JO
  round,       ///< RD, tight rounding and protrusion
  funnel,      ///< FN, open protrusion
  spread,      ///< SP
  lower_lip,   ///< LL, depression
  upper_lip,   ///< UL, raising
  tongue,      ///< TG, tip visible
  jaw_thrust,  ///< JF
};
inline constexpr int kNumArticulators = 8;

/// One row of the table of section 4.
struct VisemeTarget {
  std::array<double, kNumArticulators> target;  ///< indexed by Articulator
  double jaw_strength;                          ///< dominance of jaw_open and jaw_thrust
  double lip_strength;                          ///< dominance of the other six
  double onset_s, release_s;                    ///< widths of the Gaussian flanks
  double trim_start, trim_end;                  ///< parts of the segment outside of its core
};
const VisemeTarget& viseme_target(Viseme viseme);

}  // namespace mien

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <unordered_map>

#include "mien/corpus/viseme.h"

namespace mien {
namespace {

using enum Viseme;

struct IpaRow {
  Viseme viseme;
  std::u32string_view letters;
};
// Single letters of the table of section 4.
constexpr std::array<IpaRow, 26> kIpa = {{
    {PP, U"pbmɓ"},
    {FF, U"fvɱʋβɸ"},
    {TH, U"θð"},
    {DD, U"tdʈɖɾɽr"},
    {NN, U"nɲɳ"},
    {LL, U"lɭɫʎɬ"},
    {KK, U"kgɡŋxɣqχʁʀʔcɟç"},
    {CH, U"ʃʒɕʑʂʐ"},
    {SS, U"sz"},
    {RR, U"ɹɻ"},
    {WW, U"wʍɥ"},
    {YY, U"jʝ"},
    {HH, U"hħɦ"},
    {AA, U"aɑ"},
    {AE, U"æ"},
    {AH, U"ʌɐ"},
    {AX, U"əɘᵻ"},
    {AO, U"ɔɒ"},
    {OW, U"o"},
    {UH, U"ʊɤ"},
    {UW, U"uʉɯ"},
    {EH, U"ɛe"},
    {IH, U"ɪɨ"},
    {IY, U"i"},
    {ER, U"ɜɝɚ"},
    {UY, U"yʏ"},
}};
constexpr std::u32string_view kRoundedMidFront = U"øœɵ";

Viseme viseme_of_letter(char32_t letter) {
  for (const IpaRow& row : kIpa)
    if (row.letters.find(letter) != std::u32string_view::npos) return row.viseme;
  return kRoundedMidFront.find(letter) != std::u32string_view::npos ? OE : AX;
}

// Length, stress, tie, tone, syllabicity, palatalisation ...: everything that is not a letter of its own.
bool is_mark(char32_t c) {
  if (c < 0x80) return !std::isalpha(static_cast<int>(c));
  const bool is_modifier_letter = c >= 0x2b0 && c <= 0x2ff;
  const bool is_combining = c >= 0x300 && c <= 0x36f;
  const bool is_zero_width = c >= 0x200b && c <= 0x200d;
  return is_modifier_letter || is_combining || is_zero_width || c == 0x207f;
}

// Letters of a UTF-8 text without marks. A byte that is no UTF-8 becomes U+FFFD, which no table knows.
std::u32string letters_of(std::string_view text) {
  std::u32string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    char32_t c = lead;
    const int num_more = lead < 0x80         ? 0
                         : (lead >> 5) == 6  ? 1
                         : (lead >> 4) == 14 ? 2
                         : (lead >> 3) == 30 ? 3
                                             : -1;
    if (num_more < 0) {
      c = 0xfffd;
    } else if (num_more > 0) {
      c = lead & (0x3fu >> num_more);
      for (int k = 0; k < num_more; ++k) {
        if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) {
          c = 0xfffd;
          break;
        }
        c = (c << 6) | (static_cast<unsigned char>(text[i++]) & 0x3f);
      }
    }
    if (!is_mark(c)) out += c;
  }
  return out;
}

// Affricates are one viseme.
std::optional<Viseme> affricate_at(std::u32string_view letters) {
  const std::u32string_view pair = letters.substr(0, 2);
  if (pair == U"tʃ" || pair == U"dʒ" || pair == U"tɕ" || pair == U"dʑ") return CH;
  if (pair == U"ts" || pair == U"dz") return SS;
  return std::nullopt;
}

using LabelTable = std::unordered_map<std::string_view, Visemes>;

const LabelTable& arpabet_table() {
  static const LabelTable table = {
      {"p", {PP}},      {"b", {PP}},      {"m", {PP}},      {"em", {PP}},     {"f", {FF}},
      {"v", {FF}},      {"th", {TH}},     {"dh", {TH}},     {"t", {DD}},      {"d", {DD}},
      {"dx", {DD}},     {"en", {NN}},     {"n", {NN}},      {"nx", {NN}},     {"l", {LL}},
      {"el", {LL}},     {"k", {KK}},      {"g", {KK}},      {"ng", {KK}},     {"ch", {CH}},
      {"jh", {CH}},     {"sh", {CH}},     {"zh", {CH}},     {"s", {SS}},      {"z", {SS}},
      {"r", {RR}},      {"w", {WW}},      {"y", {YY}},      {"hh", {HH}},     {"hv", {HH}},
      {"aa", {AA}},     {"ae", {AE}},     {"ah", {AH}},     {"ax", {AX}},     {"ao", {AO}},
      {"eh", {EH}},     {"er", {ER}},     {"axr", {ER}},    {"ih", {IH}},     {"ix", {IH}},
      {"iy", {IY}},     {"uh", {UH}},     {"uw", {UW}},     {"ay", {AA, IH}}, {"aw", {AA, UH}},
      {"oy", {AO, IH}}, {"ey", {EH, IY}}, {"ow", {OW, UH}}, {"pau", {sil}},   {"sil", {sil}},
      {"sp", {sil}},    {"h#", {sil}},    {"brth", {sil}},  {"", {sil}}};
  return table;
}

const LabelTable& festvox_ru_table() {
  static const LabelTable table = {
      {"p", {PP}},  {"pp", {PP}},  {"b", {PP}},   {"bb", {PP}}, {"m", {PP}},  {"mm", {PP}}, {"f", {FF}},
      {"ff", {FF}}, {"v", {FF}},   {"vv", {FF}},  {"t", {DD}},  {"tt", {DD}}, {"d", {DD}},  {"dd", {DD}},
      {"r", {DD}},  {"rr", {DD}},  {"n", {NN}},   {"nn", {NN}}, {"l", {LL}},  {"ll", {LL}}, {"k", {KK}},
      {"kk", {KK}}, {"g", {KK}},   {"gg", {KK}},  {"h", {KK}},  {"hh", {KK}}, {"sh", {CH}}, {"zh", {CH}},
      {"ch", {CH}}, {"sch", {CH}}, {"s", {SS}},   {"ss", {SS}}, {"z", {SS}},  {"zz", {SS}}, {"c", {SS}},
      {"j", {YY}},  {"a", {AH}},   {"aa", {AH}},  {"ay", {AX}}, {"ae", {IH}}, {"i", {IH}},  {"ii", {IY}},
      {"e", {EH}},  {"ee", {EH}},  {"o", {AO}},   {"oo", {AO}}, {"u", {UH}},  {"ur", {UH}}, {"uu", {UW}},
      {"y", {IH}},  {"yy", {IH}},  {"pau", {sil}}};
  return table;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::optional<Visemes> look_up(const LabelTable& table, std::string_view label) {
  const auto found = table.find(label);
  if (found == table.end()) return std::nullopt;
  return found->second;
}

}  // namespace

Visemes visemes_of_ipa(std::string_view phone) {
  const std::u32string letters = letters_of(phone);
  std::u32string_view rest = letters;
  std::array<Viseme, 2> found{};
  std::size_t num = 0;
  if (const auto affricate = affricate_at(rest)) {
    found[num++] = *affricate;
    rest.remove_prefix(2);
  }
  for (; !rest.empty() && num < found.size(); rest.remove_prefix(1))
    found[num++] = viseme_of_letter(rest.front());
  if (num == 0) return {sil};
  if (num == 1 || found[0] == found[1]) return {found[0]};
  return {found[0], found[1]};
}

std::optional<Visemes> visemes_of_arpabet(std::string_view phone) {
  std::string label = lower(phone);
  if (!label.empty() && std::isdigit(static_cast<unsigned char>(label.back())))
    label.pop_back();  // stress: "ah0"
  return look_up(arpabet_table(), label);
}

std::optional<Visemes> visemes_of_festvox_ru(std::string_view phone) {
  return look_up(festvox_ru_table(), phone);
}

bool is_bilabial_stop(std::string_view phone) {
  const std::string label = lower(phone);
  return label.find('m') == std::string::npos;
}

}  // namespace mien

#include "mien/corpus/corpus_files.h"

#include <algorithm>
#include <cmath>

#include "mien/base/contract.h"
#include "mien/core/motion.h"
#include "tsv.h"

namespace mien {
namespace {

constexpr std::string_view kItemsHeader =
    "id\tsplit\tengine\tvoice\tlang\tspeaker\temotion\tlevel\tseconds\tframes\tquestion\ttext";
constexpr std::string_view kPhonesHeader =
    "start\tend\tphone\tviseme\tprominence\tclosure_start\tclosure_end";
constexpr double kMaxSeconds = 24 * 3600;
constexpr double kMaxProminence = 10;

std::string one_line(std::string_view text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return out;
}

double rounded(double value) { return parse_double(fixed(value, 4)).value_or(0); }

std::string visemes_text(const Visemes& v) {
  std::string text(name_of(v.first));
  if (v.second) text += "+" + std::string(name_of(*v.second));
  return text;
}

}  // namespace

bool is_valid_item_id(std::string_view id) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  return !id.empty() && id.size() <= 120 && id.front() != '.' &&
         std::all_of(id.begin(), id.end(), is_allowed);
}

std::string format_items(std::span<const CorpusItem> items) {
  std::string out(kItemsHeader);
  out += '\n';
  for (const CorpusItem& item : items) {
    contract(is_valid_item_id(item.id), "format_items: not an item id: " + item.id);
    for (const std::string& cell :
         {item.id, one_line(item.split), one_line(item.engine), one_line(item.voice), one_line(item.language),
          one_line(item.speaker), std::string(name_of(item.emotion)), std::to_string(item.level),
          fixed(item.seconds, 4), std::to_string(item.num_frames), std::string(item.is_question ? "1" : "0")})
      out += cell + '\t';
    out += one_line(item.text) + '\n';
  }
  return out;
}

Result<std::vector<CorpusItem>> parse_items(std::string_view text, std::string_view name) {
  std::vector<CorpusItem> items;
  MIEN_TRY([[maybe_unused]] const Done done, read_tsv(text, name, kItemsHeader, [&](TsvRow& row) {
             CorpusItem item;
             item.id = row.text("id");
             if (!is_valid_item_id(item.id)) row.fail("id", "'" + item.id + "' cannot name files");
             item.split = row.text("split");
             item.engine = row.text("engine");
             item.voice = row.text("voice");
             item.language = row.text("lang");
             item.speaker = row.text("speaker");
             item.emotion = row.named("emotion", parse_emotion);
             item.level = static_cast<int>(row.integer("level", 1, 3));
             item.seconds = row.number("seconds", 0, kMaxSeconds);
             item.num_frames = row.integer("frames", 0, num_motion_frames(kMaxSeconds, 60));
             item.is_question = row.integer("question", 0, 1) == 1;
             item.text = row.text("text");
             const std::int64_t expected = num_motion_frames(item.seconds, 60);
             if (item.num_frames != expected)
               row.fail("frames", std::to_string(item.num_frames) + " do not fit the duration, expected " +
                                      std::to_string(expected));
             items.push_back(std::move(item));
           }));
  return items;
}

std::string format_phones(std::span<const PhoneSegment> phones) {
  std::string out(kPhonesHeader);
  out += '\n';
  for (const PhoneSegment& phone : phones) {
    out +=
        fixed(phone.start_s, 4) + '\t' + fixed(phone.end_s, 4) + '\t' + one_line(phone.label) + '\t' +
        visemes_text(phone.visemes) + '\t' + fixed(phone.prominence, 4) + '\t' +
        (phone.closure ? fixed(phone.closure->start_s, 4) + '\t' + fixed(phone.closure->end_s, 4) : "-\t-") +
        '\n';
  }
  return out;
}

Result<std::vector<PhoneSegment>> parse_phones(std::string_view text, std::string_view name) {
  std::vector<PhoneSegment> phones;
  MIEN_TRY([[maybe_unused]] const Done done, read_tsv(text, name, kPhonesHeader, [&](TsvRow& row) {
             PhoneSegment phone;
             const double earliest = phones.empty() ? 0 : phones.back().start_s;
             phone.start_s = row.number("start", earliest, kMaxSeconds);
             phone.end_s = row.number("end", phone.start_s, kMaxSeconds);
             phone.label = row.text("phone");
             phone.visemes = row.named("viseme", parse_visemes);
             phone.prominence = row.number("prominence", 0, kMaxProminence);
             const auto start = row.optional_number("closure_start", 0, kMaxSeconds);
             const auto end = row.optional_number("closure_end", start.value_or(0), kMaxSeconds);
             if (start.has_value() != end.has_value()) row.fail("closure_end", "a closure needs both ends");
             if (start && end) phone.closure = TimeSpan{*start, *end};
             phones.push_back(std::move(phone));
           }));
  return phones;
}

std::string format_accents(std::span<const double> accents_s) {
  std::string out;
  for (const double accent : accents_s) out += fixed(accent, 4) + '\n';
  return out;
}

Result<std::vector<double>> parse_accents(std::string_view text, std::string_view name) {
  std::vector<double> accents;
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    TsvRow row(lines[i], std::string(name) + ", line " + std::to_string(i + 1));
    accents.push_back(row.number("time", 0, kMaxSeconds));
    if (row.num_cells() != 1) row.fail("time", "more than one column");
    if (row.error()) return *row.error();
  }
  return accents;
}

void round_to_file(Utterance& utterance) {
  for (PhoneSegment& phone : utterance.phones) {
    phone.start_s = rounded(phone.start_s);
    phone.end_s = rounded(phone.end_s);
    phone.prominence = rounded(phone.prominence);
    if (phone.closure)
      phone.closure = TimeSpan{rounded(phone.closure->start_s), rounded(phone.closure->end_s)};
  }
  for (double& accent : utterance.accents_s) accent = rounded(accent);
  utterance.seconds = rounded(utterance.seconds);
}

}  // namespace mien

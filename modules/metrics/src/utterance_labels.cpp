#include "mien/metrics/utterance_labels.h"

#include <algorithm>

namespace mien {
namespace {

constexpr double kPauseSeconds = 0.3;
constexpr double kGapSeconds = 1e-3;  // files carry 4 decimals

PhoneRow row_of(const PhoneSegment& phone) {
  PhoneRow row;
  row.start = phone.start_s, row.end = phone.end_s, row.confidence = 1;
  row.phone = phone.is_pause() ? "sp" : phone.label;
  row.viseme = name_of(phone.visemes.first);
  if (phone.visemes.first == Viseme::FF) row.phone = "f";
  if (phone.is_bilabial()) {
    const TimeSpan closure = phone.closure ? *phone.closure : default_closure(phone);
    row.closure = ClosureWindow{closure.start_s, closure.end_s};
  }
  return row;
}

PhoneRow silence(double start, double end) {
  PhoneRow row;
  row.start = start, row.end = end, row.confidence = 1;
  row.phone = "sp", row.viseme = "sil";
  return row;
}

void append(std::vector<PhoneRow>& rows, PhoneRow row) {
  if (!rows.empty() && rows.back().is_silence() && row.is_silence())
    rows.back().end = row.end;  // two silences are one pause
  else
    rows.push_back(std::move(row));
}

// One closure for bilabials that directly follow each other.
void merge_bilabials(std::vector<PhoneRow>& rows) {
  for (std::size_t first = 0; first < rows.size(); ++first) {
    std::size_t last = first;
    while (rows[first].closure && last + 1 < rows.size() && rows[last + 1].closure) ++last;
    if (last == first) continue;
    const ClosureWindow window{rows[first].closure->start, rows[last].closure->end};
    for (std::size_t i = first; i <= last; ++i) {
      rows[i].closure = window;
      rows[i].flags |= i == first ? kMerged : kMerged | kSameEvent;
    }
    first = last;
  }
}

}  // namespace

SpeechLabels labels_of(const Utterance& utterance) {
  SpeechLabels labels;
  double t = 0;
  for (const PhoneSegment& phone : utterance.phones) {
    if (phone.start_s > t + kGapSeconds) append(labels.rows, silence(t, phone.start_s));
    append(labels.rows, row_of(phone));
    t = std::max(t, phone.end_s);
  }
  if (utterance.seconds > t + kGapSeconds) append(labels.rows, silence(t, utterance.seconds));
  for (PhoneRow& row : labels.rows)
    if (row.is_silence() && row.end - row.start >= kPauseSeconds) row.phone = "sil";
  merge_bilabials(labels.rows);
  return labels;
}

Utterance utterance_of(const SpeechLabels& labels) {
  Utterance utterance;
  for (const PhoneRow& row : labels.rows) {
    const std::string phone = row.is_silence() ? "pau" : row.phone;
    PhoneSegment segment{row.start, row.end, phone, visemes_of_arpabet(phone).value_or(Visemes{Viseme::AX})};
    if (row.closure)
      segment.closure = TimeSpan{row.closure->start, std::max(row.closure->start, row.closure->end)};
    utterance.phones.push_back(std::move(segment));
  }
  utterance.seconds = labels.seconds();
  return utterance;
}

std::vector<TimeInterval> pause_intervals(const Utterance& utterance) {
  std::vector<TimeInterval> out;
  for (const TimeSpan& pause : pauses_of(utterance)) out.push_back({pause.start_s, pause.end_s});
  return out;
}

}  // namespace mien

#include "mien/corpus/closure.h"

#include "mien/base/contract.h"

namespace mien {
namespace {

enum class Bilabial { p, b, m };

Bilabial bilabial_of(std::string_view label) {
  if (!is_bilabial_stop(label)) return Bilabial::m;
  const bool is_voiced = label.find_first_of("bB") != std::string_view::npos || label.starts_with("ɓ");
  return is_voiced ? Bilabial::b : Bilabial::p;
}

// Parts of the segment before and after the closure.
struct Trim {
  double start, end;
};

Trim trim_of(PhoneSource source, Bilabial phone) {
  const bool is_nasal = phone == Bilabial::m;
  switch (source) {
    case PhoneSource::hts:
      if (phone == Bilabial::p) return {0.08, 0.45};
      [[fallthrough]];
    case PhoneSource::statistical:
      return {0.08, is_nasal ? 0.12 : 0.25};
    case PhoneSource::diphone:
      return is_nasal ? Trim{0.08, 0.10} : Trim{0.10, 0.28};
    case PhoneSource::festvox_ru:
      return is_nasal ? Trim{0.15, 0.20} : Trim{0.05, 0.25};
    case PhoneSource::espeak:
      break;
  }
  contract(false, "closure_window: unknown source");
  return {};
}

TimeSpan espeak_window(Bilabial phone, const PhoneSegment& segment, double event_s) {
  const double s = segment.start_s, d = segment.seconds();
  switch (phone) {
    case Bilabial::p:
      return {s < event_s ? s : event_s - 0.050, event_s + 0.004};
    case Bilabial::b:
      return {s + 0.004, s + 0.65 * d};
    case Bilabial::m:
      break;
  }
  return {s + 0.06 * d, segment.end_s - 0.12 * d};
}

}  // namespace

std::optional<TimeSpan> closure_window(PhoneSource source, const PhoneSegment& segment, double event_s) {
  if (!segment.is_bilabial()) return std::nullopt;
  const Bilabial phone = bilabial_of(segment.label);
  if (source == PhoneSource::espeak) return espeak_window(phone, segment, event_s);
  const Trim trim = trim_of(source, phone);
  const double d = segment.seconds();
  return TimeSpan{segment.start_s + trim.start * d, segment.end_s - trim.end * d};
}

}  // namespace mien

#include "mien/corpus/performance.h"

#include <algorithm>

#include "mien/base/contract.h"
#include "mien/corpus/closure.h"

namespace mien {

TimeSpan default_closure(const PhoneSegment& segment) {
  const auto window = closure_window(PhoneSource::statistical, segment, segment.start_s);
  contract(window.has_value(), "default_closure: not a bilabial: " + segment.label);
  return *window;
}

std::vector<TimeSpan> pauses_of(const Utterance& utterance) {
  std::vector<TimeSpan> pauses;
  double silent_since = 0;
  for (const PhoneSegment& phone : utterance.phones) {
    if (phone.is_pause()) continue;
    if (phone.start_s > silent_since) pauses.push_back({silent_since, phone.start_s});
    silent_since = std::max(silent_since, phone.end_s);
  }
  if (utterance.seconds > silent_since) pauses.push_back({silent_since, utterance.seconds});
  return pauses;
}

Utterance join(std::vector<Utterance> parts) {
  Utterance all;
  for (Utterance& part : parts) {
    const double shift = all.seconds;
    for (PhoneSegment& phone : part.phones) {
      phone.start_s += shift;
      phone.end_s += shift;
      if (phone.closure)
        phone.closure = TimeSpan{phone.closure->start_s + shift, phone.closure->end_s + shift};
      all.phones.push_back(std::move(phone));
    }
    for (const double accent : part.accents_s) all.accents_s.push_back(accent + shift);
    all.seconds += part.seconds;
    all.is_question = part.is_question;
  }
  return all;
}

void stretch(Utterance& utterance, double factor) {
  for (PhoneSegment& phone : utterance.phones) {
    phone.start_s *= factor;
    phone.end_s *= factor;
    if (phone.closure)
      phone.closure = TimeSpan{phone.closure->start_s * factor, phone.closure->end_s * factor};
  }
  for (double& accent : utterance.accents_s) accent *= factor;
  utterance.seconds *= factor;
}

}  // namespace mien

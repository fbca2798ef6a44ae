#include "system_subjects.h"

#include <set>

#include "mien/models/probtalk3d/conventions.h"

namespace mien {
namespace {

// The order in which the authors' programs number their training subjects (FaceDiffuser specification,
// section 9; FaceXHuBERT specification, section 2).
std::vector<std::string> published_subjects(Architecture architecture, const std::string& topology) {
  if (architecture == Architecture::facexhubert)
    return {"F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8", "M1", "M2", "M3", "M4", "M5", "M6"};
  if (architecture == Architecture::probtalk3d || architecture == Architecture::facediffuser_emotion)
    return probtalk3d::published_identities();
  if (topology == "flame")
    return {"FaceTalk_170728_03272_TA", "FaceTalk_170904_00128_TA", "FaceTalk_170725_00137_TA",
            "FaceTalk_170915_00223_TA", "FaceTalk_170811_03274_TA", "FaceTalk_170913_03279_TA",
            "FaceTalk_170904_03276_TA", "FaceTalk_170912_03278_TA"};
  if (topology == "multiface") return {"2", "3", "6", "7", "9", "10", "11", "12", "13"};
  return {"F2", "F3", "F4", "M3", "M4", "M5"};
}

}  // namespace

Result<std::vector<std::string>> subject_names(const std::vector<std::string>& given, std::int64_t count,
                                               Architecture architecture, const std::string& topology) {
  if (!given.empty()) {
    if (count == 0) return Error{Errc::usage, "--subjects", "does not apply: the model has no styles", ""};
    if (static_cast<std::int64_t>(given.size()) != count)
      return Error{Errc::usage, "--subjects",
                   "names " + std::to_string(given.size()) + " subjects, the model was trained with " +
                       std::to_string(count),
                   ""};
    const std::set<std::string> different(given.begin(), given.end());
    if (different.size() != given.size() || different.contains(""))
      return Error{Errc::usage, "--subjects", "has an empty name or one twice", ""};
    return given;
  }
  auto published = published_subjects(architecture, topology);
  if (count == 0) return std::vector<std::string>();
  const bool known = static_cast<std::int64_t>(published.size()) == count;
  if (known && (architecture == Architecture::facexhubert || !topology.empty() ||
                architecture == Architecture::facediffuser_emotion))
    return published;
  std::vector<std::string> numbers;
  for (std::int64_t i = 1; i <= count; ++i) numbers.push_back(std::to_string(i));
  Result<std::vector<std::string>> result(std::move(numbers));
  result.warnings.push_back(
      "the " + std::to_string(count) +
      " subjects are called by their numbers; --subjects names them, in training order");
  return result;
}

}  // namespace mien

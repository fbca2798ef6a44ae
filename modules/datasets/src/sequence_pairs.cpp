#include "mien/datasets/sequence_pairs.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace mien {
namespace {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> motion_files(const fs::path& place) {
  std::error_code ec;
  std::vector<fs::path> files;
  if (fs::is_regular_file(place, ec)) return std::vector{place};
  fs::directory_iterator entries(place, ec);
  if (ec) return Error{Errc::input, "'" + place.string() + "'", "cannot be listed: " + ec.message(), ""};
  for (const auto& entry : entries) {
    const auto extension = entry.path().extension();
    if (extension == ".npy" || extension == ".csv" || extension == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The first `count` fields between underscores.
std::string first_fields(const std::string& stem, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) {
    end = stem.find('_', i == 0 ? 0 : end + 1);
    if (end == std::string::npos) return stem;
  }
  return stem.substr(0, end);
}

// Where "_condition_" begins, in either spelling.
std::size_t find_condition(const std::string& stem) {
  const auto small = stem.find("_condition_");
  return small != std::string::npos ? small : stem.find("_Condition_");
}

PredictedSequence parse(const fs::path& path, PairRule rule, const std::set<std::string>& subjects) {
  const std::string stem = path.stem().string();
  PredictedSequence own;
  own.predicted = path;
  own.sequence = rule == PairRule::beat     ? first_fields(stem, 3)
                 : rule == PairRule::uudamm ? first_fields(stem, 2)
                                            : stem;
  if (rule == PairRule::vertices) {
    const auto at = find_condition(stem);
    if (at != std::string::npos) {
      own.sequence = stem.substr(0, at);
      own.condition = stem.substr(at + std::string_view("_condition_").size());
    }
  }
  own.subject = own.sequence.substr(0, own.sequence.rfind('_'));
  // "F2_3" is sample 3 in the style of F2; "FaceTalk_170728_03272_TA" is a subject.
  const auto sample = own.condition.rfind('_');
  if (sample != std::string::npos && !subjects.contains(own.condition) &&
      std::all_of(own.condition.begin() + static_cast<std::ptrdiff_t>(sample) + 1, own.condition.end(),
                  [](unsigned char c) { return std::isdigit(c) != 0; }))
    own.condition.resize(sample);
  return own;
}

}  // namespace

Result<PairedSequences> pair_sequences(const fs::path& predicted, const fs::path& truth, PairRule rule) {
  MIEN_TRY(const auto predictions, motion_files(predicted));
  MIEN_TRY(const auto truths, motion_files(truth));
  std::map<std::string, fs::path> truth_of;
  std::set<std::string> subjects, used;
  for (const auto& path : truths) {
    const std::string stem = path.stem().string();
    truth_of[rule == PairRule::beat     ? first_fields(stem, 3)
             : rule == PairRule::uudamm ? first_fields(stem, 2)
                                        : stem] = path;
    subjects.insert(stem.substr(0, stem.rfind('_')));
  }
  PairedSequences result;
  if (predictions.size() == 1 && truths.size() == 1) {  // two files were named: they are meant
    auto own = parse(predictions[0], rule, subjects);
    own.truth = truths[0];
    result.pairs.push_back(std::move(own));
    return result;
  }
  std::map<std::string, std::vector<PredictedSequence>> by_sequence;
  for (const auto& path : predictions) {
    auto own = parse(path, rule, subjects);
    by_sequence[own.sequence].push_back(std::move(own));
  }
  for (auto& [sequence, members] : by_sequence) {
    const bool has_own_style = std::any_of(members.begin(), members.end(), [](const PredictedSequence& p) {
      return p.condition.empty() || p.condition == p.subject;
    });
    if (!has_own_style) {
      if (members.size() > 1)
        for (const auto& member : members) result.takes[sequence].push_back(member.predicted);
      continue;
    }
    const auto found = truth_of.find(sequence);
    if (found == truth_of.end()) {
      result.without_truth.push_back(sequence);
      continue;
    }
    used.insert(sequence);
    for (auto& member : members) {
      if (!member.condition.empty() && member.condition != member.subject) continue;
      member.truth = found->second;
      result.pairs.push_back(std::move(member));
    }
  }
  for (const auto& [sequence, path] : truth_of)
    if (!used.contains(sequence) && !result.takes.contains(sequence))
      result.without_prediction.push_back(sequence);
  if (result.pairs.empty() && result.takes.empty())
    return Error{Errc::input, "'" + predicted.string() + "'",
                 "none of its " + std::to_string(predictions.size()) + " sequences has a truth among the " +
                     std::to_string(truths.size()) + " of '" + truth.string() + "'",
                 "Predictions are called as the truth, or <truth>_condition_<subject>"};
  return result;
}

}  // namespace mien

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

bool is_number(std::string_view text) {
  return !text.empty() && text.size() < 10 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// "name(3)" and "name-3": the name, and 3. Without a number, 0.
std::pair<std::string, int> name_and_take(const std::string& stem) {
  const auto open = stem.rfind('('), dash = stem.rfind('-');
  if (stem.ends_with(')') && open != std::string::npos && open > 0)
    if (const std::string number = stem.substr(open + 1, stem.size() - open - 2); is_number(number))
      return {stem.substr(0, open), std::stoi(number)};
  if (dash != std::string::npos && dash > 0)
    if (const std::string number = stem.substr(dash + 1); is_number(number))
      return {stem.substr(0, dash), std::stoi(number)};
  return {stem, 0};
}

PredictedSequence parse(const fs::path& path, PairRule rule, const std::set<std::string>& subjects) {
  const std::string stem = path.stem().string();
  PredictedSequence own;
  own.predicted = path;
  own.sequence = rule == PairRule::beat     ? first_fields(name_and_take(stem).first, 3)
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

Result<PairedTakes> pair_takes(const fs::path& predicted, const fs::path& truth) {
  MIEN_TRY(const auto predictions, motion_files(predicted));
  MIEN_TRY(const auto truths, motion_files(truth));
  std::map<std::string, std::map<int, fs::path>> takes_of;  // by the truth's name
  PairedTakes result;
  for (const auto& path : predictions) {
    const auto [name, take] = name_and_take(path.stem().string());
    std::string best;
    for (const auto& candidate : truths) {
      const std::string stem = candidate.stem().string();
      const bool fits = name == stem || (name.starts_with(stem) && name[stem.size()] == '_');
      if (fits && stem.size() > best.size()) best = stem;
    }
    if (best.empty())
      result.without_truth.push_back(name);
    else if (!takes_of[best].emplace(take, path).second)
      return Error{Errc::input, "'" + path.string() + "'",
                   "is a second take " + std::to_string(take) + " of '" + best + "'",
                   "Keep one style of every sequence in the folder"};
  }
  for (const auto& path : truths) {
    const auto found = takes_of.find(path.stem().string());
    if (found == takes_of.end()) {
      result.without_prediction.push_back(path.stem().string());
      continue;
    }
    SequenceTakes own{found->first, path, {}};
    for (const auto& [number, take] : found->second) own.takes.push_back(take);
    result.sequences.push_back(std::move(own));
  }
  if (result.sequences.empty())
    return Error{Errc::input, "'" + predicted.string() + "'",
                 "none of its " + std::to_string(predictions.size()) + " sequences has a truth among the " +
                     std::to_string(truths.size()) + " of '" + truth.string() + "'",
                 "Predictions are called <truth>, or <truth>_ and more, with (n) or -n at the end"};
  return result;
}

}  // namespace mien

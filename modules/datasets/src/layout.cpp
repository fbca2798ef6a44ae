#include "mien/datasets/layout.h"

#include <algorithm>
#include <array>
#include <map>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/core/rig_controls.h"

namespace mien {
namespace {

using Names = std::vector<std::string>;
constexpr std::array<std::string_view, 6> kNames = {"biwi", "biwi-expressive", "vocaset", "multiface",
                                                    "beat", "uudamm"};

const std::array<DatasetLayout, 6>& layouts() {
  static const std::array<DatasetLayout, 6> table = [] {
    const Names biwi_six = {"F2", "F3", "F4", "M3", "M4", "M5"};
    const Names biwi_all = {"F1", "F2", "F3", "F4", "F5", "F6", "F7",
                            "F8", "M1", "M2", "M3", "M4", "M5", "M6"};
    const Names voca_train = {"FaceTalk_170728_03272_TA", "FaceTalk_170904_00128_TA",
                              "FaceTalk_170725_00137_TA", "FaceTalk_170915_00223_TA",
                              "FaceTalk_170811_03274_TA", "FaceTalk_170913_03279_TA",
                              "FaceTalk_170904_03276_TA", "FaceTalk_170912_03278_TA"};
    const Names voca_val = {"FaceTalk_170811_03275_TA", "FaceTalk_170908_03277_TA"};
    const Names voca_test = {"FaceTalk_170809_00138_TA", "FaceTalk_170731_00024_TA"};
    const Names multiface_nine = {"2", "3", "6", "7", "9", "10", "11", "12", "13"};
    const Names multiface_all = {"2", "3", "6", "7", "9", "10", "11", "12", "13", "1", "4", "5", "8"};
    const auto beat_width = static_cast<std::int64_t>(kNumArkit) - 1;
    const auto uudamm_width = static_cast<std::int64_t>(kNumUudamm);
    using enum MotionSpace;
    return std::array<DatasetLayout, 6>{{
        {DatasetKind::biwi,
         kNames[0],
         vertices,
         70110,
         25,
         1,
         true,
         biwi_six,
         {{"train", biwi_six, {{1, 32}}, 192},
          {"val", biwi_six, {{33, 36}}, 24},
          {"test", biwi_all, {{37, 40}}, 56}}},
        {DatasetKind::biwi_expressive,
         kNames[1],
         vertices,
         70110,
         25,
         1,
         true,
         biwi_all,
         {{"train", biwi_all, {{1, 36}, {41, 76}}, 977},
          {"val", biwi_all, {{37, 38}, {77, 78}}, 56},
          {"test", biwi_all, {{39, 40}, {79, 80}}, 55}}},
        {DatasetKind::vocaset,
         kNames[2],
         vertices,
         15069,
         30,
         2,
         true,
         voca_train,
         {{"train", voca_train, {{1, 40}}, 320},
          {"val", voca_val, {{21, 40}}, 40},
          {"test", voca_test, {{21, 40}}, 40}}},
        {DatasetKind::multiface,
         kNames[3],
         vertices,
         18516,
         30,
         1,
         true,
         multiface_nine,
         {{"train", multiface_nine, {{1, 40}}, 360},
          {"val", multiface_nine, {{41, 45}}, 45},
          {"test", multiface_all, {{46, 50}}, 65}}},
        {DatasetKind::beat, kNames[4], arkit, beat_width, 30, 1, false, {"2", "4", "6", "8"}, {}},
        {DatasetKind::uudamm, kNames[5], rig, uudamm_width, 30, 1, false, {}, {}},
    }};
  }();
  return table;
}

std::optional<int> number(std::string_view text) {
  const auto value = parse_int(text);
  if (text.empty() || text.front() == '-' || text.front() == '+' || !value || *value > 1'000'000)
    return std::nullopt;
  return static_cast<int>(*value);
}

// UUDaMM: piece -> split, from the shuffled list of its 2537 pieces.
std::optional<std::string_view> uudamm_split(int piece) {
  constexpr int kPieces = 2537, kTrain = 80, kVal = 10, kTest = 10;
  static const auto table = [] {
    std::map<int, std::string_view> splits;
    const auto order = python_shuffle(kPieces, 1);
    for (int i = 0; i < kTrain + kVal + kTest; ++i)
      splits[order[static_cast<std::size_t>(i)]] = i < kTrain ? "train" : i < kTrain + kVal ? "val" : "test";
    return splits;
  }();
  const auto found = table.find(piece);
  return found == table.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

const DatasetLayout& dataset_layout(DatasetKind kind) { return layouts()[static_cast<std::size_t>(kind)]; }

std::span<const std::string_view> dataset_names() { return kNames; }

std::optional<DatasetKind> parse_dataset_kind(std::string_view name) {
  for (const auto& layout : layouts())
    if (layout.name == name) return layout.kind;
  return std::nullopt;
}

std::optional<SequenceName> parse_sequence_name(DatasetKind kind, std::string_view stem) {
  const auto last = stem.rfind('_');
  if (last == std::string_view::npos || last == 0) return std::nullopt;
  std::string_view subject = stem.substr(0, last), end = stem.substr(last + 1);
  SequenceName name;
  if (kind == DatasetKind::biwi) {
    if (!end.starts_with('e')) return std::nullopt;
    end.remove_prefix(1);
  } else if (kind == DatasetKind::vocaset) {
    constexpr std::string_view kWord = "sentence";
    if (!end.starts_with(kWord)) return std::nullopt;
    end.remove_prefix(kWord.size());
  } else if (kind == DatasetKind::beat) {
    const auto middle = subject.rfind('_');
    if (middle == std::string_view::npos || middle == 0) return std::nullopt;
    const auto emotion = number(subject.substr(middle + 1));
    if (!emotion) return std::nullopt;
    name.emotion = *emotion;
    subject = subject.substr(0, middle);
  }
  const auto sentence = number(end);
  if (!sentence) return std::nullopt;
  name.subject = subject;
  name.sentence = *sentence;
  return name;
}

std::optional<std::string_view> split_of(DatasetKind kind, const SequenceName& name) {
  if (kind == DatasetKind::uudamm) return uudamm_split(name.sentence);
  for (const auto& rule : dataset_layout(kind).splits) {
    const bool has_subject = rule.subjects.empty() || std::find(rule.subjects.begin(), rule.subjects.end(),
                                                                name.subject) != rule.subjects.end();
    for (const auto& [first, last] : rule.sentences)
      if (has_subject && name.sentence >= first && name.sentence <= last) return rule.split;
  }
  return std::nullopt;
}

int beat_emotion(int field) {
  constexpr std::array<int, 7> kFirst = {65, 73,  81, 87,
                                         95, 103, 111};  // happiness, anger, sadness, contempt,
  constexpr std::array<int, 7> kEnd = {72, 80, 86, 94, 102, 110, 118};  // surprise, fear, disgust
  for (std::size_t i = 0; i < kFirst.size(); ++i)
    if (field >= kFirst[i] && field < kEnd[i]) return static_cast<int>(i) + 1;
  return 0;
}

}  // namespace mien

#include "mien/datasets/layout.h"

#include <algorithm>
#include <array>
#include <map>

#include "mien/base/contract.h"
#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/core/emotion.h"
#include "mien/core/flame_parameters.h"
#include "mien/core/rig_controls.h"

namespace mien {
namespace {

using Names = std::vector<std::string>;
constexpr std::array<std::string_view, 9> kNames = {
    "biwi",   "biwi-expressive", "vocaset",      "multiface",      "beat",
    "uudamm", "3dmead",          "3dmead-prior", "3dmead-vertices"};
constexpr int kNumIntensities = 3;  // of MEAD

const std::array<DatasetLayout, 9>& layouts() {
  static const std::array<DatasetLayout, 9> table = [] {
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
    const Names mead_train = {"M003", "M005", "M007", "M009", "M011", "M012", "M013", "M019",
                              "M022", "M023", "M024", "M025", "M026", "M027", "M028", "M029",
                              "M030", "M031", "W009", "W011", "W014", "W015", "W016", "W018",
                              "W019", "W021", "W023", "W024", "W025", "W026", "W028", "W029"};
    const Names mead_val = {"M032", "M033", "M034", "M035", "W033", "W035", "W036"};
    const Names mead_test = {"M037", "M039", "M040", "M041", "M042", "W037", "W038", "W040"};
    // Each subject reads 40 neutral sentences, and 30 of each emotion at each intensity.
    const std::vector<SplitRule> by_sentence = {{"train", mead_train, {{0, 32}}, 17152, {{0, 24}}},
                                                {"val", mead_train, {{33, 36}}, 2144, {{25, 27}}},
                                                {"test", mead_train, {{37, 40}}, 2144, {{28, 30}}}};
    constexpr int kLast = 1'000'000;
    const std::vector<SplitRule> by_subject = {{"train", mead_train, {{0, kLast}}, 21440},
                                               {"val", mead_val, {{0, kLast}}, 4690},
                                               {"test", mead_test, {{0, kLast}}, 5360}};
    const auto flame_width = static_cast<std::int64_t>(kNumFlame);
    using enum MotionSpace;
    return std::array<DatasetLayout, 9>{{
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
        {DatasetKind::mead, kNames[6], flame, flame_width, 25, 1, false, mead_train, by_sentence, "param"},
        {DatasetKind::mead_prior, kNames[7], flame, flame_width, 25, 1, false, mead_train, by_subject,
         "param", false},
        {DatasetKind::mead_vertices, kNames[8], vertices, 15069, 25, 1, true, mead_train, by_sentence},
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

// "M003_001_5_2"
std::optional<SequenceName> parse_mead_name(std::string_view stem) {
  std::array<int, 3> numbers{};  // from the end: intensity, emotion, sentence
  for (int& field : numbers) {
    const auto cut = stem.rfind('_');
    if (cut == std::string_view::npos || cut == 0) return std::nullopt;
    const auto value = number(stem.substr(cut + 1));
    if (!value) return std::nullopt;
    field = *value;
    stem = stem.substr(0, cut);
  }
  const auto [intensity, emotion, sentence] = numbers;
  if (emotion >= kNumEmotions || intensity >= kNumIntensities) return std::nullopt;
  return SequenceName{std::string(stem), sentence, emotion, intensity};
}

bool is_mead(DatasetKind kind) {
  return kind == DatasetKind::mead || kind == DatasetKind::mead_prior || kind == DatasetKind::mead_vertices;
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
  if (is_mead(kind)) return parse_mead_name(stem);
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
    const bool is_emotional = name.emotion > 0 && !rule.emotional.empty();
    for (const auto& [first, last] : is_emotional ? rule.emotional : rule.sentences)
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

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "mien/audio/load_audio.h"
#include "mien/base/file.h"
#include "mien/corpus/corpus_files.h"
#include "mien/corpus/prominence.h"
#include "mien/corpus/take.h"
#include "test_paths.h"

// Prominence and curves on recordings of people with phone labels, when these recordings are there.
namespace mien {
namespace {

std::filesystem::path human_folder() { return shared_path("audio/human"); }

// The labels have the columns of phones/<id>.tsv up to the viseme.
Utterance read_labels(const std::string& id) {
  Utterance utterance;
  const auto bytes = read_file(human_folder() / "labels" / (id + ".tsv"));
  if (!bytes) return utterance;
  std::string rows = "start\tend\tphone\tviseme\tprominence\tclosure_start\tclosure_end\n";
  std::string_view text = as_text(*bytes);
  text.remove_prefix(text.find('\n') + 1);
  while (!text.empty()) {
    const auto line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    std::size_t end = 0;
    for (int column = 0; column < 4; ++column) end = line.find('\t', end) + 1;
    rows += std::string(line.substr(0, end)) + "1\t-\t-\n";
  }
  auto phones = parse_phones(rows, id);
  EXPECT_TRUE(phones.has_value()) << phones.error().message();
  if (phones) utterance.phones = std::move(*phones);
  return utterance;
}

TEST(HumanSpeech, AccentsAndProminence) {
  if (!std::filesystem::exists(human_folder())) GTEST_SKIP() << "the recordings of audio/human are not here";
  double speech_seconds = 0;
  std::size_t num_accents = 0, num_vowels = 0, num_changed = 0;
  for (const std::string id :
       {"arctic_a0024", "ls_1089-134686-0000", "ls_1272-128104-0000", "ls_2412-153948-0000", "sb_spk1_snt1",
        "sb_spk1_snt2", "vctk_p225_003", "vctk_p225_008", "vctk_p225_011"}) {
    const auto clip = load_audio(human_folder() / (id + ".flac"));
    ASSERT_TRUE(clip.has_value()) << clip.error().message();
    Utterance utterance = read_labels(id);
    ASSERT_FALSE(utterance.phones.empty()) << id;
    utterance.seconds = clip->seconds();
    add_prominence(utterance, clip->samples);
    num_accents += utterance.accents_s.size();
    for (const PhoneSegment& phone : utterance.phones) {
      if (!phone.is_pause()) speech_seconds += phone.seconds();
      if (!is_vowel(phone.visemes.first)) continue;
      ++num_vowels;
      num_changed += std::abs(phone.prominence - 1) > 0.02;
    }
    EXPECT_EQ(default_performance(utterance).num_frames(), num_motion_frames(clip->seconds(), 60));
  }
  // The specification found 0.8 to 1.1 accents a second on other recordings.
  const double rate = static_cast<double>(num_accents) / speech_seconds;
  EXPECT_GT(rate, 0.7);
  EXPECT_LT(rate, 1.5);
  EXPECT_GT(num_changed * 2, num_vowels);
}

}  // namespace
}  // namespace mien

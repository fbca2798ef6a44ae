#include "mien/corpus/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace mien {
namespace {

std::vector<Viseme> letters(const std::string& text) {  // a stand-in for an engine: each letter is a phone
  std::vector<Viseme> visemes;
  for (const char c : text)
    if (std::isalpha(static_cast<unsigned char>(c)))
      visemes.push_back(visemes_of_ipa(std::string(1, c)).first);
  return visemes;
}

TEST(Text, FixedSentencesAreDifferentAndComplete) {
  std::set<std::string_view> all(fixed_sentences().begin(), fixed_sentences().end());
  EXPECT_EQ(all.size(), 80u);
  for (const auto sentence : all)
    EXPECT_NE(std::string(".?!").find(sentence.back()), std::string::npos) << sentence;
}

TEST(Text, GrammarGivesManySentences) {
  Rng rng(1), again(1);
  std::set<std::string> seen;
  int questions = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string sentence = draw_sentence(rng);
    ASSERT_EQ(sentence, draw_sentence(again));
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(sentence.front()))) << sentence;
    EXPECT_NE(std::string(".?!").find(sentence.back()), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find(" a a"), std::string::npos) << sentence;
    questions += sentence.back() == '?';
    seen.insert(sentence);
  }
  EXPECT_GT(seen.size(), 2990u);
  EXPECT_NEAR(questions / 3000.0, 1 / 6.0, 0.03);
}

TEST(Text, BabbleHasThreeToSixWords) {
  Rng rng(2);
  std::set<std::string> seen;
  for (int i = 0; i < 500; ++i) {
    const std::string text = draw_babble(rng);
    const auto num_words = 1 + std::count(text.begin(), text.end(), ' ');
    EXPECT_GE(num_words, 3);
    EXPECT_LE(num_words, 6);
    EXPECT_EQ(text.back(), '.');
    seen.insert(text);
  }
  EXPECT_EQ(seen.size(), 500u);
}

TEST(Text, SplitFollowsFromTheText) {
  Rng rng(3);
  int num[3] = {};
  for (int i = 0; i < 4000; ++i) ++num[static_cast<int>(split_of_text(draw_sentence(rng)))];
  EXPECT_NEAR(num[0] / 4000.0, 0.90, 0.02);
  EXPECT_NEAR(num[1] / 4000.0, 0.05, 0.015);
  EXPECT_NEAR(num[2] / 4000.0, 0.05, 0.015);
}

// The same choice by scoring every candidate again at each step.
std::vector<std::string> plain_greedy(std::vector<std::string> candidates, std::size_t count) {
  std::vector<std::string> selected;
  std::map<std::vector<Viseme>, int> counts;
  const auto trigrams = [](const std::string& text) {
    std::vector<Viseme> v = letters(text);
    v.insert(v.begin(), Viseme::sil);
    v.push_back(Viseme::sil);
    std::vector<std::vector<Viseme>> out;
    for (std::size_t i = 2; i < v.size(); ++i) out.push_back({v[i - 2], v[i - 1], v[i]});
    return out;
  };
  while (selected.size() < count && !candidates.empty()) {
    std::size_t best = 0;
    double best_score = -1;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      double score = 0;
      for (const auto& t : trigrams(candidates[i])) score += 1.0 / (1 + counts[t]);
      if (score > best_score) best = i, best_score = score;
    }
    for (const auto& t : trigrams(candidates[best])) ++counts[t];
    selected.push_back(candidates[best]);
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return selected;
}

TEST(SentenceSelector, EqualsPlainGreedyChoice) {
  Rng rng(4);
  std::vector<std::string> candidates;
  for (int i = 0; i < 200; ++i) candidates.push_back(draw_sentence(rng));
  SentenceSelector selector(letters);
  EXPECT_EQ(selector.select(candidates, 20), plain_greedy(candidates, 20));
}

TEST(SentenceSelector, CoversMoreThanChanceAndNeverRepeats) {
  Rng rng(5);
  std::vector<std::string> candidates;
  for (int i = 0; i < 1000; ++i) candidates.push_back(draw_sentence(rng));
  candidates.insert(candidates.end(), candidates.begin(), candidates.begin() + 100);
  SentenceSelector greedy(letters), first(letters);
  const auto chosen = greedy.select(candidates, 50);
  ASSERT_EQ(chosen.size(), 50u);
  (void)first.select(std::span(candidates).first(50), 50);
  EXPECT_GT(greedy.num_trigrams(), first.num_trigrams() * 115 / 100);
  const auto more = greedy.select(candidates, 2000);
  std::set<std::string> all(chosen.begin(), chosen.end());
  all.insert(more.begin(), more.end());
  EXPECT_EQ(all.size(), chosen.size() + more.size());
  EXPECT_EQ(all.size(), std::set(candidates.begin(), candidates.end()).size());
  EXPECT_TRUE(greedy.select({}, 3).empty());
}

}  // namespace
}  // namespace mien

#include "mien/metrics/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mien/metrics/human_report.h"

namespace mien {
namespace {

MetricTable small_table() {
  return {"Title",
          {"a", "b"},
          {{"closure F1",
            "",
            "2PH / (P + H) | pooled",
            ">= 0.62",
            2,
            {{0.4119, Interval{0.36, 0.47}}, {std::nan("")}}},
           {"timing bias", "ms", "median", "", 0, {{-12.4}, {3}}}},
          {"A note."}};
}

TEST(Report, MarkdownStatesTheDefinitionBesideTheNumber) {
  const std::string text = to_markdown(small_table());
  EXPECT_NE(text.find("| measure | a | b | target |\n| --- | --- | --- | --- |\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("| closure F1 | 0.41 [0.36, 0.47] | - | >= 0.62 |"), std::string::npos) << text;
  EXPECT_NE(text.find("| timing bias (ms) | -12 | 3 |  |"), std::string::npos) << text;
  EXPECT_NE(text.find("- **closure F1**: 2PH / (P + H) | pooled"), std::string::npos) << text;
  EXPECT_NE(text.find("A note."), std::string::npos);
}

TEST(Report, JsonKeepsFullNumbersAndNulls) {
  const auto root = nlohmann::json::parse(to_json(small_table()));
  EXPECT_EQ(root["columns"][1], "b");
  EXPECT_DOUBLE_EQ(root["rows"][0]["values"][0]["value"], 0.4119);
  EXPECT_DOUBLE_EQ(root["rows"][0]["values"][0]["high"], 0.47);
  EXPECT_TRUE(root["rows"][0]["values"][1]["value"].is_null());
  EXPECT_EQ(root["rows"][0]["definition"], "2PH / (P + H) | pooled");
}

TEST(Report, TextAlignsColumns) {
  const std::string text = to_text(small_table());
  std::vector<std::string> lines;
  for (std::size_t start = 0; start < text.size();) {
    const auto end = text.find('\n', start);
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[1].find(" a") + 1, lines[2].find("0.47]") + 4);  // right edges of the first column
}

TEST(Report, AnIncompleteRowIsOurMistake) {
  MetricTable table = small_table();
  table.rows[0].cells.pop_back();
  EXPECT_THROW((void)to_markdown(table), std::logic_error);
  EXPECT_NE(to_markdown({"Empty", {}, {}, {}}).find("Empty"), std::string::npos);
}

TEST(HumanTable, OfAnEmptyReportHasNoColumns) {
  const MetricTable table = human_table({}, 10);
  EXPECT_TRUE(table.columns.empty());
  EXPECT_FALSE(to_json(table).empty());
}

}  // namespace
}  // namespace mien

// Time codes of the MetaHuman export.
#include <algorithm>
#include <string>

#include "fixture.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/io/metahuman_csv.h"

namespace mien::parity {
namespace {

TEST(TimecodeParity, MetahumanRows) {
  for_each_case("facediffuser", "arkit_timecodes_", "fps.txt", [](const std::string& rate) {
    const auto bytes = read_file(fixture_root() / "facediffuser" / ("arkit_timecodes_" + rate + "fps.txt"));
    ASSERT_TRUE(bytes) << bytes.error().message();
    const auto fps = parse_double(rate);
    ASSERT_TRUE(fps);
    std::string_view text = as_text(*bytes);
    std::int64_t row = 0;
    while (!text.empty()) {
      const auto end = std::min(text.find('\n'), text.size());
      if (end > 0) {
        EXPECT_EQ(metahuman_timecode(row, *fps), text.substr(0, end)) << "row " << row;
        ++row;
      }
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    EXPECT_GT(row, 0);
  });
}

}  // namespace
}  // namespace mien::parity

// SAiD's coefficient files: the recorded result as the text that the authors' program writes.
#include <gtest/gtest.h>

#include <algorithm>

#include "fixture.h"
#include "mien/base/file.h"
#include "mien/core/arkit.h"
#include "mien/io/coefficient_csv.h"

namespace mien::parity {
namespace {

TEST(SaidCsv, ResultsGiveTheRecordedText) {
  int count = 0;
  for (const std::string& name : cases("said", "ddim_", ".csv")) {
    SCOPED_TRACE(name);
    const Fixture recorded("said", "ddim.safetensors");
    const Tensor result = recorded.tensor(name + ".result");
    Motion motion{MotionSpace::arkit, arkit_order(ArkitOrder::said), 60, {}};
    motion.values.assign(result.values().begin(), result.values().end());
    std::string text;
    ASSERT_TRUE(write_coefficient_csv(motion, [&](std::string_view piece) -> Status {
      text += piece;
      return Done{};
    }));
    const Bytes want = read_file(fixture_root() / "said" / ("ddim_" + name + ".csv")).value();
    EXPECT_EQ(text, as_text(want));
    ++count;
  }
  if (count == 0) GTEST_SKIP() << "no recorded said/ddim_*.csv in " << fixture_root();
}

}  // namespace
}  // namespace mien::parity

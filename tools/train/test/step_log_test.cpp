#include "step_log.h"

#include <gtest/gtest.h>

#include "mien/base/file.h"
#include "test_folder.h"

namespace mien::train {
namespace {

class Log : public testing::Test {
 protected:
  // A run that reports steps first ... last - 1 of a stage.
  void run(const std::string& stage, std::int64_t first, std::int64_t last) const {
    StepLog log(path_);
    log.begin(stage);
    for (std::int64_t i = first; i < last; ++i)
      ASSERT_TRUE(log.add(i, 0.5 + static_cast<double>(i), 0.25, 2));
  }
  [[nodiscard]] std::string text() const { return std::string(as_text(*read_file(path_))); }

  TestFolder folder_;
  std::filesystem::path path_ = folder_ / "log.tsv";
};

TEST_F(Log, HasALinePerStep) {
  run("mean", 0, 2);
  EXPECT_EQ(text(), "mean\t0\t0.5\t0.25\t2\nmean\t1\t1.5\t0.25\t2\n");
}

TEST_F(Log, StepsDoneAgainReplaceTheOldOnes) {
  run("mean", 0, 12);
  run("diffusion", 0, 3);
  const std::string whole = text();
  run("diffusion", 1, 3);
  EXPECT_EQ(text(), whole);
  run("mean", 10, 12);  // steps 2 and 10 are not confused, and what followed is gone
  EXPECT_EQ(text() + "diffusion\t0\t0.5\t0.25\t2\ndiffusion\t1\t1.5\t0.25\t2\ndiffusion\t2\t2.5\t0.25\t2\n",
            whole);
}

TEST_F(Log, ALineThatWasCutIsForgotten) {
  run("mean", 0, 3);
  const std::string whole = text();
  ASSERT_TRUE(write_file(path_, whole.substr(0, whole.size() - 4)));
  run("mean", 2, 3);
  EXPECT_EQ(text(), whole);
  ASSERT_TRUE(write_file(path_, whole + "diffus"));
  run("diffusion", 0, 1);
  EXPECT_EQ(text(), whole + "diffusion\t0\t0.5\t0.25\t2\n");
}

TEST_F(Log, SaysThatItCannotBeWritten) {
  StepLog log(folder_ / "absent/log.tsv");
  log.begin("mean");
  const auto done = log.add(0, 1, 1, 1);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Errc::failed);
}

}  // namespace
}  // namespace mien::train

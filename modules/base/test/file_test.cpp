// Files that appear whole or not at all.
#include "mien/base/file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "pending_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

class FileTest : public testing::Test {
 protected:
  FileTest() {
    std::string name = (fs::path(testing::TempDir()) / "mien_file_XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~FileTest() override { fs::remove_all(folder); }

  [[nodiscard]] std::string text_of(const char* name) const {
    const auto bytes = read_file(folder / name);
    return bytes ? std::string(as_text(*bytes)) : bytes.error().message();
  }
  fs::path folder;
};

TEST_F(FileTest, AppearsOnlyWhenCommitted) {
  {
    auto file = AtomicFile::create(folder / "a.txt");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write(as_bytes("half")));
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
  }
  EXPECT_TRUE(fs::is_empty(folder));
  ASSERT_TRUE(write_file(folder / "a.txt", "whole"));
  EXPECT_EQ(text_of("a.txt"), "whole");
  ASSERT_TRUE(write_file(folder / "a.txt", "another"));
  EXPECT_EQ(text_of("a.txt"), "another");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST_F(FileTest, ErrorsAreSeenAtTheStart) {
  EXPECT_EQ(read_file(folder).error().code, Errc::input);
  EXPECT_EQ(read_file(folder / "none").error().code, Errc::input);
  EXPECT_FALSE(AtomicFile::create(folder / "no" / "a.txt"));
  EXPECT_FALSE(AtomicFile::create(folder));
  EXPECT_FALSE(AtomicFile::create(folder / std::string(300, 'a')));
  ASSERT_TRUE(write_file(folder / "a.txt", "x"));
  EXPECT_FALSE(AtomicFile::create(folder / "a.txt" / "b.txt"));
}

TEST_F(FileTest, ALibraryWritesByItself) {
  auto file = AtomicFile::create(folder / "a.txt");
  ASSERT_TRUE(file);
  std::ofstream(file->temporary_path()) << "by name";
  std::ofstream(file->temporary_path(), std::ios::app) << ", twice";
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(text_of("a.txt"), "by name, twice");
}

// Both ways, since a machine has file systems of one kind only.
TEST_F(FileTest, HasItsNameInBothWays) {
  for (const auto& open : {PendingFile::unnamed, PendingFile::hidden}) {
    const bool is_hidden = open == PendingFile::hidden;
    for (const bool is_new : {true, false}) {
      auto file = open(folder / "b.txt");
      if (!file && !is_hidden) break;  // this file system cannot
      ASSERT_TRUE(file);
      EXPECT_EQ(fs::exists(PendingFile::hidden_name(folder / "b.txt")), is_hidden);
      const std::string text = is_new ? "new" : "newer";
      ASSERT_EQ(::write(file->descriptor(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
      ASSERT_EQ(file->appear(folder / "b.txt"), 0);
      EXPECT_EQ(text_of("b.txt"), text);
    }
    { const auto dropped = open(folder / "c.txt"); }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
    fs::remove(folder / "b.txt");
  }
  // What a killed process of the same number left is in nobody's way.
  ASSERT_TRUE(write_file(folder / "b.txt", "old"));
  ASSERT_TRUE(write_file(PendingFile::hidden_name(folder / "b.txt"), "left behind"));
  ASSERT_TRUE(write_file(folder / "b.txt", "new"));
  EXPECT_EQ(text_of("b.txt"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST_F(FileTest, AKilledProcessLeavesNothing) {
  if (!PendingFile::unnamed(folder / "a.txt")) GTEST_SKIP() << "the file system has no files without a name";
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto file = AtomicFile::create(folder / "a.txt");
    if (file && file->write(as_bytes("half"))) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_TRUE(fs::is_empty(folder));
}

}  // namespace
}  // namespace mien

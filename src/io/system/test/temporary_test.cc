#include "io/system/temporary.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/system/test/temporary_folder.h"

namespace palpate {
namespace {

TEST(TemporaryFile, IsANewOneOfThatNameThatOtherProgramsDoNotInherit) {
  const test::TemporaryFolder folder;
  const std::string begin = (folder / "a.").string();
  std::string first = begin;
  std::string second = begin;
  const int one = open_temporary_file(first);
  const int two = open_temporary_file(second);
  ASSERT_GE(one, 0);
  ASSERT_GE(two, 0);
  EXPECT_NE(first, second);
  EXPECT_EQ(first.size(), begin.size() + 6);
  EXPECT_EQ(first.compare(0, begin.size(), begin), 0);
  EXPECT_EQ(folder.entries(), 2U);
  EXPECT_EQ(write(one, "x", 1), 1);
  EXPECT_NE(fcntl(one, F_GETFD) & FD_CLOEXEC, 0);
  close(one);
  close(two);
}

TEST(TemporaryFile, IsItsOwnersAloneOrAsTheUmaskAllows) {
  const test::TemporaryFolder folder;
  const mode_t umask_before = umask(022);
  std::string own = (folder / "a.").string();
  std::string shared = own;
  close(open_temporary_file(own));
  close(open_temporary_file(shared, 0666));
  umask(umask_before);
  EXPECT_EQ(std::filesystem::status(own).permissions(), std::filesystem::perms(0600));
  EXPECT_EQ(std::filesystem::status(shared).permissions(), std::filesystem::perms(0644));
}

TEST(TemporaryFile, InNoFolderIsReportedAndLeavesTheName) {
  std::string path = "/nowhere/a.";
  EXPECT_EQ(open_temporary_file(path), -1);
  EXPECT_EQ(path, "/nowhere/a.");
}

TEST(TemporaryFolder, IsANewOneOfThatName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path first = make_temporary_folder(folder / "a-");
  const std::filesystem::path second = make_temporary_folder(folder / "a-");
  EXPECT_NE(first, second);
  EXPECT_TRUE(std::filesystem::is_directory(first));
  EXPECT_EQ(first.parent_path(), folder.path());
  EXPECT_EQ(first.filename().string().compare(0, 2, "a-"), 0);
  EXPECT_EQ(make_temporary_folder("/nowhere/a-"), std::filesystem::path());
}

TEST(ScratchFolder, LeavesNothingBehind) {
  std::filesystem::path path;
  {
    const ScratchFolder folder("palpate-test-");
    path = folder.path();
    std::ofstream(path / "a") << "b";
    EXPECT_TRUE(std::filesystem::is_directory(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace palpate

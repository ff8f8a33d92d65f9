#include "io/system/whole_file.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::ThrowsMessage;

std::string content_in(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> names_below(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

TEST(WholeFile, HasItsContentAndRightsAndLeavesNothingElse) {
  const TemporaryFolder folder;
  create_whole_file(folder / "a", "content", 0600);
  EXPECT_EQ(content_in(folder / "a"), "content");
  EXPECT_THAT(names_below(folder / "."), ElementsAre("a"));
  struct stat facts {};
  ASSERT_EQ(stat((folder / "a").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0600U);
  EXPECT_EQ(facts.st_nlink, 1U);
}

TEST(WholeFile, ReplacesNothing) {
  const TemporaryFolder folder;
  (void)folder.write("a", "old");
  EXPECT_THAT([&] { create_whole_file(folder / "a", "new"); },
              ThrowsMessage<InputError>((folder / "a").string() + ": exists and is not overwritten"));
  EXPECT_EQ(content_in(folder / "a"), "old");
  fs::create_symlink("elsewhere", folder / "link");
  EXPECT_THROW(create_whole_file(folder / "link", "new"), InputError);
  EXPECT_FALSE(fs::exists(folder / "elsewhere"));
  EXPECT_EQ(names_below(folder / ".").size(), 2U);
}

TEST(WholeFile, OfATemporaryFileHasTheNameWithoutDotAndLetters) {
  EXPECT_EQ(name_of_unfinished("folder/.a.json.b2c3d4"), "a.json");
  for (const char* other : {"a.json.b2c3d4", ".a.json.b2c3d", ".b2c3d4", ".", "a.json"}) {
    EXPECT_EQ(name_of_unfinished(other), "") << other;
  }
}

// A limit of the file's size acts as a full disk.
TEST(WholeFile, ThatCannotBeWrittenHasNoName) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10, 10};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      create_whole_file(folder / "a", "more than ten bytes");
    } catch (const InputError& error) {
      _exit(error.what() == (folder / "a").string() + ": cannot be written: File too large" ? 0 : 1);
    }
    _exit(2);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_THAT(names_below(folder / "."), ElementsAre());
}

TEST(WholeFile, IsWholeOrAbsentWhereverItsWriterIsKilled) {
  const TemporaryFolder folder;
  const std::string content(1 << 20, 'x');
  for (int i = 0; i < 40; ++i) {
    const fs::path file = folder / std::to_string(i);
    const pid_t child = fork();
    if (child == 0) {
      create_whole_file(file, content);
      _exit(0);
    }
    usleep(static_cast<useconds_t>(100 * i));
    kill(child, SIGKILL);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    EXPECT_TRUE(!fs::exists(file) || fs::file_size(file) == content.size()) << i;
  }
}

}  // namespace
}  // namespace palpate

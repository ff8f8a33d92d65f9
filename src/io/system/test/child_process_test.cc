#include "io/system/child_process.h"

#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/system/test/temporary_folder.h"

namespace palpate {
namespace {

using test::TemporaryFolder;

int exit_status_of(const ChildProcess& child) {
  std::error_code error;
  const int id = start_process(child, error);
  EXPECT_FALSE(error) << error.message();
  int status = 0;
  EXPECT_EQ(waitpid(id, &status, 0), id);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(ChildProcess, RunsInItsFolderWithItsMessagesInAFileAndNothingToRead) {
  const TemporaryFolder folder;
  EXPECT_EQ(exit_status_of({.arguments = {"sh", "-c", "pwd >&2; test -z \"$(cat)\" && exit 3"},
                            .folder = folder.path(),
                            .messages = folder.path() / "errors.txt"}),
            3);
  std::ifstream in(folder.path() / "errors.txt");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}),
            std::filesystem::canonical(folder.path()).string() + "\n");
}

TEST(ChildProcess, ReadsFromTheDescriptorThatItIsGiven) {
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "5\n", 2), 2);
  EXPECT_EQ(exit_status_of({.arguments = {"sh", "-c", "read number; exit $number"}, .input = ends[0]}), 5);
  close(ends[0]);
  close(ends[1]);
}

TEST(ChildProcess, ApartItInheritsNoFurtherDescriptorAndHasItsOwnGroup) {
  const int open = dup(STDERR_FILENO);  // without O_CLOEXEC
  ASSERT_GT(open, STDERR_FILENO);
  const std::string descriptor = "/proc/self/fd/" + std::to_string(open);
  EXPECT_EQ(exit_status_of({.arguments = {"test", "-e", descriptor}}), 0);
  EXPECT_EQ(exit_status_of({.arguments = {"test", "-e", descriptor}, .apart = true}), 1);
  close(open);
  const auto group_is_its_own = "test \"$(cut -d' ' -f5 /proc/$$/stat)\" = $$";
  EXPECT_EQ(exit_status_of({.arguments = {"sh", "-c", group_is_its_own}}), 1);
  EXPECT_EQ(exit_status_of({.arguments = {"sh", "-c", group_is_its_own}, .apart = true}), 0);
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnError) {
  std::error_code error;
  (void)start_process({.arguments = {"/no/such/program"}}, error);
  EXPECT_EQ(error, std::errc::no_such_file_or_directory);
}

}  // namespace
}  // namespace palpate

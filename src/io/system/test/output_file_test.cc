#include "io/system/output_file.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::EndsWith;
using testing::HasSubstr;

/// The message of require_no_overwrite() for one output and one input.
std::string overwriting(const fs::path& output, const fs::path& input) {
  const std::array<NamedFile, 1> outputs{{{"--csv", output}}};
  const std::array<NamedFile, 1> inputs{{{"recording", input}}};
  try {
    require_no_overwrite(outputs, inputs);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OutputFile, IsRefusedWhenItIsAnInputByNameHardLinkOrSymbolicLink) {
  const TemporaryFolder folder;
  const fs::path input = folder.write("a.h5", "1");
  fs::create_hard_link(input, folder / "hard");
  fs::create_symlink("a.h5", folder / "soft");
  EXPECT_EQ(overwriting(input, input), "--csv " + input.string() + ": is the same file as recording " +
                                           input.string() + ", which is read: name another file");
  EXPECT_NE(overwriting(folder / "hard", input), "");
  EXPECT_NE(overwriting(folder / "soft", input), "");
  EXPECT_NE(overwriting(input, folder / "soft"), "");
  EXPECT_NE(overwriting(folder.path() / "." / "a.h5", input), "");
}

TEST(OutputFile, IsNotRefusedWhenItIsAnotherFileOrADevice) {
  const TemporaryFolder folder;
  const fs::path input = folder.write("a.h5", "1");
  EXPECT_EQ(overwriting(folder.write("b", "1"), input), "");
  EXPECT_EQ(overwriting(folder / "new", input), "");
  EXPECT_EQ(overwriting("", input), "");
  EXPECT_EQ(overwriting("/dev/null", "/dev/null"), "");
}

TEST(OutputFile, IsRefusedWhenAnotherOutputIsTheSameFileThatIsNotThereYet) {
  const TemporaryFolder folder;
  fs::create_symlink("new", folder / "link");
  const std::array<NamedFile, 2> outputs{{{"--record", folder / "new"}, {"--screenshot", folder / "link"}}};
  EXPECT_THAT([&] { require_no_overwrite(outputs, {}); },
              testing::ThrowsMessage<InputError>(HasSubstr("which is written too")));
}

TEST(OutputFile, LinksAreFollowedAlsoToAFileThatIsNotThere) {
  const TemporaryFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink(folder / "c", folder / "b");
  EXPECT_EQ(link_target(folder / "a"), folder / "c");
  EXPECT_EQ(link_target(folder / "c"), folder / "c");
  fs::create_symlink("a", folder / "c");
  EXPECT_THROW((void)link_target(folder / "a"), InputError);
}

TEST(OutputFile, ThatMustBeRegularMayBeNewButNoDeviceFifoOrFolder) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "link");
  require_regular_output(folder / "new");
  require_regular_output(folder.write("a", ""));
  for (const fs::path& file : {folder / "fifo", folder / "link", folder.path(), fs::path("/dev/null")}) {
    EXPECT_THROW(require_regular_output(file), InputError) << file;
  }
}

TEST(OutputFile, HasNothingBesideItWhereItIsADeviceOrLeadsToAStandardStream) {
  const TemporaryFolder folder;
  fs::create_symlink("/dev/null", folder / "null");
  EXPECT_TRUE(may_have_files_beside(folder / "new"));
  EXPECT_TRUE(may_have_files_beside("new"));
  EXPECT_TRUE(may_have_files_beside("/dev/shm/new"));
  for (const fs::path& file :
       {folder / "null", fs::path("/dev/stdout"), fs::path("/dev/fd/1"), fs::path("/proc/self/fd/1")}) {
    EXPECT_FALSE(may_have_files_beside(file)) << file;
  }
}

TEST(OutputFile, IsWrittenWholeThroughALinkAndStraightToADevice) {
  const TemporaryFolder folder;
  (void)folder.write("a", "something longer");
  fs::create_symlink("a", folder / "link");
  write_output(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  std::ifstream in(folder / "a");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "new");
  write_output("/dev/null", "new");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT([] { write_output("/dev/full", "new", "--csv"); },
              testing::ThrowsMessage<InputError>(
                  EndsWith("--csv /dev/full: cannot be written: No space left on device")));
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Who holds the old file open, or sees it while the new one is written, has all of it.
TEST(ReplaceFile, KeepsTheOldFileUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("a", "old");
  std::ifstream held(file);
  replace_file(file, [&](const fs::path& made) {
    std::ofstream(made) << "new";
    EXPECT_NE(made, file);
    EXPECT_EQ(made.parent_path(), file.parent_path());  // one file system, so that rename() is atomic
    EXPECT_EQ(content(file), "old");
  });
  EXPECT_EQ(content(file), "new");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(held), {}), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(ReplaceFile, KeepsTheOldFileAndNothingElseWhenTheWriteFails) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("a", "old");
  const auto fail = [](const fs::path& made) {
    std::ofstream(made) << "half";
    throw InputError("full");
  };
  EXPECT_THAT([&] { replace_file(file, fail); }, testing::ThrowsMessage<InputError>("full"));
  EXPECT_EQ(content(file), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(ReplaceFile, ReplacesALinkAndNotWhatItLeadsTo) {
  const TemporaryFolder folder;
  const fs::path target = folder.write("target", "old");
  fs::create_symlink("target", folder / "link");
  replace_file(folder / "link", [](const fs::path& made) { std::ofstream(made) << "new"; });
  EXPECT_FALSE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content(folder / "link"), "new");
  EXPECT_EQ(content(target), "old");
}

TEST(ReplaceFile, NamesAFileThatCannotBeReplaced) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "a");
  (void)folder.write("a/inside", "");
  const auto write = [](const fs::path& made) { std::ofstream(made) << "new"; };
  EXPECT_THAT([&] { replace_file(folder / "a", write); },
              testing::ThrowsMessage<InputError>(HasSubstr("/a: cannot be written: ")));
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_THAT([&] { replace_file(folder / "none" / "a", write); },
              testing::ThrowsMessage<InputError>(HasSubstr("/none/a: cannot be written: ")));
}

}  // namespace
}  // namespace palpate

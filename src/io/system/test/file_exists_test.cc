#include "io/system/file_exists.h"

#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::StartsWith;
using testing::ThrowsMessage;

TEST(FileExists, TellsFilesFoldersFifosAndAbsentOnesApart) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("file", "1");
  fs::create_directory(folder / "empty");
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  fs::create_symlink("file", folder / "link");
  EXPECT_TRUE(file_exists(file) && file_exists(folder / "empty") && file_exists(folder / "fifo"));
  EXPECT_TRUE(regular_file_exists(file) && regular_file_exists(folder / "link"));
  EXPECT_FALSE(regular_file_exists(folder / "empty") || regular_file_exists(folder / "fifo"));
  EXPECT_TRUE(folder_exists(folder / "empty"));
  EXPECT_FALSE(folder_exists(file));
  for (const fs::path& absent : {folder / "absent", file / "below", folder / "absent" / "below"}) {
    EXPECT_FALSE(file_exists(absent) || regular_file_exists(absent) || folder_exists(absent)) << absent;
    EXPECT_TRUE(is_free_folder(absent)) << absent;
  }
  EXPECT_TRUE(is_free_folder(folder / "empty"));
  EXPECT_FALSE(is_free_folder(file) || is_free_folder(folder / "."));
}

// Errors that a privileged user gets, too.
TEST(FileExists, AnErrorIsNotAnAbsence) {
  const TemporaryFolder folder;
  fs::create_symlink("cycle", folder / "cycle");
  const fs::path cycle = folder / "cycle";
  const fs::path long_name = folder / std::string(300, 'a');
  const std::vector<std::function<bool(const fs::path&)>> looks = {file_exists, regular_file_exists,
                                                                   folder_exists, is_free_folder};
  for (const auto& look : looks) {
    EXPECT_THAT([&] { (void)look(cycle); },
                ThrowsMessage<InputError>(cycle.string() +
                                          ": cannot be looked at: Too many levels of symbolic links"));
    EXPECT_THAT([&] { (void)look(long_name); },
                ThrowsMessage<InputError>(long_name.string() + ": cannot be looked at: File name too long"));
  }
}

TEST(FileExists, ALinkThatLeadsToNothingIsAnErrorWhereAnAbsenceHasAMeaning) {
  const TemporaryFolder folder;
  const fs::path link = folder / "link";
  fs::create_symlink("nothing", link);
  EXPECT_FALSE(file_exists(link));
  EXPECT_THAT([&] { (void)file_or_link_exists(link); },
              ThrowsMessage<InputError>(link.string() +
                                        ": is a link that leads to nothing, must be a file or absent"));
  EXPECT_FALSE(file_or_link_exists(folder / "absent"));
  EXPECT_TRUE(file_or_link_exists(folder.write("nothing", "1")) && file_or_link_exists(link));
}

}  // namespace
}  // namespace palpate

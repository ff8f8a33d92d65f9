#include "io/system/input_file.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using testing::StartsWith;

constexpr InputKind kSmallInput{"a small file", 8};

std::string refusal_of(const std::filesystem::path& file) {
  try {
    (void)InputFile(file, kSmallInput).read_rest();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), StartsWith(file.string() + ": "));
    return std::string(error.what()).substr(file.string().size() + 2);
  }
  return "";
}

TEST(InputFile, ReadsARegularFileThroughALinkToItsEnd) {
  const TemporaryFolder folder;
  (void)folder.write("a", std::string("12\0\n5678", 8));
  std::filesystem::create_symlink("a", folder / "link");
  InputFile file(folder / "link", kSmallInput);
  EXPECT_EQ(file.size(), 8U);
  char first = 0;
  EXPECT_EQ(file.read({&first, 1}), 1U);
  EXPECT_EQ(first, '1');
  EXPECT_EQ(file.read_rest(), std::string("2\0\n5678", 7));
  EXPECT_EQ(file.read_rest(), "");
}

TEST(InputFile, RefusesFifosDevicesSocketsAndFoldersWithoutWaiting) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (folder / "socket").string().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(refusal_of(folder / "fifo"), "is a FIFO, must be a small file");
  EXPECT_EQ(refusal_of("/dev/zero"), "is a device, must be a small file");
  EXPECT_EQ(refusal_of(folder / "socket"), "is a socket or a device, must be a small file");
  EXPECT_EQ(refusal_of(folder.path()), "is a folder, must be a small file");
  close(socket);
}

TEST(InputFile, RefusesWhatIsLargerThanItsKind) {
  const TemporaryFolder folder;
  (void)folder.write("a", "123456789");
  EXPECT_EQ(refusal_of(folder / "a"), "has 9 bytes, must be a small file of at most 8 bytes");
  std::filesystem::resize_file(folder / "a", std::uintmax_t{2} << 30);
  EXPECT_EQ(refusal_of(folder / "a"), "has 2048 MiB, must be a small file of at most 8 bytes");
}

TEST(InputFile, RefusesWhatGrowsBeyondItsKindWhileItIsRead) {
  const TemporaryFolder folder;
  InputFile file(folder.write("a", "1234"), kSmallInput);
  (void)folder.write("a", "123456789");
  EXPECT_THROW((void)file.read_rest(), InputError);
}

TEST(InputFile, ReportsAMissingFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(folder / "none"), "there is no such file");
  (void)folder.write("a", "");
  EXPECT_EQ(refusal_of(folder / "a" / "b"), "there is no such file");
}

}  // namespace
}  // namespace palpate

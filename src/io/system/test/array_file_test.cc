#include "io/system/array_file.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "io/system/test/temporary_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

const ContentHash kKey{{1, 2}};

std::vector<double> numbers() {
  std::vector<double> values(1000);
  std::iota(values.begin(), values.end(), 0.5);
  return values;
}

const std::vector<Vec3> kPoints{{1, 2, 3}, {4, 5, 6}};

fs::path written(const TemporaryFolder& folder) {
  ArrayFileWriter writer(folder / "arrays", kKey);
  writer.put("numbers", numbers());
  writer.put("points", kPoints);
  writer.put("nothing", std::vector<std::int32_t>{});
  EXPECT_TRUE(writer.commit());
  return folder / "arrays";
}

/// Whether the file reads back exactly as written; any other file must be rejected.
bool whole(const fs::path& file) {
  const auto reader = ArrayFileReader::open(file, kKey);
  if (!reader) return false;
  const auto read_numbers = reader->get<double>("numbers");
  const auto points = reader->get<Vec3>("points");
  const auto nothing = reader->get<std::int32_t>("nothing");
  if (!read_numbers || !points || !nothing) return false;
  EXPECT_EQ(*read_numbers, numbers());
  EXPECT_EQ(*points, kPoints);
  EXPECT_TRUE(nothing->empty());
  return true;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ArrayFile, GivesBackWhatWasPutIn) {
  const TemporaryFolder folder;
  EXPECT_TRUE(whole(written(folder)));
  EXPECT_EQ(folder.entries(), 1U);  // the temporary file is removed
}

TEST(ArrayFile, IsRefusedUnderAnotherKeyNameOrElementSize) {
  const TemporaryFolder folder;
  const fs::path file = written(folder);
  EXPECT_FALSE(ArrayFileReader::open(file, ContentHash{{1, 3}}));
  const auto reader = ArrayFileReader::open(file, kKey);
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->get<double>("number"));
  EXPECT_FALSE(reader->get<float>("numbers"));
}

TEST(ArrayFile, IsRefusedWhenAnyByteIsChanged) {
  const TemporaryFolder folder;
  const std::string good = bytes_of(written(folder));
  std::mt19937 random(1);
  int refused = 0;
  for (std::size_t i = 0; i < good.size(); i += i < 128 || i + 256 > good.size() ? 1 : 61) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ static_cast<char>(1U << (random() % 8U)));
    // Only a flip in the padding between arrays may stay undetected; the values are then unchanged.
    refused += whole(folder.write("bad", bad)) ? 0 : 1;
  }
  EXPECT_GT(refused, 400);
  EXPECT_TRUE(whole(folder.write("bad", good)));
}

TEST(ArrayFile, IsRefusedWhenItIsShorterOrLonger) {
  const TemporaryFolder folder;
  const std::string good = bytes_of(written(folder));
  for (std::size_t size = 0; size < good.size(); size += size < 300 ? 1 : 97) {
    EXPECT_FALSE(whole(folder.write("bad", good.substr(0, size)))) << size;
  }
  EXPECT_FALSE(whole(folder.write("bad", good + '\0')));
  EXPECT_FALSE(whole(folder.write("bad", std::string(10'000, '\0'))));
  EXPECT_FALSE(whole(folder / "absent"));
  EXPECT_FALSE(whole(folder.path()));
}

TEST(ArrayFile, WithoutCommitLeavesNothing) {
  const TemporaryFolder folder;
  {
    ArrayFileWriter writer(folder / "arrays", kKey);
    writer.put("numbers", numbers());
  }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(ArrayFile, ReplacesAnOlderOneWhole) {
  const TemporaryFolder folder;
  (void)folder.write("arrays", "something else");
  EXPECT_TRUE(whole(written(folder)));
}

TEST(ArrayFile, InAFolderThatIsNotThereIsNotWritten) {
  const TemporaryFolder folder;
  ArrayFileWriter writer(folder.path() / "absent" / "arrays", kKey);
  writer.put("numbers", numbers());
  EXPECT_FALSE(writer.commit());
}

TEST(ArrayFile, ThatDoesNotFitOnTheDiskIsNotWritten) {
  const TemporaryFolder folder;
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, usual.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  {
    ArrayFileWriter writer(folder / "arrays", kKey);
    writer.put("numbers", numbers());
    EXPECT_FALSE(writer.commit());
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &usual), 0);
  static_cast<void>(std::signal(SIGXFSZ, old_handler));
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(ArrayFile, RefusesANameThatIsTooLongOrEmpty) {
  const TemporaryFolder folder;
  for (const std::string& name : {std::string(), std::string(32, 'x')}) {
    ArrayFileWriter writer(folder / "arrays", kKey);
    writer.put(name, numbers());
    EXPECT_FALSE(writer.commit());
  }
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace palpate

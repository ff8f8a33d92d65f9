#include "core/base/fetch_list.h"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct alignas(64) Lines {
  std::array<std::uint8_t, 256> bytes{};
};

TEST(FetchList, HasEveryLineThatAPieceOfMemoryLiesInOnce) {
  const Lines lines;
  FetchList list;
  list.add(&lines.bytes[60], &lines.bytes[129]);
  ASSERT_EQ(list.lines().size(), 3U);
  EXPECT_EQ(list.lines()[0], &lines.bytes[0]);
  EXPECT_EQ(list.lines()[1], &lines.bytes[64]);
  EXPECT_EQ(list.lines()[2], &lines.bytes[128]);
}

TEST(FetchList, HasNoLineOfAnEmptyPiece) {
  FetchList list;
  list.add_elements(std::vector<double>());
  EXPECT_TRUE(list.lines().empty());
}

TEST(FetchList, HasAllLinesOfAnObjectAndNoMore) {
  const Lines lines;
  FetchList list;
  list.add(lines);
  EXPECT_EQ(list.lines().size(), 4U);
  list.fetch();
  EXPECT_EQ(lines.bytes, Lines().bytes);
}

}  // namespace
}  // namespace palpate

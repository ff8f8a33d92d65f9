#include "core/base/content_hash.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::string hash_of(const std::vector<std::string>& pieces) {
  ContentHasher hasher;
  for (const std::string& piece : pieces) hasher.add(std::span<const char>(piece));
  return hasher.hash().hexadecimal();
}

TEST(ContentHash, IsTheSameOnEveryRunAndMachine) {
  EXPECT_EQ(hash_of({}), "3c7f38e3422e8c4e398f535184abb626");
  EXPECT_EQ(hash_of({"gallbladder"}), "faf565a2c9b17421b958b5c34bc984c6");
}

TEST(ContentHash, OfPiecesKnowsWhereTheyEnd) {
  const std::set<std::string> hashes = {
      hash_of({"abc"}),     hash_of({"ab", "c"}), hash_of({"a", "bc"}), hash_of({"abc", ""}),
      hash_of({"", "abc"}), hash_of({}),          hash_of({""}),        hash_of({std::string("abc\0", 4)})};
  EXPECT_EQ(hashes.size(), 8U);
}

TEST(ContentHash, ChangesWithEveryBitInBothWords) {
  std::vector<std::uint64_t> values(33, 0);
  const ContentHash plain = ContentHasher().add(std::span<const std::uint64_t>(values)).hash();
  std::set<std::uint64_t> first{plain.words[0]};
  std::set<std::uint64_t> second{plain.words[1]};
  for (std::uint64_t& value : values) {
    for (int bit = 0; bit < 64; ++bit) {
      value = std::uint64_t{1} << bit;
      const ContentHash hash = ContentHasher().add(std::span<const std::uint64_t>(values)).hash();
      first.insert(hash.words[0]);
      second.insert(hash.words[1]);
    }
    value = 0;
  }
  EXPECT_EQ(first.size(), 33U * 64U + 1U);
  EXPECT_EQ(second.size(), 33U * 64U + 1U);
}

}  // namespace
}  // namespace palpate

#include "io/system/base64.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, section 10
  const std::pair<std::string, std::string> known[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"foobar", "Zm9vYmFy"},
                                                       {"\xff\xfe", "//4="}};
  for (const auto& [bytes, text] : known) {
    EXPECT_EQ(base64(bytes), text);
    EXPECT_EQ(base64_decoded(text), bytes);
  }
}

TEST(Base64, IsDecodedUpToACharacterThatIsNoDigitOfIt) { EXPECT_EQ(base64_decoded("Zm9v-Zm9v"), "foo"); }

}  // namespace
}  // namespace palpate

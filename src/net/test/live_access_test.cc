#include "net/live_access.h"

#include <cctype>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "io/system/test/temporary_folder.h"
#include "io/websocket/connection.h"
#include "palpate/error.h"

namespace palpate::net {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(LiveAccess, OnlyTheWholeTokenIsTheToken) {
  const std::string token = "0123456789abcdef";
  EXPECT_TRUE(same_token(token, "0123456789abcdef"));
  for (const char* wrong : {"", "0", "0123456789abcde", "0123456789abcdeF", "0123456789abcdef0",
                            "0123456789abcdef0123456789abcdef", "1123456789abcdef"}) {
    EXPECT_FALSE(same_token(token, wrong)) << wrong;
  }
  EXPECT_FALSE(same_token("", "a"));
}

TEST(LiveAccess, NewTokensAreLongAndNeverTheSame) {
  const std::string token = new_token();
  EXPECT_EQ(token.size(), 64U);
  for (const char c : token) EXPECT_TRUE(std::isxdigit(static_cast<unsigned char>(c))) << token;
  EXPECT_NE(token, new_token());
}

class TokenFile : public testing::Test {
 protected:
  std::string write(const std::string& text, mode_t mode = 0600) {
    const std::string file = (folder_.path() / "token").string();
    std::ofstream(file) << text;
    chmod(file.c_str(), mode);
    return file;
  }
  palpate::test::TemporaryFolder folder_;
};

TEST_F(TokenFile, ItsFirstLineIsTheToken) {
  EXPECT_EQ(read_token_file(write("a-token-of-length-24!!!!\r\nmore\n")), "a-token-of-length-24!!!!");
}

TEST_F(TokenFile, OneThatOthersMayReadIsRefused) {
  const std::string file = write("0123456789abcdef\n", 0640);
  EXPECT_THAT([&] { (void)read_token_file(file); }, ThrowsMessage<InputError>(HasSubstr("chmod 600")));
}

TEST_F(TokenFile, AShortEmptyOrUnprintableTokenIsRefused) {
  for (const char* text : {"", "\n", "short\n", "0123456789 abcdef\n", "0123456789abcde\x01\n"}) {
    const std::string file = write(text);
    EXPECT_THAT([&] { (void)read_token_file(file); }, ThrowsMessage<InputError>(HasSubstr("--token-file")));
  }
  EXPECT_THROW((void)read_token_file(folder_.path() / "none"), InputError);
  EXPECT_THROW((void)read_token_file(folder_.path()), InputError);
}

TEST(LiveAccess, AnOriginIsASchemeAHostAndAPort) {
  for (const char* good : {"http://localhost:8000", "https://example.org", "http://[::1]:80"}) {
    EXPECT_NO_THROW(check_origin(good)) << good;
  }
  for (const char* bad :
       {"", "*", "null", "localhost:8000", "http://", "http://a/", "http://a b", "ws://a"}) {
    EXPECT_THROW(check_origin(bad), InputError) << bad;
  }
}

TEST(LiveAccess, OnlyTheServersOwnPageAndThoseAllowedMayConnect) {
  const std::vector<std::string> allowed{"http://lab.example:8000"};
  const auto may = [&](const char* origin, bool loopback = true) {
    return origin_allowed(origin, "127.0.0.1", 7370, loopback, allowed);
  };
  EXPECT_TRUE(may("http://127.0.0.1:7370"));
  EXPECT_TRUE(may("http://localhost:7370"));
  EXPECT_TRUE(may("http://lab.example:8000"));
  EXPECT_FALSE(may("http://localhost:7370", false)) << "that is another machine";
  // A foreign host name may resolve to this machine, and its pages must be refused. The server also refuses
  // sandboxed pages and files, whose origin is "null".
  for (const char* foreign :
       {"http://evil.example:7370", "null", "", "http://127.0.0.1:7371", "https://127.0.0.1:7370",
        "http://127.0.0.1:73700", "http://127.0.0.1", "http://localhost:7370.evil.example"}) {
    EXPECT_FALSE(may(foreign)) << foreign;
  }
  EXPECT_TRUE(origin_allowed("http://127.0.0.1", "127.0.0.1", 80, true, {})) << "80 is left out by browsers";
}

TEST(RateLimit, LetsABurstThroughAndThenSoManyASecond) {
  websocket::RateLimit limit(10.0, 3.0);
  std::int64_t now = 1'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(limit.allows(now));
  EXPECT_FALSE(limit.allows(now));
  EXPECT_FALSE(limit.allows(now += 90'000'000)) << "a tenth of a second has not passed";
  EXPECT_TRUE(limit.allows(now += 20'000'000));
  EXPECT_FALSE(limit.allows(now));
  now += 3'600'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(limit.allows(now)) << "an hour does not add up beyond the burst";
  EXPECT_FALSE(limit.allows(now));
}

}  // namespace
}  // namespace palpate::net

#include "io/igtl/igtl_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::net {
namespace {

using testing::HasSubstr;

TEST(IgtlAddress, APortAloneIsThisMachinesAndAnAddressMayStandBeforeIt) {
  EXPECT_EQ(parse_igtl_address("18944").host, "127.0.0.1");
  EXPECT_EQ(parse_igtl_address("18944").port, 18944);
  EXPECT_EQ(parse_igtl_address("0.0.0.0:1").host, "0.0.0.0");
  EXPECT_EQ(parse_igtl_address("0.0.0.0:65535").port, 65535);
}

TEST(IgtlAddress, WhatIsNoPortIsRefusedWithWhatWouldBeRight) {
  for (const char* wrong : {"", "0", "65536", "-1", "+80", "80 ", "8e3", "99999999999", ":80", "localhost:80",
                            "1.2.3:80", "1.2.3.4:", "1.2.3.4:0", "[::1]:80"}) {
    try {
      (void)parse_igtl_address(wrong);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr(std::string("--igtl ") + wrong + ": must be a port from 1 to 65535"));
    }
  }
}

}  // namespace
}  // namespace palpate::net

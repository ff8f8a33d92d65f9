#include "run/ros/ros_node.h"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "palpate/error.h"

namespace palpate::ros {
namespace {

/// An environment variable during its lifetime.
class Variable final {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

std::string refused_options(const std::string& network_interface = {}) {
  try {
    (void)options_of_environment(network_interface);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(RosOptions, TheDomainIsThatOfTheEnvironment) {
  EXPECT_EQ(options_of_environment().domain, 0u);
  const Variable domain("ROS_DOMAIN_ID", "232");
  EXPECT_EQ(options_of_environment().domain, 232u);
}

TEST(RosOptions, ADomainWithoutPortsIsRefused) {
  for (const char* value : {"233", "-1", "1x", "x", " 1", "4294967296", "0x1"}) {
    const Variable domain("ROS_DOMAIN_ID", value);
    EXPECT_EQ(refused_options(),
              std::string("ROS_DOMAIN_ID = \"") + value + "\": must be a whole number from 0 to 232");
  }
}

TEST(RosOptions, AnInterfaceIsANameOrAnAddress) {
  for (const char* name : {"eth0", "wlp3s0", "192.168.1.5", "fd00::2", "br-lan.7", "veth0@if2"}) {
    EXPECT_EQ(options_of_environment(name).network_interface, name);
  }
  for (const std::string& name : {std::string("eth0\"/><x"), std::string("a b"), std::string(65, 'a')}) {
    EXPECT_NE(refused_options(name).find("--network-interface"), std::string::npos) << name;
  }
}

TEST(RosOptions, AnInterfaceBesideAConfigurationIsRefused) {
  const Variable uri("CYCLONEDDS_URI", "<CycloneDDS/>");
  EXPECT_EQ(options_of_environment().cyclonedds_uri, "<CycloneDDS/>");
  EXPECT_EQ(refused_options("eth0"),
            "--network-interface eth0: CYCLONEDDS_URI is set, too; leave one of them out");
}

TEST(RosTopicName, IsWhatRos2Allows) {
  for (const char* name : {"/a", "/palpate/hand0/target_pose", "/_a/B9"}) {
    EXPECT_NO_THROW(require_topic_name(name, "device ros:")) << name;
  }
  for (const std::string& name :
       {std::string(), std::string("/"), std::string("a"), std::string("/a/"), std::string("/a//b"),
        std::string("/9"), std::string("/a b"), std::string("/a-b"), "/" + std::string(255, 'a'),
        std::string("/a\0b", 4)}) {
    EXPECT_THROW(require_topic_name(name, "device ros:"), InputError) << name;
  }
}

}  // namespace
}  // namespace palpate::ros

// The device "igtl" with clients that use the OpenIGTLink library. No result depends on the machine's speed.
#include "run/devices/igtl.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/clock.h"
#include "net/test/igtl_received.h"
#include "palpate/error.h"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;
using haptics::Fault;
using net::test::Client;
using net::test::Received;
using testing::HasSubstr;

int free_igtl_port() { return net::port_of(net::listen_at({"127.0.0.1", 0})); }

/// Connects when the device listens.
std::unique_ptr<Client> client_at(int port) {
  for (int i = 0; i < 2000; ++i) {
    try {
      return std::make_unique<Client>(port);
    } catch (const std::runtime_error&) {
      std::this_thread::sleep_for(10ms);
    }
  }
  throw std::runtime_error("the device does not listen");
}

net::Bytes pose_message(const std::string& name, double x = 0.0, const Quat& rotation = Quat::Identity()) {
  net::IgtlMessages messages(unix_ns());
  messages.add_transform(name, {rotation, Vec3(x, 0.02, 0.03)});
  return messages.bytes();
}

/// A number of N bytes, the highest first.
template <typename Number>
void append_number(net::Bytes& bytes, Number number) {
  for (std::size_t left = sizeof number; left > 0; --left) {
    bytes.push_back(static_cast<unsigned char>(std::uint64_t{number} >> (8 * (left - 1))));
  }
}

/// The pose as a message of protocol version 2 whose metadata gives a status, as a tracker's server sends it.
net::Bytes pose_with_status(const std::string& name, const std::string& value) {
  constexpr std::size_t kHead = 58;
  const std::string key = "TransformStatus";
  net::Bytes bytes = pose_message(name);
  net::Bytes body;
  append_number(body, std::uint16_t{12});
  append_number(body, std::uint16_t{10});
  append_number(body, static_cast<std::uint32_t>(key.size() + value.size()));
  append_number(body, std::uint32_t{1});
  body.insert(body.end(), bytes.begin() + kHead, bytes.end());
  append_number(body, std::uint16_t{1});
  append_number(body, static_cast<std::uint16_t>(key.size()));
  append_number(body, std::uint16_t{3});
  append_number(body, static_cast<std::uint32_t>(value.size()));
  body.insert(body.end(), key.begin(), key.end());
  body.insert(body.end(), value.begin(), value.end());
  net::Bytes sizes;
  append_number(sizes, std::uint64_t{body.size()});
  append_number(sizes, net::igtl_checksum(body));
  bytes.resize(kHead);
  bytes[1] = 2;
  std::copy(sizes.begin(), sizes.end(), bytes.begin() + 42);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// A client that sends one message again and again, 100 times a second.
class Sender final {
 public:
  Sender(int port, net::Bytes message)
      : message_(std::move(message)), thread_([this, port] { send(port); }) {}
  ~Sender() { end(); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  void end() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void pause() { paused_ = true; }

 private:
  void send(int port) {
    const std::unique_ptr<Client> client = client_at(port);
    while (!ending_) {
      if (!paused_) client->send(message_);
      std::this_thread::sleep_for(10ms);
    }
  }

  net::Bytes message_;
  std::atomic<bool> ending_{false};
  std::atomic<bool> paused_{false};
  std::thread thread_;
};

std::string source_at(int port, const std::string& name = "Hand") {
  return std::to_string(port) + "/" + name;
}

/// Whether a sample like this comes within 20 s.
bool comes(IgtlDevice& device, const std::function<bool(const haptics::DeviceState&)>& wanted) {
  for (int i = 0; i < 20'000; ++i) {
    if (wanted(device.read(0, 0.0))) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

bool is_usable(const haptics::DeviceState& sample) {
  return sample.fault == Fault::kNone && sample.age == 0.0;
}

std::string opening_refusal(const std::string& source, const IgtlTimes& times = {}) {
  try {
    const IgtlDevice device(source, times);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(IgtlSource, IsAPortAndANameAndMayHaveAnAddress) {
  EXPECT_EQ(parse_igtl_source("18945/Hand").address.text(), "127.0.0.1:18945");
  EXPECT_EQ(parse_igtl_source("18945/Hand").name, "Hand");
  EXPECT_EQ(parse_igtl_source("0.0.0.0:1/a/b").address.text(), "0.0.0.0:1");
  EXPECT_EQ(parse_igtl_source("0.0.0.0:1/a/b").name, "a/b");
  EXPECT_EQ(parse_igtl_source("1/StylusTipToReference").name, "StylusTipToReference") << "20 characters";
}

TEST(IgtlSource, OtherFormsAreRefusedWithTheRequiredOne) {
  for (const char* wrong : {"", "18945", "Hand"}) {
    EXPECT_THAT(opening_refusal(wrong), HasSubstr("must be PORT/NAME or ADDRESS:PORT/NAME")) << wrong;
  }
  EXPECT_THAT(opening_refusal("0/Hand"), HasSubstr("device igtl: 0: must be a port from 1 to 65535"));
  EXPECT_THAT(opening_refusal("localhost:80/Hand"), HasSubstr("must be a port from 1 to 65535"));
  for (const char* wrong : {"1/", "1/StylusTipToReferences", "1/a b", "1/\xc3\xa4"}) {
    EXPECT_THAT(opening_refusal(wrong), HasSubstr("must have 1 to 20 printable ASCII characters")) << wrong;
  }
}

TEST(IgtlDevice, APortThatIsTakenIsRefused) {
  const net::Socket other = net::listen_at({"127.0.0.1", 0});
  EXPECT_THAT(opening_refusal(source_at(net::port_of(other))),
              HasSubstr("the port is taken by another program"));
}

TEST(IgtlDevice, WithoutAClientNoRunBegins) {
  EXPECT_THAT(opening_refusal(source_at(free_igtl_port()), {.opening = 20'000'000}),
              testing::MatchesRegex("device igtl: no client sent poses as TRANSFORM Hand to 127.0.0.1:[0-9]+ "
                                    "within 0.02 s: none has connected"));
}

TEST(IgtlDevice, TheNamesThatAClientSendsInsteadAreListed) {
  const int port = free_igtl_port();
  const Sender sender(port, pose_message("Stylus"));
  EXPECT_THAT(opening_refusal(source_at(port), {.opening = 1'500'000'000}), HasSubstr(": it sends Stylus"));
}

TEST(IgtlDevice, ItsSamplesAreTheClientsPosesInMetres) {
  const int port = free_igtl_port();
  const Sender sender(port, pose_message("Hand", 0.01));
  IgtlDevice device(source_at(port));
  haptics::DeviceState sample;
  ASSERT_TRUE(comes(device, [&](const haptics::DeviceState& now) {
    sample = now;
    return is_usable(now);
  }));
  EXPECT_LT((sample.position_D - Vec3(0.01, 0.02, 0.03)).norm(), 1e-8) << "single precision";
  EXPECT_EQ(device.description(), "TRANSFORM Hand at 127.0.0.1:" + std::to_string(port));
}

TEST(IgtlDevice, SendsTheForceAsSensorAndTransformAndZeroAfterAStop) {
  const int port = free_igtl_port();
  std::unique_ptr<Client> client;
  std::atomic<bool> ending{false};
  std::thread sending([&] {
    client = client_at(port);
    while (!ending) {
      client->send(pose_message("Hand"));
      std::this_thread::sleep_for(10ms);
    }
  });
  std::vector<double> force;
  std::vector<double> torque;
  std::array<float, 3> moved{};
  {
    IgtlDevice device(source_at(port));
    const Vec3 wanted(0.5, -1.0 / 3.0, 2.0);
    ASSERT_TRUE(comes(device, [&](const haptics::DeviceState&) {
      EXPECT_TRUE(device.write({wanted, Vec3(0.0, 0.01, 0.0), 0.0}));
      force = client->next("SENSOR", IgtlDevice::kForceName).values();
      return force == std::vector<double>{0.5, -1.0 / 3.0, 2.0};
    }));
    torque = client->next("SENSOR", IgtlDevice::kTorqueName).values();
    ASSERT_TRUE(comes(device, [&](const haptics::DeviceState&) {
      EXPECT_TRUE(device.write({wanted, Vec3::Zero(), 0.0}));
      moved = client->next("TRANSFORM", IgtlDevice::kForceName).position();
      return moved[2] == 2.0F;
    }));
    EXPECT_FALSE(device.write({Vec3(std::nan(""), 0, 0), Vec3::Zero(), 0.0}));
    EXPECT_TRUE(device.write({wanted, Vec3::Zero(), 0.0}));
    device.stop();
    EXPECT_TRUE(comes(device, [&](const haptics::DeviceState&) {
      return client->next("SENSOR", IgtlDevice::kForceName).values() == std::vector<double>{0, 0, 0};
    }));
  }
  EXPECT_EQ(moved[0], 0.5F) << "1 mm for 1 N";
  EXPECT_EQ(torque.size(), 3u);
  ending = true;
  sending.join();
}

TEST(IgtlDevice, ALoopThatNoLongerWritesAndTheEndSendZeroForce) {
  const int port = free_igtl_port();
  auto sender = std::make_unique<Sender>(port, pose_message("Hand"));
  auto device = std::make_unique<IgtlDevice>(source_at(port));
  sender.reset();
  ASSERT_TRUE(comes(*device, [](const haptics::DeviceState& now) { return now.fault == Fault::kDevice; }));
  const std::unique_ptr<Client> client = client_at(port);
  const auto write_until_it_is_sent = [&] {
    return comes(*device, [&](const haptics::DeviceState&) {
      EXPECT_TRUE(device->write({Vec3(1, 0, 0), Vec3::Zero(), 0.0}));
      return client->next("SENSOR", IgtlDevice::kForceName).values()[0] == 1.0;
    });
  };
  ASSERT_TRUE(write_until_it_is_sent());
  while (client->next("SENSOR", IgtlDevice::kForceName).values()[0] != 0.0) continue;
  ASSERT_TRUE(write_until_it_is_sent());
  device.reset();
  std::vector<double> last;
  while (const std::optional<Received> received = client->next()) {
    if (received->type == "SENSOR" && received->name == IgtlDevice::kForceName) last = received->values();
  }
  EXPECT_EQ(last, (std::vector<double>{0, 0, 0}));
}

TEST(IgtlDevice, ASecondClientIsRefusedWhileTheFirstSends) {
  const int port = free_igtl_port();
  const Sender first(port, pose_message("Hand", 0.01));
  IgtlDevice device(source_at(port), {.replaced = 60'000'000'000});
  Client second(port);
  second.send(pose_message("Hand", 0.09));
  EXPECT_FALSE(second.next()) << "closed";
  const haptics::DeviceState sample = device.read(0, 0.0);
  EXPECT_NEAR(sample.position_D.x(), 0.01, 1e-8);
}

TEST(IgtlDevice, AClientThatSendsNothingIsReplacedByTheNext) {
  const int port = free_igtl_port();
  Sender first(port, pose_message("Hand", 0.01));
  IgtlDevice device(source_at(port), {.replaced = 50'000'000});
  first.pause();
  ASSERT_TRUE(comes(device, [](const haptics::DeviceState& now) { return now.age > haptics::kStaleAfter; }));
  EXPECT_THAT(device.last_error(), HasSubstr("no TRANSFORM Hand came for"));
  const Sender second(port, pose_message("Hand", 0.09));
  EXPECT_TRUE(comes(device, [](const haptics::DeviceState& now) {
    return is_usable(now) && std::abs(now.position_D.x() - 0.09) < 1e-8;
  }));
}

TEST(IgtlDevice, PosesThatTheTrackerCallsInvalidAreStaleAsSilenceIsUntilItSaysOk) {
  for (const char* status : {"INVALID", "MISSING"}) {
    const int port = free_igtl_port();
    std::unique_ptr<Client> client;
    std::atomic<bool> valid{true};
    std::atomic<bool> ending{false};
    std::thread sending([&] {
      client = client_at(port);
      while (!ending) {
        client->send(pose_with_status("Hand", valid ? "OK" : status));
        std::this_thread::sleep_for(10ms);
      }
    });
    {
      IgtlDevice device(source_at(port));
      ASSERT_TRUE(comes(device, is_usable));
      valid = false;
      EXPECT_TRUE(comes(device, [](const haptics::DeviceState& now) {
        return now.fault == Fault::kNone && now.age > 0.1;
      }));
      EXPECT_THAT(device.last_error(), HasSubstr(std::string("its TransformStatus is ") + status));
      valid = true;
      EXPECT_TRUE(comes(device, is_usable));
      ending = true;
      sending.join();
    }
  }
}

TEST(IgtlDevice, NoRunBeginsWithPosesThatTheTrackerCallsInvalid) {
  const int port = free_igtl_port();
  const Sender sender(port, pose_with_status("Hand", "INVALID"));
  EXPECT_THAT(opening_refusal(source_at(port), {.opening = 1'000'000'000}),
              HasSubstr("its TransformStatus is INVALID"));
}

struct Trouble {
  const char* what;
  net::Bytes bytes;
  const char* words;
};

TEST(IgtlDevice, WhateverEndsAStreamIsAFaultWithItsCauseAndTheNextClientIsUsed) {
  for (const Trouble& last_error :
       {Trouble{"garbage", net::Bytes(5000, 0xa5), "no OpenIGTLink message of version 1 to 3"},
        Trouble{"scaled", pose_message("Hand", 0.0, Quat(0.0, 2.0, 0.0, 0.0)),
                "its matrix is not finite, or scales, shears or mirrors"},
        Trouble{"jump", pose_message("Hand", 0.3), "the pose jumped by 300 mm"},
        Trouble{"far", pose_message("Hand", 6.0), "6 m from the origin"},
        Trouble{"closed", {}, "the client closed the connection"}}) {
    const int port = free_igtl_port();
    std::unique_ptr<Client> client;
    std::atomic<bool> ready{false};
    std::thread sending([&] {
      client = client_at(port);
      while (!ready) {
        client->send(pose_message("Hand"));
        std::this_thread::sleep_for(10ms);
      }
    });
    IgtlDevice device(source_at(port));
    ready = true;
    sending.join();
    if (last_error.bytes.empty()) {
      client.reset();
    } else {
      client->send(pose_message("Hand"));
      client->send(last_error.bytes);
    }
    EXPECT_TRUE(comes(device,
                      [&](const haptics::DeviceState& now) {
                        return now.fault == Fault::kDevice &&
                               device.last_error().find(last_error.words) != std::string::npos;
                      }))
        << last_error.what << ": " << device.last_error();
    client.reset();
    const Sender next(port, pose_message("Hand", 0.05));
    EXPECT_TRUE(comes(device, is_usable)) << last_error.what;
  }
}

TEST(IgtlDevice, SlicersConnectorGetsNoSensor) {
  const int port = free_igtl_port();
  auto sender = std::make_unique<Sender>(port, pose_message("Hand"));
  IgtlDevice device(source_at(port));
  sender.reset();
  ASSERT_TRUE(comes(device, [](const haptics::DeviceState& now) { return now.fault == Fault::kDevice; }));
  Client slicer(port);
  igtl::StatusMessage::Pointer first = igtl::StatusMessage::New();
  first->Pack();
  const auto* bytes = static_cast<const unsigned char*>(first->GetPackPointer());
  slicer.send({bytes, static_cast<std::size_t>(first->GetPackSize())});
  // Until its first message has come, it is a client as any other: SENSOR messages follow each TRANSFORM.
  for (int transforms = 0; transforms < 2;)
    transforms = slicer.next()->type == "TRANSFORM" ? transforms + 1 : 0;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(slicer.next()->type, "TRANSFORM");
}

}  // namespace
}  // namespace palpate::devices

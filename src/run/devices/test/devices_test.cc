#include "run/devices/devices.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/scripted_device.h"
#include "run/devices/replay.h"

namespace palpate::devices {
namespace {

using testing::HasSubstr;

scene::PathRow row(double time, const Vec3& position, double gripper) {
  scene::PathRow r;
  r.time = time;
  r.position = position;
  r.gripper = gripper;
  return r;
}

haptics::TickRow recorded(std::uint64_t tick, std::uint32_t hand, double x) {
  haptics::TickRow r;
  r.tick = tick;
  r.hand = hand;
  r.device = {x, 2.0, 3.0};
  r.device_q = {0.5, 0.5, -0.5, 0.5};
  r.device_velocity = {0.1, 0.2, 0.3};
  r.device_gripper = 0.25;
  r.buttons = 5;
  r.device_fault = tick == 1 ? 2 : 0;
  return r;
}

TEST(ScriptedDevice, SamplesItsPathAtTheTicksTime) {
  ScriptedDevice device(scene::ToolPath({row(0.0, {0.0, 0.0, 0.0}, 1.0), row(2.0, {0.0, 4.0, 0.0}, 0.0)}));
  const haptics::DeviceState state = device.read(12345, 0.5);
  EXPECT_EQ(state.position_D, Vec3(0.0, 1.0, 0.0));
  EXPECT_EQ(state.velocity_D, Vec3(0.0, 2.0, 0.0));
  EXPECT_EQ(state.gripper, 0.75);
  EXPECT_EQ(state.buttons, 0U);
  EXPECT_EQ(state.fault, haptics::Fault::kNone);
  EXPECT_EQ(device.read(1, 9.0).position_D, Vec3(0.0, 4.0, 0.0));
}

TEST(ScriptedDevice, EndsHalfASecondAfterThePathsLastRow) {
  const ScriptedDevice device(scene::ToolPath({row(0.0, Vec3::Zero(), 0.0), row(1.2, Vec3::Zero(), 0.0)}));
  EXPECT_EQ(device.last_tick(1000.0), 1700U);
  EXPECT_EQ(device.last_tick(4000.0), 6800U);
  const ScriptedDevice early(scene::ToolPath({row(-2.0, Vec3::Zero(), 0.0)}));
  EXPECT_EQ(early.last_tick(1000.0), 0U);
  const ScriptedDevice endless(scene::ToolPath({row(1e300, Vec3::Zero(), 0.0)}));
  EXPECT_EQ(endless.last_tick(1000.0), ~std::uint64_t{0});
}

TEST(ScriptedDevice, TakesForcesAndStopsAsOftenAsAsked) {
  ScriptedDevice device(scene::ToolPath({row(0.0, {1.0, 0.0, 0.0}, 0.0)}));
  EXPECT_TRUE(device.write({{1.0, 2.0, std::nan("")}, Vec3::Zero(), 0.0}));
  device.stop();
  device.stop();
  EXPECT_TRUE(device.write({}));
  EXPECT_EQ(device.read(0, 0.0).position_D.x(), 1.0);
}

TEST(ReplayDevice, GivesTheSamplesOfItsHandAndHoldsTheLast) {
  const std::vector<haptics::TickRow> rows = {recorded(0, 0, 10.0), recorded(0, 1, 20.0),
                                              recorded(1, 0, 11.0), recorded(1, 1, 21.0),
                                              recorded(2, 0, 12.0), recorded(2, 1, 22.0)};
  ReplayDevice device(samples_of_hand(rows, 1));
  EXPECT_EQ(device.last_tick(1000.0), 3U);
  const haptics::DeviceState first = device.read(0, 99.0);
  EXPECT_EQ(first.position_D, Vec3(20.0, 2.0, 3.0));
  EXPECT_EQ(first.orientation_D.w(), 0.5);
  EXPECT_EQ(first.orientation_D.x(), 0.5);
  EXPECT_EQ(first.orientation_D.y(), -0.5);
  EXPECT_EQ(first.orientation_D.z(), 0.5);
  EXPECT_EQ(first.velocity_D, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(first.gripper, 0.25);
  EXPECT_EQ(first.buttons, 5U);
  EXPECT_EQ(first.fault, haptics::Fault::kNone);
  EXPECT_EQ(device.read(1, 0.0).fault, haptics::Fault::kDevice);
  EXPECT_EQ(device.read(2, 0.0).position_D.x(), 22.0);
  EXPECT_EQ(device.read(1000, 0.0).position_D.x(), 22.0);
  EXPECT_TRUE(device.write({}));
  device.stop();
}

TEST(ReplayDevice, RefusesARecordingWithoutTicks) { EXPECT_THROW(ReplayDevice({}), InputError); }

/// A scene without meshes, for a device that follows a file.
scene::Scene bare_setup(const std::string& kind, const std::string& path) {
  scene::Scene scene;
  scene.devices.push_back({kind, path, 1.0, {}});
  return scene;
}

std::string error_of(const scene::Scene& scene, std::size_t hand) {
  try {
    (void)open_device(scene, hand);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

/// A file in the temporary folder that the test removes at its end.
class TemporaryFile final {
 public:
  TemporaryFile(const std::string& ending, const std::string& content)
      : path_(std::filesystem::temp_directory_path() /
              ("palpate_devices_" + std::to_string(getpid()) + ending)) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(OpenDevice, FollowsAPathFile) {
  const TemporaryFile file(".csv", "time_s,x_m,y_m,z_m\n0,1,2,3\n1,1,2,5\n");
  const auto device = open_device(bare_setup("scripted", file.name()), 0);
  EXPECT_EQ(device->read(500, 0.5).position_D, Vec3(1.0, 2.0, 4.0));
  EXPECT_EQ(device->last_tick(1000.0), 1500U);
}

TEST(OpenDevice, MakesItsOwnPathWhenNoneIsGiven) {
  const scene::Scene scene = scene::load({});
  const auto device = open_device(scene, 0);
  const scene::ToolPath path = scene::default_path(scene, 0);
  EXPECT_EQ(device->read(1000, 1.0).position_D, path.at(1.0).position);
  EXPECT_EQ(device->last_tick(1000.0),
            static_cast<std::uint64_t>(std::lround((path.end_time() + 0.5) * 1000.0)));
}

TEST(OpenDevice, RefusesAPullAlongAPathWithoutGripper) {
  const TemporaryFile file(".csv", "time_s,x_m,y_m,z_m\n0,1,2,3\n");
  scene::Scene scene = bare_setup("scripted", file.name());
  scene.task = scene::Task::kPull;
  EXPECT_THAT(error_of(scene, 0), HasSubstr(file.name() + ": gripper: missing"));
}

TEST(OpenDevice, RefusesUnknownKindsHandsAndFiles) {
  EXPECT_THAT(error_of(bare_setup("joystick", ""), 0),
              HasSubstr("device kind = \"joystick\": must be scripted, replay, emulated, mouse, gamepad, "
                        "forcedimension, haply, touch, igtl or ros"));
  EXPECT_THAT(error_of(bare_setup("scripted", ""), 1), HasSubstr("hand 1: the scene has only 1 devices"));
  EXPECT_THAT(error_of(bare_setup("scripted", "/no/such.csv"), 0), HasSubstr("/no/such.csv"));
  EXPECT_THAT(error_of(bare_setup("replay", ""), 0), HasSubstr("needs the path of a recording"));
  EXPECT_THAT(error_of(bare_setup("replay", "/no/such.h5"), 0), HasSubstr("/no/such.h5"));
  const TemporaryFile file(".h5", "not a recording");
  EXPECT_THAT(error_of(bare_setup("replay", file.name()), 0), HasSubstr(file.name()));
}

}  // namespace
}  // namespace palpate::devices

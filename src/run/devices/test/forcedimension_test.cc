// The Force Dimension device against a stand-in for the vendor's library: opening, samples and every fault.
#include "run/devices/forcedimension.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <thread>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/device_kinds.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "run/devices/devices.h"
#include "run/devices/test/stand_in/dhd_stand_in_loaded.h"

namespace palpate::devices {
namespace {

using stand_in::Loaded;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const char* const kWhole = "dhd_stand_in";

/// The message of a refused opening. Empty when the device was opened.
std::string refusal(const std::string& path, std::size_t ordinal = 0) {
  try {
    const ForceDimensionDevice device(path, ordinal);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    return error.what();
  }
  return {};
}

class ForceDimension : public testing::Test {
 protected:
  Loaded dhd_{stand_in::file_of(kWhole)};
  stand_in::Device& hardware_ = dhd_.device();
};

using ForceDimensionLibrary = ForceDimension;

TEST_F(ForceDimensionLibrary, NotInstalledIsReportedWithWhereToGetIt) {
  // An empty path stands for the system's library, which the computers that run this test do not have.
  const Probe probe = probe_forcedimension("");
  if (probe.text.find("libdhd.so.3 is not installed") == std::string::npos) {
    EXPECT_THAT(probe.text, HasSubstr("libdhd")) << "a computer with the vendor's library";
    return;
  }
  EXPECT_FALSE(probe.available);
  EXPECT_THAT(refusal(""), AllOf(HasSubstr("device forcedimension: libdhd.so.3 is not installed"),
                                 HasSubstr("--device forcedimension:/path/libdhd.so")));
}

TEST_F(ForceDimensionLibrary, AFileThatIsNoLibraryIsRefusedByName) {
  const palpate::test::TemporaryFolder folder;
  const std::string file = (folder / "libdhd.so").string();
  std::ofstream(file) << "no library";
  EXPECT_THAT(refusal(file),
              AllOf(HasSubstr(file + ": cannot be loaded"), HasSubstr("must be the vendor's")));
  EXPECT_THAT(refusal((folder / "none.so").string()), HasSubstr("none.so: cannot be loaded"));
}

TEST_F(ForceDimensionLibrary, ARelativePathIsRefusedAsAFileOfTheCurrentFolderMustNotRun) {
  const palpate::test::TemporaryFolder folder;
  std::filesystem::copy_file(dhd_.path, folder / "libdhd.so.3");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  EXPECT_THAT(refusal("libdhd.so.3"), HasSubstr("libdhd.so.3: must be an absolute path"));
  EXPECT_THAT(probe_forcedimension("").text, Not(HasSubstr("3.17.1.0"))) << "found in the current folder";
  std::filesystem::current_path(before);
}

TEST_F(ForceDimensionLibrary, IsFoundInTheUsersConfigurationFolder) {
  const palpate::test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "palpate");
  const std::filesystem::path link = folder / "palpate" / "libdhd.so.3";
  std::filesystem::create_symlink(dhd_.path, link);
  const char* const before = std::getenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): one thread
  const std::string kept = before == nullptr ? "" : before;
  setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_EQ(refusal(""), "");
  EXPECT_EQ(ForceDimensionDevice("", 0).description(), "stand-in.7 (" + link.string() + ", 3.17.1.0)");
  if (before == nullptr) {
    unsetenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): one thread
  } else {
    setenv("XDG_CONFIG_HOME", kept.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }
}

TEST_F(ForceDimensionLibrary, AMissingFunctionIsNamedWithTheVersionFound) {
  EXPECT_THAT(refusal(stand_in::file_of("dhd_stand_in_no_force")),
              AllOf(HasSubstr("has no function dhdSetForceAndTorqueAndGripperForce"), HasSubstr("3.17.1.0"),
                    HasSubstr("must be version 3.3 or a later 3.x")));
}

TEST_F(ForceDimensionLibrary, AWrongVersionIsRefused) {
  EXPECT_THAT(refusal(stand_in::file_of("dhd_stand_in_old")),
              HasSubstr("is version 3.2.2.1466, must be 3.3 or a later 3.x"));
  dhd_.library->version[0] = 4;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("is version 4.17.1.0, must be 3.3 or a later 3.x"));
  dhd_.library->version[0] = 3;
  dhd_.library->version[1] = 3;
  EXPECT_EQ(refusal(dhd_.path), "");
}

TEST_F(ForceDimension, IsRefusedWhenNoneOrNotEnoughAreConnected) {
  dhd_.library->count = 0;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("no device is connected, must be at least 1"));
  dhd_.library->count = 1;
  EXPECT_THAT(refusal(dhd_.path, 1), HasSubstr("1 connected, must be at least 2"));
  dhd_.library->count = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("cannot look for devices: the stand-in's last error"));
}

TEST_F(ForceDimension, IsRefusedWhenItCannotBeOpened) {
  hardware_.open_result = -1;
  EXPECT_THAT(refusal(dhd_.path), AllOf(HasSubstr("device 0 cannot be opened: the stand-in's last error"),
                                        HasSubstr("used by no other program")));
}

TEST_F(ForceDimension, IsRefusedWhenItIsNotCalibratedAndClosedAgain) {
  hardware_.uncalibrated = true;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("not calibrated: put its end where the vendor's manual says"));
  EXPECT_EQ(hardware_.opens, 1);
  EXPECT_EQ(hardware_.closes, 1);
  EXPECT_FALSE(hardware_.force_on);
}

TEST_F(ForceDimension, IsRefusedWhenItsForceCannotBeSwitchedOn) {
  hardware_.enable_result = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("its force cannot be switched on: the stand-in's last error"));
  hardware_.enable_result = 0;
  hardware_.force_off_cause = 6;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("switched its force off: its dead-man switch was released"));
  hardware_.force_off_cause = 0;
  hardware_.powered = false;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("has no power"));
}

TEST_F(ForceDimension, IsRefusedWhenItCannotBeReadOrTakesNoForce) {
  hardware_.error = 2;
  hardware_.pose_result = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("could not be read: the stand-in lost its cable"));
  hardware_.pose_result = 0;
  hardware_.velocity_result = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("could not be read: the stand-in lost its cable"));
  hardware_.velocity_result = 0;
  hardware_.write_result = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("refused a force: the stand-in lost its cable"));
  hardware_.write_result = 0;
  hardware_.status_result = -1;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("its status cannot be read: the stand-in's last error"));
}

TEST_F(ForceDimension, GivesOneSampleInItsOwnFrame) {
  hardware_.position[0] = 0.01;
  hardware_.position[1] = -0.02;
  hardware_.position[2] = 0.03;
  hardware_.velocity[2] = -0.5;
  // A quarter turn about z: x goes to y.
  const double turn[3][3] = {{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
  std::copy(&turn[0][0], &turn[0][0] + 9, &hardware_.rotation[0][0]);
  hardware_.gripper_angle = 0.125;
  hardware_.buttons = 5;
  ForceDimensionDevice device(dhd_.path, 0);
  const haptics::DeviceState state = device.read(0, 0.0);
  EXPECT_EQ(state.position_D, Vec3(0.01, -0.02, 0.03));
  EXPECT_EQ(state.velocity_D, Vec3(0.0, 0.0, -0.5));
  EXPECT_NEAR((state.orientation_D * Vec3::UnitX() - Vec3::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_EQ(state.gripper, 0.25);  // fraction of 0.5 rad
  EXPECT_EQ(state.buttons, 5U);
  EXPECT_EQ(state.age, 0.0);
  EXPECT_EQ(state.fault, haptics::Fault::kNone);
  EXPECT_EQ(device.last_error(), "");
  EXPECT_EQ(device.last_tick(1000.0), ~std::uint64_t{0});
  EXPECT_EQ(device.description(), "stand-in.7 (" + dhd_.path + ", 3.17.1.0)");
}

TEST_F(ForceDimension, GripperGoesFromClosedToOpenForEitherHand) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.gripper_angle = 0.0;
  EXPECT_EQ(device.read(0, 0.0).gripper, 0.0);
  hardware_.gripper_angle = -0.25;  // a left-handed device
  EXPECT_EQ(device.read(1, 0.001).gripper, 0.5);
  hardware_.gripper_angle = 0.6;
  EXPECT_EQ(device.read(2, 0.002).gripper, 1.0);
}

TEST_F(ForceDimension, WithoutWristOrGripperItIsUprightAndClosed) {
  hardware_.has_wrist = false;
  hardware_.has_gripper = false;
  hardware_.rotation[0][0] = std::numeric_limits<double>::quiet_NaN();
  hardware_.gripper_angle = 0.5;
  hardware_.position[1] = 0.04;
  ForceDimensionDevice device(dhd_.path, 0);
  const haptics::DeviceState state = device.read(0, 0.0);
  EXPECT_EQ(state.orientation_D.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(state.gripper, 0.0);
  EXPECT_EQ(state.position_D, Vec3(0.0, 0.04, 0.0));
}

/// Makes the stand-in a Falcon. Its answers about a wrist and a gripper are ignored.
void make_falcon(stand_in::Device& hardware) {
  hardware.type = 60;
  hardware.rotation[0][0] = std::numeric_limits<double>::quiet_NaN();
  hardware.gripper_angle = 0.5;
}

TEST_F(ForceDimension, AFalconIsUprightAndClosedAndTakesForceAlone) {
  make_falcon(hardware_);
  hardware_.position[2] = 0.03;
  hardware_.buttons = 4;
  ForceDimensionDevice device(dhd_.path, 0);
  const haptics::DeviceState state = device.read(0, 0.0);
  EXPECT_EQ(state.fault, haptics::Fault::kNone);
  EXPECT_EQ(state.position_D, Vec3(0.0, 0.0, 0.03));
  EXPECT_EQ(state.orientation_D.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(state.gripper, 0.0);
  EXPECT_EQ(state.buttons, 4U);
  EXPECT_TRUE(device.write({Vec3(1.0, -2.0, 3.0), Vec3(0.01, 0.02, -0.03), 0.5}));
  EXPECT_THAT(hardware_.force, testing::ElementsAre(1.0, -2.0, 3.0));
  EXPECT_THAT(hardware_.torque, testing::Each(0.0));
  EXPECT_EQ(hardware_.gripper_force, 0.0);
}

TEST_F(ForceDimension, AFalconThatIsNotCalibratedIsRefusedWithItsOwnMovement) {
  make_falcon(hardware_);
  hardware_.uncalibrated = true;
  EXPECT_THAT(refusal(dhd_.path), HasSubstr("not calibrated: draw its grip out as far as it goes"));
}

TEST_F(ForceDimension, ALibraryWithOnlyWhatIsRequiredIsEnough) {
  const Loaded bare(stand_in::file_of("dhd_stand_in_bare"));
  bare.library->count = 2;
  bare.device(0).buttons = 6;
  bare.device(1).position[0] = 0.02;
  ForceDimensionDevice first(bare.path, 0);
  ForceDimensionDevice second(bare.path, 1);
  EXPECT_EQ(first.read(0, 0.0).buttons, 6U);
  EXPECT_EQ(second.read(0, 0.0).position_D.x(), 0.02);
  EXPECT_TRUE(first.write({Vec3(1.0, 0.0, 0.0), Vec3::Zero(), 0.0}));
  EXPECT_EQ(bare.device(0).watchdog, -1) << "it has none";
  bare.device(0).pose_result = -1;
  bare.device(0).error = 7;
  EXPECT_EQ(first.read(1, 0.001).fault, haptics::Fault::kDevice);
  EXPECT_EQ(first.last_error(), "the device could not be read: the vendor's error 7");
}

TEST_F(ForceDimension, WritesForceTorqueAndGripperForceAsTheyAre) {
  ForceDimensionDevice device(dhd_.path, 0);
  EXPECT_TRUE(hardware_.force_on);
  EXPECT_EQ(hardware_.watchdog, -1) << "before the first write nothing need come in time";
  EXPECT_TRUE(device.write({Vec3(1.0, -2.0, 3.0), Vec3(0.01, 0.02, -0.03), 0.5}));
  EXPECT_THAT(hardware_.force, testing::ElementsAre(1.0, -2.0, 3.0));
  EXPECT_THAT(hardware_.torque, testing::ElementsAre(0.01, 0.02, -0.03));
  EXPECT_EQ(hardware_.gripper_force, 0.5);
  EXPECT_EQ(hardware_.watchdog, 160) << "20 ms in steps of 125 us";
  EXPECT_FALSE(dhd_.library->expert) << "left again";
}

TEST_F(ForceDimension, ASaturatedMotorIsNoError) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.write_result = 2;
  EXPECT_TRUE(device.write({Vec3(0.0, 0.0, 30.0), Vec3::Zero(), 0.0}));
  EXPECT_EQ(device.read(1, 0.001).fault, haptics::Fault::kNone);
  EXPECT_EQ(device.last_error(), "");
}

TEST_F(ForceDimension, ATimeGuardedSampleIsNoErrorAndGrowsOlder) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.position[0] = 0.01;
  EXPECT_EQ(device.read(0, 0.0).age, 0.0);
  hardware_.pose_result = 1;
  hardware_.position[0] = 0.02;
  const haptics::DeviceState guarded = device.read(1, 0.00025);
  EXPECT_EQ(guarded.age, 0.00025);
  EXPECT_EQ(guarded.position_D.x(), 0.01) << "the sample before";
  EXPECT_EQ(guarded.fault, haptics::Fault::kNone);
  EXPECT_EQ(device.read(20, 0.005).age, 0.005);
  hardware_.pose_result = 0;
  EXPECT_EQ(device.read(21, 0.00525).age, 0.0);
  EXPECT_EQ(device.last_error(), "");
}

TEST_F(ForceDimension, AFailedReadIsADeviceFaultWithTheVendorsWords) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.error = 2;
  for (int* result : {&hardware_.pose_result, &hardware_.velocity_result}) {
    *result = -1;
    EXPECT_EQ(device.read(1, 0.001).fault, haptics::Fault::kDevice);
    EXPECT_EQ(device.last_error(), "the device could not be read: the stand-in lost its cable");
    *result = 0;
    EXPECT_EQ(device.read(2, 0.002).fault, haptics::Fault::kNone);
  }
  hardware_.status_result = -1;
  EXPECT_EQ(device.read(10, 0.010).fault, haptics::Fault::kDevice);
  EXPECT_EQ(device.last_error(), "the device's status could not be read: the stand-in lost its cable");
}

TEST_F(ForceDimension, ARefusedForceIsReportedToTheLoopAndInWords) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.error = 3;
  hardware_.write_result = -1;
  EXPECT_FALSE(device.write({}));
  EXPECT_EQ(device.last_error(), "the device refused a force: the stand-in's other error");
}

TEST_F(ForceDimension, AStatusThatSwitchedTheForceOffIsAFaultWithItsCause) {
  const std::pair<int, const char*> causes[] = {
      {1, "its force button was pressed"}, {2, "it moved faster than its velocity limit"},
      {3, "its watchdog had no command"},  {4, "a program switched the force off"},
      {5, "the USB connection was lost"},  {6, "its dead-man switch was released"},
      {9, "it does not say why"},
  };
  ForceDimensionDevice device(dhd_.path, 0);
  std::uint64_t tick = 0;
  const auto read = [&] {
    tick += 4;  // longer than the period of the status
    return device.read(tick, static_cast<double>(tick) * 1e-3).fault;
  };
  for (const auto& cause : causes) {
    hardware_.force_off_cause = cause.first;
    EXPECT_EQ(read(), haptics::Fault::kForceOff);
    EXPECT_THAT(device.last_error(), HasSubstr(cause.second));
    hardware_.force_off_cause = 0;
    EXPECT_EQ(read(), haptics::Fault::kForceOff) << "until the force is on again";
    hardware_.force_on = true;
    EXPECT_EQ(read(), haptics::Fault::kNone);
    EXPECT_THAT(device.last_error(), HasSubstr("switched its force off")) << "what was last wrong";
  }
}

TEST_F(ForceDimension, LossOfPowerOrCalibrationIsReportedAsSuch) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.powered = false;
  EXPECT_EQ(device.read(4, 0.004).fault, haptics::Fault::kForceOff);
  EXPECT_THAT(device.last_error(), HasSubstr("no power"));
  hardware_.powered = true;
  hardware_.uncalibrated = true;
  EXPECT_EQ(device.read(8, 0.008).fault, haptics::Fault::kForceOff);
  EXPECT_THAT(device.last_error(), HasSubstr("not calibrated"));
}

TEST_F(ForceDimension, TheStatusIsSeenWithinTwoMilliseconds) {
  for (const double rate : {1000.0, 4000.0}) {
    hardware_.force_off_cause = 0;
    ForceDimensionDevice device(dhd_.path, 0);
    std::uint64_t tick = 0;
    for (; tick < 100; ++tick) (void)device.read(tick, static_cast<double>(tick) / rate);
    hardware_.force_off_cause = 2;
    const std::uint64_t begun = tick;
    while (device.read(tick, static_cast<double>(tick) / rate).fault == haptics::Fault::kNone) {
      ASSERT_LT(++tick, begun + 1000);
    }
    EXPECT_LE(static_cast<double>(tick - begun) / rate, ForceDimensionDevice::kStatusPeriod);
  }
}

TEST_F(ForceDimension, StopWritesZeroFromAnyThreadAndAsOftenAsOneLikes) {
  ForceDimensionDevice device(dhd_.path, 0);
  (void)device.write({Vec3(1.0, 2.0, 3.0), Vec3(0.1, 0.0, 0.0), 0.4});
  std::thread other([&device] {
    device.stop();
    device.stop();
  });
  other.join();
  EXPECT_THAT(hardware_.force, testing::Each(0.0));
  EXPECT_THAT(hardware_.torque, testing::Each(0.0));
  EXPECT_EQ(hardware_.gripper_force, 0.0);
}

TEST_F(ForceDimension, TheLastErrorIsReadFromAnotherThreadWhileTheLoopReads) {
  ForceDimensionDevice device(dhd_.path, 0);
  hardware_.error = 2;
  std::thread other([&device] {
    for (int i = 0; i < 1000; ++i) {
      const std::string words = device.last_error();
      EXPECT_TRUE(words.empty() || words == "the device could not be read: the stand-in lost its cable")
          << words;
    }
  });
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    hardware_.pose_result = tick % 2 == 0 ? -1 : 0;
    (void)device.read(tick, 0.001 * static_cast<double>(tick));
  }
  other.join();
}

TEST_F(ForceDimension, ClosesAtZeroForceBrakedWithoutItsWatchdog) {
  {
    ForceDimensionDevice device(dhd_.path, 0);
    (void)device.write({Vec3(1.0, 2.0, 3.0), Vec3::Zero(), 0.0});
  }
  EXPECT_THAT(hardware_.force, testing::Each(0.0));
  EXPECT_TRUE(hardware_.brakes);
  EXPECT_FALSE(hardware_.force_on);
  EXPECT_EQ(hardware_.watchdog, 0);
  EXPECT_FALSE(hardware_.open);
  EXPECT_EQ(hardware_.closes, 1);
}

TEST_F(ForceDimension, AllDevicesShareOneLibraryThatTheLastCloses) {
  dhd_.library->count = 2;
  auto first = std::make_unique<ForceDimensionDevice>(dhd_.path, 0);
  auto second = std::make_unique<ForceDimensionDevice>(dhd_.path, 1);
  EXPECT_TRUE(hardware_.open && dhd_.device(1).open);
  first.reset();
  dhd_.device(1).position[2] = 0.05;
  EXPECT_EQ(second->read(0, 0.0).position_D.z(), 0.05) << "its library is still there";
  second.reset();

  const std::string path = stand_in::file_of("dhd_stand_in_bare");  // no other test has this library open
  EXPECT_EQ(refusal(path), "");
  EXPECT_EQ(dlopen(path.c_str(), RTLD_NOW | RTLD_NOLOAD), nullptr) << "gone from memory";
}

TEST_F(ForceDimension, TwoHandsTakeTheDevicesInTheirOrder) {
  dhd_.library->count = 2;
  dhd_.device(0).position[0] = 0.01;
  dhd_.device(1).position[0] = 0.02;
  scene::Scene scene;
  scene.devices.resize(3);
  scene.devices[0].kind = "forcedimension";
  scene.devices[0].path = dhd_.path;
  scene.devices[2] = scene.devices[0];
  const auto left = open_device(scene, 0);
  const auto right = open_device(scene, 2);
  EXPECT_EQ(left->read(0, 0.0).position_D.x(), 0.01);
  EXPECT_EQ(right->read(0, 0.0).position_D.x(), 0.02);
}

TEST_F(ForceDimension, TheProbeCountsDevicesAndOpensNone) {
  dhd_.library->count = 2;
  const Probe two = probe_forcedimension(dhd_.path);
  EXPECT_EQ(two.kind, "forcedimension");
  EXPECT_TRUE(two.available);
  EXPECT_THAT(two.text, AllOf(HasSubstr("2 devices connected"), HasSubstr("3.17.1.0")));
  dhd_.library->count = 0;
  const Probe none = probe_forcedimension(dhd_.path);
  EXPECT_FALSE(none.available);
  EXPECT_THAT(none.text, HasSubstr("no device is connected"));
  dhd_.library->count = -1;
  EXPECT_THAT(probe_forcedimension(dhd_.path).text, HasSubstr("cannot look for devices"));
  const Probe old = probe_forcedimension(stand_in::file_of("dhd_stand_in_old"));
  EXPECT_THAT(old.text, HasSubstr("must be 3.3"));
  EXPECT_TRUE(old.library) << "installed: it is not missing";
  EXPECT_EQ(hardware_.opens, 0);
}

TEST(ProbeDevices, HasALineForEveryKindInTheirOrder) {
  const std::vector<Probe> probed = probe_devices();
  const auto kinds = scene::device_kinds();
  ASSERT_EQ(probed.size(), kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(probed[i].kind, kinds[i].name);
    EXPECT_NE(probed[i].text, "");
    EXPECT_EQ(probed[i].text.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(probed[0].available) << "a scripted device needs nothing";
}

TEST(OpenConnected, RefusesWhatCannotBeConnected) {
  for (const char* what : {"scripted", "replay:run.h5", "mouse", ""}) {
    EXPECT_THROW((void)open_connected(what), InputError) << what;
  }
}

TEST_F(ForceDimension, CanBeOpenedOutsideAScene) {
  hardware_.position[0] = 0.01;
  const OpenedDevice opened = open_connected("forcedimension:" + dhd_.path);
  EXPECT_THAT(opened.name, HasSubstr("stand-in.7"));
  EXPECT_EQ(opened.device->read(0, 0.0).position_D.x(), 0.01);
}

}  // namespace
}  // namespace palpate::devices

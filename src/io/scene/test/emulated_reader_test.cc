#include "io/scene/emulated_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/scene_file.h"
#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

const std::string kShortEmulated =
    "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:3\"\n[device]\n";  // five lines

DeviceSetup device_of(const std::string& lines) {
  const TemporaryFolder folder;
  return read_scene_file(folder.write("press.toml", kShortEmulated + lines)).devices.front().setup;
}

std::string emulated_error_in(const std::string& lines) {
  const TemporaryFolder folder;
  const auto file = folder.write("press.toml", kShortEmulated + lines);
  return error_of([&] { (void)read_scene_file(file); });
}

TEST(EmulatedReader, ReadsMassGripAndFaultsIntoSi) {
  const DeviceSetup device = device_of(R"(kind = "emulated"
damping_N_s_per_m = 2.0
friction_N = 0.1
resolution_mm = 0.02
mass_kg = 0.4
grip_N_per_m = 120
grip_N_s_per_m = 2.5
[[device.fault]]
kind = "freeze"
time_s = 2.5
duration_s = 0.1
[[device.fault]]
kind = "late"
time_s = 3
age_ms = 12
)");
  EXPECT_EQ(device.emulated.mass, 0.4);
  EXPECT_EQ(device.emulated.grip.stiffness, 120.0);
  EXPECT_EQ(device.emulated.grip.damping, 2.5);
  EXPECT_EQ(device.dynamics.damping, 2.0);
  EXPECT_EQ(device.dynamics.friction, 0.1);
  EXPECT_DOUBLE_EQ(*device.dynamics.resolution, 2e-5);
  ASSERT_EQ(device.emulated.faults.size(), 2U);
  EXPECT_EQ(device.emulated.faults[0].kind, EmulatedFaultKind::kFreeze);
  EXPECT_EQ(device.emulated.faults[0].time, 2.5);
  EXPECT_EQ(device.emulated.faults[0].duration, 0.1);
  EXPECT_EQ(device.emulated.faults[1].kind, EmulatedFaultKind::kLate);
  EXPECT_EQ(device.emulated.faults[1].duration, 0.0);
  EXPECT_DOUBLE_EQ(device.emulated.faults[1].age, 12e-3);
}

TEST(EmulatedReader, KnowsTwoGripsByNameAndHoldsFirmlyByItself) {
  EXPECT_EQ(device_of("kind = \"emulated\"\ngrip = \"light\"\n").emulated.grip.stiffness,
            kLightGrip.stiffness);
  EXPECT_EQ(device_of("kind = \"emulated\"\ngrip = \"light\"\n").emulated.grip.damping, kLightGrip.damping);
  EXPECT_EQ(device_of("kind = \"emulated\"\ngrip = \"firm\"\n").emulated.grip.stiffness, kFirmGrip.stiffness);
  const EmulatedHand plain = device_of("kind = \"emulated\"\n").emulated;
  EXPECT_EQ(plain.grip.stiffness, kFirmGrip.stiffness);
  EXPECT_EQ(plain.grip.damping, kFirmGrip.damping);
  EXPECT_EQ(plain.mass, 0.25);
  EXPECT_TRUE(plain.faults.empty());
}

TEST(EmulatedReader, EveryFaultHasANameThatIsFoundAgain) {
  for (const EmulatedFaultName& known : emulated_fault_names()) {
    EXPECT_EQ(find_emulated_fault(name_of(known.kind)), known.kind);
    const DeviceSetup device = device_of("kind = \"emulated\"\n[[device.fault]]\ntime_s = 1\nkind = \"" +
                                         std::string(known.name) + "\"\n");
    ASSERT_EQ(device.emulated.faults.size(), 1U);
    EXPECT_EQ(device.emulated.faults[0].kind, known.kind);
  }
  EXPECT_EQ(find_emulated_fault("flood"), std::nullopt);
}

TEST(EmulatedReader, RefusesWhatIsOutOfRangeOrGivenTwice) {
  const std::string kind = "kind = \"emulated\"\n";
  EXPECT_THAT(emulated_error_in(kind + "mass_kg = 0\n"),
              HasSubstr(":7: device.mass_kg = 0: must be a number >= 0.001"));
  EXPECT_THAT(emulated_error_in(kind + "grip = \"tight\"\n"),
              HasSubstr("device.grip = \"tight\": must be light or firm"));
  EXPECT_THAT(emulated_error_in(kind + "grip_N_per_m = -1\n"),
              HasSubstr("device.grip_N_per_m = -1: must be a number >= 0"));
  EXPECT_THAT(emulated_error_in(kind + "grip_N_s_per_m = 1e9\n"), HasSubstr("device.grip_N_s_per_m"));
  EXPECT_THAT(emulated_error_in(kind + "grip = \"light\"\ngrip_N_per_m = 50\n"),
              HasSubstr(":8: device.grip_N_per_m = 50: excludes grip, give only one of them"));
  const std::string fault = kind + "[[device.fault]]\n";
  EXPECT_THAT(emulated_error_in(fault + "time_s = 1\n"),
              HasSubstr("device.fault.kind: missing, must be freeze, drop-out"));
  EXPECT_THAT(
      emulated_error_in(fault + "kind = \"flood\"\ntime_s = 1\n"),
      HasSubstr("device.fault.kind = \"flood\": must be freeze, drop-out, nan, spike, late, wrong-units, "
                "force-off or refuse"));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"nan\"\n"), HasSubstr("device.fault.time_s: missing"));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"nan\"\ntime_s = -1\n"),
              HasSubstr("device.fault.time_s = -1"));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"nan\"\ntime_s = 1\nduration_s = -1\n"),
              HasSubstr("duration_s = -1"));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"late\"\ntime_s = 1\nage_ms = 2000\n"),
              HasSubstr("age_ms = 2000"));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"nan\"\ntime_s = 1\nage_ms = 8\n"),
              HasSubstr("age_ms = 8: is only for kind = \"late\""));
  EXPECT_THAT(emulated_error_in(fault + "kind = \"nan\"\ntime_s = 1\nwhen = 2\n"), HasSubstr("unknown key"));
}

TEST(EmulatedReader, RefusesItsKeysForOtherKindsOfDevice) {
  for (const std::string line :
       {"mass_kg = 1", "grip = \"light\"", "grip_N_per_m = 1", "grip_N_s_per_m = 1"}) {
    EXPECT_THAT(emulated_error_in(line + "\n"), HasSubstr(": is only for kind = \"emulated\"")) << line;
    EXPECT_THAT(emulated_error_in("kind = \"haply\"\n" + line + "\n"), HasSubstr("is only for kind")) << line;
  }
  EXPECT_THAT(emulated_error_in("[[device.fault]]\nkind = \"nan\"\ntime_s = 1\n"), HasSubstr("device.fault"));
}

TEST(EmulatedReader, AnEmulatedDevicesDynamicsAreAlwaysKnownAndAnothersOnlyWhenGiven) {
  const TemporaryFolder folder;
  Overrides request;
  request.scene = folder.write("press.toml", kShortEmulated + "kind = \"emulated\"\nfriction_N = 0.2\n");
  const DeviceDynamics emulated = load(request).devices.front().dynamics;
  EXPECT_EQ(emulated.damping, 1.5);
  EXPECT_EQ(emulated.friction, 0.2);
  EXPECT_EQ(emulated.resolution, 1e-5);
  request.device = "scripted";
  const DeviceDynamics scripted = load(request).devices.front().dynamics;
  EXPECT_EQ(scripted.damping, std::nullopt);
  EXPECT_EQ(scripted.friction, 0.2);
}

}  // namespace
}  // namespace palpate::scene

// The Touch device against a stand-in for OpenHaptics' library: opening, samples, forces, two arms.
#include "run/devices/touch.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/device_kinds.h"
#include "io/system/clock.h"
#include "palpate/error.h"
#include "run/devices/devices.h"
#include "run/devices/test/stand_in/hd_stand_in_loaded.h"
#include "run/devices/touch_library.h"

namespace palpate::devices {
namespace {

using haptics::Fault;
using stand_in::HdArm;
using stand_in::HdWorld;
using stand_in::LoadedHd;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kLongest = 10'000'000'000;  // ns: a hundred times the period of temperatures

/// The message of a refused opening. Empty when the device was opened.
std::string touch_refusal(const std::string& name = "", const std::string& library = HdLibrary::kName) {
  try {
    const TouchDevice device(name, library);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    return error.what();
  }
  return {};
}

/// The stand-in for OpenHaptics. Its scheduler calls back at 1 kHz until a test steps it.
class Touch : public testing::Test {
 protected:
  ~Touch() override {
    hd_.set([](HdWorld& world) {
      EXPECT_EQ(world.illegal, 0) << "state and force within the scheduler's callback alone";
      EXPECT_FALSE(world.running);
      EXPECT_EQ(world.callbacks, 0);
      for (const HdArm& arm : world.arms) EXPECT_EQ(arm.opens, arm.closes);
    });
  }
  Touch() = default;
  Touch(const Touch&) = delete;
  Touch& operator=(const Touch&) = delete;

  /// Stops the frames at 1 kHz. From now on frames come only from step().
  void hold() const {
    hd_.set([](HdWorld& world) {
      world.stepped = true;
      world.asked = world.done;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // a frame that had begun has ended
    hd_.set([](HdWorld& world) { world.asked = world.done; });
  }
  /// Returns to 1 kHz, so that closing the device finds its last frame.
  void let_run() const {
    hd_.set([](HdWorld& world) { world.stepped = false; });
  }
  [[nodiscard]] std::vector<double> force_at_the_arm(int index = 0) const {
    return hd_.arm([](const HdArm& arm) { return std::vector<double>(arm.force, arm.force + 3); }, index);
  }
  /// Writes a force until the scheduler has taken it. A computer may halt for longer than a command is valid.
  void give(TouchDevice& device, const Vec3& force_D, int index = 0) const {
    for (int i = 0; i < 1000; ++i) {
      EXPECT_TRUE(device.write({force_D, Vec3(0.1, 0.1, 0.1), 0.4}));
      hd_.step();
      if (Eigen::Map<const Vec3>(force_at_the_arm(index).data()) != Vec3::Zero()) return;
    }
    ADD_FAILURE() << "the scheduler takes no force";
  }
  /// Writes a force that must not arrive.
  void give_in_vain(TouchDevice& device, const Vec3& force_D) const {
    EXPECT_TRUE(device.write({force_D, Vec3::Zero(), 0.0}));
    hd_.step();
    EXPECT_THAT(force_at_the_arm(), testing::Each(0.0));
  }

  LoadedHd hd_;
};

TEST_F(Touch, BearsWhatItsModelBearsAndNoMoreThanItTellsItself) {
  hd_.set([](HdWorld& world) {
    world.arms[0].max_force = 2.5;
    world.arms[0].continuous_force = 0.88;
  });
  const haptics::DeviceAbilities abilities = TouchDevice("").abilities();
  EXPECT_EQ(abilities.max_force, 2.5);
  EXPECT_EQ(abilities.continuous_force, 0.88);
  EXPECT_EQ(abilities.max_stiffness, 400.0) << "a Touch";
  EXPECT_FALSE(abilities.torque);
}

TEST_F(Touch, OpensTheDefaultDeviceWithItsForceOnAtOneKilohertz) {
  const TouchDevice device("");
  EXPECT_EQ(device.description(), "Stand-in Touch (serial number 1234, driver 4.0), at most 3.3 N");
  EXPECT_EQ(device.last_error(), "");
  hd_.set([](const HdWorld& world) {
    EXPECT_TRUE(world.arms[0].force_enabled);
    EXPECT_EQ(world.rate, 1000U);
    EXPECT_EQ(world.callbacks, 1);
    EXPECT_FALSE(world.arms[1].open);
  });
}

TEST_F(Touch, GivesOneSampleInMetresWithZUp) {
  hd_.arm([](HdArm& arm) {
    const double position[3] = {10.0, 20.0, 30.0};
    const double velocity[3] = {100.0, 200.0, -300.0};
    std::copy_n(position, 3, arm.position);
    std::copy_n(velocity, 3, arm.velocity);
    arm.buttons = 2;
  });
  TouchDevice device("");
  const haptics::DeviceState sample = device.read(0, 0.0);
  EXPECT_EQ(sample.fault, Fault::kNone);
  EXPECT_TRUE(sample.position_D.isApprox(Vec3(0.01, -0.03, 0.02), 1e-15)) << "right, forward, up";
  EXPECT_TRUE(sample.velocity_D.isApprox(Vec3(0.1, 0.3, 0.2), 1e-15));
  EXPECT_EQ(sample.buttons, 2U) << "the second button, number 1 for clutch_button";
}

TEST_F(Touch, AnInstrumentPointsWhereTheStylusPoints) {
  // In the vendor's identity the tip points forward, away from the user. An instrument's tips are at +z.
  TouchDevice device("");
  const Mat3 forward = device.read(0, 0.0).orientation_D.toRotationMatrix();
  EXPECT_TRUE((forward * Vec3::UnitZ()).isApprox(Vec3::UnitY(), 1e-12));
  EXPECT_TRUE((forward * Vec3::UnitX()).isApprox(Vec3::UnitX(), 1e-12));
  EXPECT_NEAR(forward.determinant(), 1.0, 1e-12);
}

TEST_F(Touch, AStylusThatPointsDownTurnsTheInstrumentUpsideDown) {
  hd_.arm([](HdArm& arm) {
    // The matrix is by columns. The stylus's x axis does not change. Its y axis points away from the user.
    // Its z axis points to the handle, here upwards.
    const double upright[16] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
    std::copy_n(upright, 16, arm.transform);
  });
  TouchDevice device("");
  const Mat3 rotation = device.read(0, 0.0).orientation_D.toRotationMatrix();
  EXPECT_TRUE(rotation.isApprox(Vec3(1.0, -1.0, -1.0).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST_F(Touch, ItsFirstButtonClosesTheJawsInAQuarterOfASecond) {
  TouchDevice device("");
  hold();
  EXPECT_EQ(device.read(0, 0.0).gripper, 1.0) << "open";
  hd_.arm([](HdArm& arm) { arm.buttons = 1; });
  hd_.step();
  EXPECT_NEAR(device.read(1, 0.1).gripper, 0.6, 1e-12);
  EXPECT_NEAR(device.read(2, 0.25).gripper, 0.0, 1e-12);
  EXPECT_EQ(device.read(3, 1.0).gripper, 0.0);
  hd_.arm([](HdArm& arm) { arm.buttons = 2; });
  hd_.step();
  EXPECT_NEAR(device.read(4, 1.05).gripper, 0.2, 1e-12) << "the second button does not close them";
  let_run();
}

TEST_F(Touch, AForceArrivesInTheVendorsFrameAndATorqueNowhere) {
  TouchDevice device("");
  hold();
  give(device, Vec3(1.0, -2.0, 0.5));
  EXPECT_THAT(force_at_the_arm(), ElementsAre(1.0, 0.5, 2.0)) << "right, up, towards the user";
  let_run();
}

TEST_F(Touch, AForceBeyondWhatTheArmCanGiveKeepsItsDirection) {
  TouchDevice device("");
  hold();
  give(device, Vec3(0.0, 0.0, 20.0));
  EXPECT_THAT(force_at_the_arm(), ElementsAre(0.0, testing::DoubleNear(3.3, 1e-12), 0.0));
  let_run();
}

TEST_F(Touch, AForceThatIsNotFiniteIsRefusedAndZeroGiven) {
  TouchDevice device("");
  hold();
  give(device, Vec3(0.0, 0.0, 1.0));
  EXPECT_FALSE(device.write({Vec3(0.0, std::nan(""), 0.0), Vec3::Zero(), 0.0}));
  hd_.step();
  EXPECT_THAT(force_at_the_arm(), testing::Each(0.0));
  let_run();
}

TEST_F(Touch, StopGivesZeroFromAnyThreadUntilTheNextWrite) {
  TouchDevice device("");
  hold();
  give(device, Vec3(0.0, 0.0, 1.0));
  std::thread other([&device] {
    device.stop();
    device.stop();
  });
  other.join();
  hd_.step();
  EXPECT_THAT(force_at_the_arm(), testing::Each(0.0));
  give(device, Vec3(0.0, 0.0, 1.0));
  EXPECT_THAT(force_at_the_arm(), ElementsAre(0.0, 1.0, 0.0));
  let_run();
}

TEST_F(Touch, ALoopThatWritesNoMoreLeavesTheHandWithoutForce) {
  TouchDevice device("");
  hold();
  give(device, Vec3(0.0, 0.0, 1.0));
  std::this_thread::sleep_for(std::chrono::nanoseconds(TouchScheduler::kWriteTimeout));
  hd_.step();
  EXPECT_THAT(force_at_the_arm(), testing::Each(0.0));
  let_run();
}

TEST_F(Touch, ClosesAtZeroForceThenForceOffThenTheArm) {
  {
    TouchDevice device("");
    hold();
    give(device, Vec3(0.0, 0.0, 1.0));
    hd_.set([](HdWorld& world) { world.order.clear(); });
    let_run();
  }
  hd_.set([](const HdWorld& world) {
    EXPECT_THAT(world.order, ElementsAre(testing::StrEq("zero"), testing::StrEq("stop"),
                                         testing::StrEq("disable force"), testing::StrEq("close")));
    EXPECT_FALSE(world.arms[0].force_enabled);
  });
}

TEST_F(Touch, ClosesAlsoWhenTheSchedulerCallsNothingBack) {
  {
    const TouchDevice device("");
    hd_.set([](HdWorld& world) { world.silent = true; });
  }
  EXPECT_FALSE(hd_.arm([](const HdArm& arm) { return arm.open || arm.force_enabled; }));
}

TEST_F(Touch, ASilentSchedulersSampleGrowsOlderByTheClock) {
  TouchDevice device("");
  hold();
  double young = 0.0;
  double old = 0.0;
  std::int64_t begun = 0;
  for (int i = 0; i < 10 && old - young < 0.008; ++i) {  // one frame may still end meanwhile
    young = device.read(0, 0.0).age;
    begun = monotonic_ns();
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
    old = device.read(1, 0.001).age;
  }
  EXPECT_GE(old - young, 0.008);
  EXPECT_LE(old - young, 1e-9 * static_cast<double>(monotonic_ns() - begun) + 1e-3);
  EXPECT_THAT(device.last_error(), HasSubstr("too slowly or none"));
  EXPECT_EQ(device.read(2, 0.002).fault, Fault::kNone) << "the loop makes a fault of the age";
  let_run();
}

TEST_F(Touch, AWarmMotorIsShownWithTheSampleUntilItHasCooled) {
  TouchDevice device("");
  hold();
  const auto warm = [&] { return (device.read(0, 0.0).events & haptics::kMotorsWarm) != 0; };
  const auto frames_until = [&](bool wanted) {
    const std::int64_t begun = monotonic_ns();
    while (warm() != wanted && monotonic_ns() - begun < kLongest) hd_.step();
    return warm();
  };
  EXPECT_FALSE(warm());
  hd_.arm([](HdArm& arm) { arm.temperatures = {0.2, 0.71, 0.2}; });
  EXPECT_TRUE(frames_until(true)) << "any of them";
  EXPECT_EQ(device.read(1, 0.001).fault, Fault::kNone);
  hd_.arm([](HdArm& arm) { arm.temperatures = {0.2, 0.69, 0.2}; });
  EXPECT_FALSE(frames_until(false));
  let_run();
}

TEST_F(Touch, TheTemperatureIsAskedForSeldomAndAnArmThatTellsNoneIsInOrder) {
  hd_.arm([](HdArm& arm) { arm.temperatures.clear(); }, 1);
  const std::int64_t begun = monotonic_ns();
  TouchDevice telling("");
  TouchDevice silent("Left");
  while (hd_.arm([](const HdArm& arm) { return arm.temperatures_asked; }) < 3) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GE(monotonic_ns() - begun, 2 * TouchScheduler::kTemperaturePeriod) << "the third one";
  EXPECT_EQ(silent.read(0, 0.0).fault, Fault::kNone);
  EXPECT_EQ(silent.last_error(), "");
  EXPECT_EQ(telling.read(0, 0.0).fault, Fault::kNone);
}

TEST_F(Touch, AnErrorOfTheFrameIsNotTakenForTheTemperatures) {
  TouchDevice device("");
  hold();
  hd_.arm([](HdArm& arm) {
    arm.begin_error = 0x0302;
    arm.temperatures = {0.9};
  });
  const std::int64_t begun = monotonic_ns();
  while ((device.read(0, 0.0).events & haptics::kMotorsWarm) == 0 && monotonic_ns() - begun < kLongest) {
    hd_.step();
    ASSERT_EQ(device.read(1, 0.001).fault, Fault::kDevice);
  }
  EXPECT_NE(device.read(2, 0.002).events & haptics::kMotorsWarm, 0U);
  hd_.arm([](HdArm& arm) { arm.begin_error = 0; });
  let_run();
}

TEST_F(Touch, TheInkwellAndAReleasedStylusTakeTheForceAway) {
  TouchDevice device("");
  hold();
  give(device, Vec3(0.0, 0.0, 1.0));
  EXPECT_THAT(force_at_the_arm(), ElementsAre(0.0, 1.0, 0.0));
  hd_.arm([](HdArm& arm) { arm.in_inkwell = true; });
  give_in_vain(device, Vec3(0.0, 0.0, 1.0));
  EXPECT_THAT(device.last_error(), HasSubstr("in the inkwell: take it out"));
  EXPECT_EQ(device.read(1, 0.001).fault, Fault::kForceOff);
  hd_.arm([](HdArm& arm) {
    arm.in_inkwell = false;
    arm.held = false;
  });
  give_in_vain(device, Vec3(0.0, 0.0, 1.0));
  EXPECT_THAT(device.last_error(), HasSubstr("was let go: hold it"));
  EXPECT_EQ(device.read(2, 0.002).fault, Fault::kForceOff);
  let_run();
}

TEST_F(Touch, AnArmWhoseSafetySwitchWasNeverClosedHasNone) {
  hd_.arm([](HdArm& arm) { arm.held = false; });
  TouchDevice device("");
  EXPECT_EQ(device.read(0, 0.0).fault, Fault::kNone);
}

TEST_F(Touch, OpensInTheInkwellAndSaysSoWithEachSample) {
  hd_.arm([](HdArm& arm) { arm.in_inkwell = true; });
  TouchDevice device("");
  EXPECT_EQ(device.read(0, 0.0).fault, Fault::kForceOff);
}

TEST_F(Touch, TwoArmsShareOneCallbackAndEachHasItsOwnForce) {
  hd_.arm([](HdArm& arm) { arm.position[0] = 10.0; }, 0);
  hd_.arm([](HdArm& arm) { arm.position[0] = 20.0; }, 1);
  TouchDevice right("");
  auto left = std::make_unique<TouchDevice>("Left");
  hd_.set([](const HdWorld& world) { EXPECT_EQ(world.callbacks, 1); });
  hold();
  EXPECT_EQ(right.read(0, 0.0).position_D.x(), 0.01);
  EXPECT_EQ(left->read(0, 0.0).position_D.x(), 0.02);
  give(right, Vec3(1.0, 0.0, 0.0), 0);
  EXPECT_THAT(force_at_the_arm(0), ElementsAre(1.0, 0.0, 0.0));
  give(*left, Vec3(2.0, 0.0, 0.0), 1);
  EXPECT_THAT(force_at_the_arm(1), ElementsAre(2.0, 0.0, 0.0));
  let_run();
  left.reset();
  hold();
  give(right, Vec3(1.0, 0.0, 0.0));
  EXPECT_THAT(force_at_the_arm(0), ElementsAre(1.0, 0.0, 0.0)) << "the other arm's end leaves this one";
  EXPECT_FALSE(hd_.arm([](const HdArm& arm) { return arm.open; }, 1));
  let_run();
}

TEST_F(Touch, AnErrorIsThatOfTheArmItNames) {
  TouchDevice right("");
  TouchDevice left("Left");
  hold();
  hd_.arm([](HdArm& arm) { arm.frame_error = 0x0302; }, 1);
  hd_.step();
  hd_.arm([](HdArm& arm) { arm.frame_error = 0; }, 1);
  EXPECT_THAT(left.last_error(), HasSubstr("does not communicate"));
  EXPECT_EQ(right.last_error(), "");
  EXPECT_EQ(right.read(1, 0.001).fault, Fault::kNone);
  EXPECT_EQ(left.read(1, 0.001).fault, Fault::kDevice);
  std::this_thread::sleep_for(std::chrono::nanoseconds(TouchScheduler::kErrorHoldTime));
  hd_.step();
  EXPECT_EQ(left.read(2, 0.002).fault, Fault::kNone);
  let_run();
}

TEST_F(Touch, TwoHandsWithOneNameAreRefusedAndTheFirstGoesOn) {
  TouchDevice device("");
  EXPECT_THAT(touch_refusal(), AllOf(HasSubstr("device touch: the default device is another hand's already"),
                                     HasSubstr("--device touch:NAME")));
  EXPECT_THAT(touch_refusal("Middle"), HasSubstr("\"Middle\" cannot be opened"));
  hold();
  give(device, Vec3(1.0, 0.0, 0.0));
  EXPECT_THAT(force_at_the_arm(), ElementsAre(1.0, 0.0, 0.0));
  let_run();
}

TEST_F(Touch, EachErrorAtTheOpeningIsReportedWithWhatToDo) {
  const std::pair<unsigned, const char*> errors[] = {
      {0x0200, "let the arm rest"},    {0x0201, "max_force_N"},
      {0x0202, "max_slew_N_per_ms"},   {0x0203, "more slowly"},
      {0x0204, "off and on"},          {0x0300, "Touch_Diagnostic"},
      {0x0301, "--device touch:NAME"}, {0x0302, "sudo usermod -aG dialout $USER"},
      {0x0303, "Touch_Setup"},         {0x0304, "end other programs"},
      {0x0402, "reset the fault"},     {0x0501, "end other programs"},
      {0x0600, "install the licence"}, {0x0777, "OpenHaptics error 0x0777: switch the arm off and on"},
  };
  for (const auto& [code, mend] : errors) {
    EXPECT_THAT(describe_hd_error(code), HasSubstr(mend));
    hd_.arm([code = code](HdArm& arm) { arm.init_error = code; });
    EXPECT_THAT(touch_refusal(),
                AllOf(HasSubstr("device touch: the default device cannot be opened: "), HasSubstr(mend)));
    hd_.arm([code = code](HdArm& arm) {
      arm.init_error = 0;
      arm.enable_error = code;
    });
    EXPECT_THAT(touch_refusal(), AllOf(HasSubstr("cannot switch its force on"), HasSubstr(mend)));
    hd_.arm([](HdArm& arm) { arm.enable_error = 0; });
    hd_.set([code = code](HdWorld& world) { world.start_error = code; });
    EXPECT_THAT(touch_refusal(),
                AllOf(HasSubstr("the vendor's scheduler cannot be started"), HasSubstr(mend)));
    hd_.set([](HdWorld& world) { world.start_error = 0; });
  }
  hd_.arm([](HdArm& arm) { arm.frame_error = 0x0302; });
  EXPECT_THAT(touch_refusal(), HasSubstr("the arm does not communicate"));
}

TEST_F(Touch, ASchedulerThatCallsNothingBackIsRefused) {
  hd_.set([](HdWorld& world) { world.silent = true; });
  EXPECT_THAT(touch_refusal(), HasSubstr("the vendor's scheduler called nothing back for 500 ms"));
}

TEST_F(Touch, CalibratesInTheStyleThatTheArmGives) {
  hd_.arm([](HdArm& arm) {
    arm.calibration = 0x5001;
    arm.calibration_style = 2;
  });
  TouchDevice device("");
  EXPECT_EQ(device.read(0, 0.0).fault, Fault::kNone);
  EXPECT_EQ(hd_.arm([](const HdArm& arm) { return arm.updates; }), 1);
  EXPECT_EQ(hd_.arm([](const HdArm& arm) { return arm.update_style; }), 2U);
}

TEST_F(Touch, ACalibrationThatNeedsAHandIsRefusedWithWhatTheHandShouldDo) {
  hd_.arm([](HdArm& arm) { arm.calibration = 0x5002; });
  EXPECT_THAT(touch_refusal(), HasSubstr("the arm is not calibrated: put the stylus into the inkwell"));
  hd_.arm([](HdArm& arm) { arm.calibration_style = 1; });
  EXPECT_THAT(touch_refusal(), HasSubstr("hold the arm in its reset position"));
  hd_.arm([](HdArm& arm) { arm.calibration_style = 2; });
  EXPECT_THAT(touch_refusal(), HasSubstr("through its whole workspace"));
  EXPECT_EQ(hd_.arm([](const HdArm& arm) { return arm.updates; }), 0);
}

TEST_F(Touch, ACalibrationThatNeverEndsIsRefused) {
  hd_.arm([](HdArm& arm) { arm.calibration = arm.after_update = 0x5001; });
  EXPECT_THAT(touch_refusal(), HasSubstr("the arm is not calibrated"));
}

TEST_F(Touch, TakesANameOfTouchSetupAndNeverAPath) {
  for (const char* name : {"/tmp/libHD.so", "./libHD.so", "..", "a\\b", "a\nb"}) {
    EXPECT_THAT(touch_refusal(name), HasSubstr("must be the arm's name in Touch_Setup"));
  }
  EXPECT_THAT(touch_refusal(std::string(65, 'a')), HasSubstr("at most 64 letters"));
  EXPECT_EQ(touch_refusal("Left"), "");
}

TEST_F(Touch, ALibraryThatIsNotInstalledOrLacksAFunctionIsRefusedInWords) {
  EXPECT_THAT(touch_refusal("", "libHD_of_nobody.so"),
              AllOf(HasSubstr("libHD_of_nobody.so is not installed"), HasSubstr("sudo ldconfig")));
  EXPECT_THAT(touch_refusal("", PALPATE_HD_STAND_IN_NO_FORCE), HasSubstr("has no function hdSetDoublev"));
  EXPECT_THAT(touch_refusal("", "/dev/null"), HasSubstr("/dev/null: cannot be loaded"));
}

TEST_F(Touch, TheProbeOpensNoArm) {
  const Probe there = probe_touch();
  EXPECT_TRUE(there.available);
  EXPECT_THAT(there.text, HasSubstr("libHD.so is there"));
  const Probe missing = probe_touch("libHD_of_nobody.so");
  EXPECT_FALSE(missing.available);
  EXPECT_FALSE(missing.library);
  EXPECT_EQ(missing.text.find("device touch"), std::string::npos);
  EXPECT_THAT(missing.text, HasSubstr("is not installed"));
  EXPECT_EQ(hd_.arm([](const HdArm& arm) { return arm.opens; }), 0);
}

TEST_F(Touch, IsOpenedByAScenesHandsAndOutsideAScene) {
  EXPECT_TRUE(scene::find_device_kind("touch")->held);
  EXPECT_FALSE(scene::find_device_kind("touch")->torque);
  hd_.arm([](HdArm& arm) { arm.position[0] = 20.0; }, 1);
  scene::Scene scene;
  scene.devices.resize(2);
  for (scene::DeviceSetup& device : scene.devices) device.kind = "touch";
  scene.devices[1].path = "Left";
  {
    const auto right = open_device(scene, 0);
    const auto left = open_device(scene, 1);
    EXPECT_EQ(right->read(0, 0.0).position_D.x(), 0.0);
    EXPECT_EQ(left->read(0, 0.0).position_D.x(), 0.02);
    EXPECT_EQ(left->last_tick(1000.0), ~std::uint64_t{0});
  }
  EXPECT_THAT(open_connected("touch:Left").name, HasSubstr("Stand-in Touch"));
}

TEST_F(Touch, TheLoopAndTheVendorsThreadNeverWaitForEachOther) {
  TouchDevice device("");
  for (std::uint64_t tick = 0; tick < 20'000; ++tick) {
    const haptics::DeviceState state = device.read(tick, 1e-3 * static_cast<double>(tick));
    ASSERT_EQ(state.fault, Fault::kNone);
    ASSERT_TRUE(device.write({Vec3(0.0, 0.0, 1.0), Vec3::Zero(), 0.0}));
  }
  EXPECT_GT(hd_.arm([](const HdArm& arm) { return arm.frames; }), 0U);
}

}  // namespace
}  // namespace palpate::devices

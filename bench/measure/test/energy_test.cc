// Tests the energy bound of docs/safety.md with stiff, rough, adhesive and breathing tissue under an emulated
// hand that presses and rubs. No case without a warning of the stability check may exceed the bound.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "core/contact/test/prepared_once.h"
#include "core/haptics/passivity.h"
#include "io/scene/make_world.h"
#include "palpate/mesh.h"
#include "run/devices/emulated.h"
#include "run/realtime/loop.h"

#include "bench/measure/stability.h"

namespace palpate::bench {
namespace {

constexpr double kTipRadius = 5e-3;  // m
constexpr double kRubSeconds = 4.0;

/// One hand, device and tissue.
struct Attack {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  haptics::DeviceMechanics device{1.5, 0.05, 1e-5};
  scene::HandGrip grip = scene::kFirmGrip;
  double rate_Hz = 1000.0;
  double scale = 1.0;
  double depth = 4e-3;                         // m, desired depth
  double rub = 5e-3;                           // m, radius of the circle that it rubs; 0: at rest
  double turns = 1.0;                          // per second
  double breathing = 0.0;                      // m
  double breath = 4.0;                         // s
  double max_force = 20.0;                     // N, of the gate
  std::vector<model::Inclusion> inclusions{};  // organ frame; the touched face is z = 0.03
};

struct Outcome {
  bool warned = false;  // the check warned: the case is not run
  bool faulted = false;
  double given = 0.0;           // J, largest energy given to the hand beyond that put in by hand and organ
  double bound = 0.0;           // J, bound of docs/safety.md
  double largest_change = 0.0;  // N, largest change of the commanded force between ticks while the hand
                                // presses
  std::uint64_t damped = 0;     // ticks with an active passivity controller
  double least_energy = 0.0;    // J, smallest reading of the passivity observer
  double most_force = 0.0;      // N, commanded
};

/// Rest for 0.5 s, down in 0.5 s, circles, up; in the device's lengths.
scene::ToolPath way_of(const Attack& attack) {
  std::vector<scene::PathRow> rows;
  constexpr double kClearance = 3e-3;
  for (int i = 0; i <= static_cast<int>((kRubSeconds + 2.0) * 200.0); ++i) {
    const double time = i / 200.0;
    const double in =
        std::clamp((time - 0.5) / 0.5, 0.0, 1.0) - std::clamp((time - kRubSeconds - 1.0) / 0.5, 0.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * attack.turns * std::max(0.0, time - 1.0);
    const double radius = attack.rub * std::clamp(time - 1.0, 0.0, 1.0);
    const double height = kTipRadius + kClearance - in * (kClearance + attack.depth);
    rows.push_back({time, Vec3(radius * std::cos(angle), radius * std::sin(angle), height) / attack.scale,
                    Quat::Identity(), 0.0});
  }
  return scene::ToolPath(std::move(rows));
}

scene::Scene setup_of(const Attack& attack) {
  scene::Scene scene;
  scene.name = "attack";
  scene.rate_Hz = attack.rate_Hz;
  scene.organ_name = "box";
  scene.organ = geometry::make_box(Vec3(0.08, 0.08, 0.06), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.03);
  scene.tissue = attack.tissue;
  scene.tools.push_back(
      {"ball", {{.name = "ball", .mesh = geometry::make_ball(kTipRadius, 320)}}, kTipRadius});
  scene::DeviceSetup& device = scene.devices.emplace_back();
  device.kind = "emulated";
  device.workspace_scale = attack.scale;
  device.dynamics = {attack.device.damping, attack.device.friction, attack.device.resolution};
  device.emulated.grip = attack.grip;
  scene.noise.enabled = false;
  scene.safety.max_force = attack.max_force;
  for (const model::Inclusion& one : attack.inclusions) scene.inclusions.push_back({"lump", true, one});
  if (attack.breathing > 0.0) {
    model::OrganMotionParameters motion = model::organ_motion_preset(model::OrganMotionKind::kBreathing);
    motion.amplitude = attack.breathing;
    motion.period = attack.breath;
    scene.organ_motion.push_back(motion);
  }
  return scene;
}

/// Integrates energy from the hand model, and the organ's part from its own motion.
class EnergyWatch final : public haptics::TickObserver {
 public:
  /// @param unseen K Delta [N]: force that accounts for motion below the encoder's resolution
  EnergyWatch(const Attack& attack, const haptics::SimulationWorld& world,
              const devices::EmulatedDevice& device, double unseen)
      : attack_(attack), world_(world), device_(device), unseen_(unseen) {}

  void on_row(const haptics::TickRow& row) noexcept override {
    const Pose organ = world_.organ_motion.pose_at(world_.organ_W, row.tick, world_.rate_Hz);
    const Vec3 step = (organ.position - organ_.position) / attack_.scale;
    by_organ_ += force_.dot(step);
    if (force_.norm() > 0.0) way_ += step.norm();
    organ_ = organ;
    const double given = device_.hand().work_of_force() - by_organ_;
    outcome.given = std::max(outcome.given, given);
    most_in_a_tick_ = std::max(most_in_a_tick_, std::abs(given - given_));
    given_ = given;
    const Vec3 force(row.force[0], row.force[1], row.force[2]);
    if (row.time > 2.0 && row.time < kRubSeconds) {
      outcome.largest_change = std::max(outcome.largest_change, (force - force_).norm());
    }
    force_ = force;
    outcome.least_energy = std::min(outcome.least_energy, row.energy);
    outcome.most_force = std::max(outcome.most_force, force.norm());
    if (row.fault != 0) outcome.faulted = true;
    if ((row.status & haptics::kEnergyDamped) != 0) ++outcome.damped;
    outcome.bound = haptics::kEnergyTolerance + 2.0 * most_in_a_tick_ + unseen_ * way_;
  }

  Outcome outcome;

 private:
  const Attack& attack_;
  const haptics::SimulationWorld& world_;
  const devices::EmulatedDevice& device_;
  double unseen_;
  double way_ = 0.0;  // m, motion of the organ in contact
  Pose organ_ = world_.organ_W;
  Vec3 force_ = Vec3::Zero();
  double by_organ_ = 0.0;
  double given_ = 0.0;
  double most_in_a_tick_ = 0.0;
};

Outcome outcome_of(const Attack& attack, const scene::ToolPath& path) {
  const scene::Scene scene = setup_of(attack);
  const haptics::SimulationWorld world = scene::make_world(scene, contact::test::prepared_once());
  if (!scene::stability_remarks(scene, world).empty()) return {.warned = true};
  devices::EmulatedDevice device(path, scene.devices.front(), attack.rate_Hz);
  haptics::SimulationState state(world);
  const haptics::StabilityCheck check = haptics::check_stability(
      attack.tissue,
      {.period = 1.0 / attack.rate_Hz, .max_force = scene.safety.max_force, .scale = attack.scale},
      attack.device);
  EnergyWatch watch(attack, world, device, check.stiffness * attack.device.resolution);
  realtime::LoopOptions options;
  options.ticks = device.last_tick(attack.rate_Hz);
  options.offline = true;
  std::array<haptics::Device*, 1> hands = {&device};
  static_cast<void>(realtime::run_loop(world, state, hands, {&watch}, options));
  return watch.outcome;
}

Outcome outcome_of(const Attack& attack) { return outcome_of(attack, way_of(attack)); }

std::string to_string(const Attack& a) {
  return fmt::format(
      "k1 {:g} N/m, k_t {:g} N/m, friction {:g}, b {:g}, c_t {:g} N s/m; {:g} Hz, scale {:g}; device {:g} N "
      "s/m, "
      "{:g} N, {:g} um; grip {:g} N/m; {:g} mm deep, rubbing {:g} mm at {:g} Hz, breathing {:g} mm in {:g} s",
      a.tissue.k1, a.tissue.tangential_stiffness(), a.tissue.contact.friction, a.tissue.contact.damping,
      a.tissue.contact.tangential_damping, a.rate_Hz, a.scale, a.device.damping, a.device.friction,
      a.device.resolution * 1e6, a.grip.stiffness, a.depth * 1e3, a.rub * 1e3, a.turns, a.breathing * 1e3,
      a.breath);
}

void expect_within_bound(const Attack& attack, const Outcome& outcome) {
  EXPECT_FALSE(outcome.faulted) << to_string(attack);
  EXPECT_LE(outcome.given, outcome.bound) << to_string(attack);
}

const std::vector<model::Inclusion>& three_lumps() {
  static const std::vector<model::Inclusion> kLumps = {{{12e-3, 0.0, 0.03 - 6e-3}, 4e-3, 100.0},
                                                       {{-8e-3, 9e-3, 0.03 - 5e-3}, 3e-3, 10.0},
                                                       {{-6e-3, -10e-3, 0.03 - 7e-3}, 5e-3, 0.1}};
  return kLumps;
}

Attack random_attack(std::mt19937& random) {
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto spread = [&](double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  };
  const auto in = [&](double share) { return between(0.0, 1.0) < share; };
  Attack attack;
  attack.tissue.k1 = spread(5.0, 3e3);
  attack.tissue.contact.friction = in(0.3) ? spread(0.01, 10.0) : between(0.0, 0.6);
  if (in(0.7)) attack.tissue.contact.tangential_stiffness = spread(10.0, 1e4);
  attack.tissue.contact.damping = between(0.0, 1.0);
  attack.tissue.contact.tangential_damping = in(0.5) ? 0.0 : between(0.0, 1.0);
  attack.device = {spread(0.3, 8.0), between(0.0, 0.2), spread(1e-6, 3e-5)};
  attack.grip = in(0.5) ? scene::kLightGrip : scene::kFirmGrip;
  attack.rate_Hz = in(0.7) ? 1000.0 : 4000.0;
  attack.scale = in(0.5) ? 1.0 : between(0.5, 3.0);
  attack.depth = between(1e-3, 8e-3);
  attack.rub = in(0.3) ? 0.0 : between(0.0, 10e-3);
  attack.turns = between(0.2, 4.0);
  attack.breathing = in(0.5) ? 0.0 : between(1e-3, 15e-3);
  attack.breath = between(1.0, 6.0);
  if (in(0.5)) attack.inclusions = three_lumps();
  return attack;
}

// Environment variable PALPATE_SAMPLES sets the number of cases, for example 1000.
TEST(Energy, NoRandomCaseBreaksTheBoundUnwarned) {
  const char* const wanted = std::getenv("PALPATE_SAMPLES");
  const int cases = wanted != nullptr ? std::atoi(wanted) : 60;
  std::mt19937 random(7);
  int unwarned = 0;
  for (int i = 0; i < cases; ++i) {
    const Attack attack = random_attack(random);
    const Outcome outcome = outcome_of(attack);
    if (outcome.warned) continue;
    ++unwarned;
    expect_within_bound(attack, outcome);
  }
  EXPECT_GT(unwarned, cases / 5);
  RecordProperty("unwarned", unwarned);
}

TEST(Energy, NoStiffRoughOrBreathingCaseBreaksTheBoundUnwarned) {
  int cases = 0;
  for (const double k1 : {18.0, 400.0, 2e4, 2.1e6, 1e9}) {
    for (const double friction : {0.0, 0.2, 1.0, 10.0}) {
      for (const double tangential : {100.0, 1e3, 1e5}) {
        for (const double breathing : {0.0, 10e-3}) {
          Attack attack;
          attack.tissue.k1 = k1;
          attack.tissue.contact.friction = friction;
          attack.tissue.contact.tangential_stiffness = tangential;
          attack.breathing = breathing;
          const Outcome outcome = outcome_of(attack);
          expect_within_bound(attack, outcome);
          if (k1 >= 2e4 || (tangential > 1e4 && friction > 0.0)) {
            EXPECT_TRUE(outcome.warned) << to_string(attack);
          }
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 120);
}

TEST(Energy, ABreathingOrganIsFeltWithoutTheControllerAndWithoutBuzz) {
  for (const char* name : {"gallbladder", "heart", "liver", "kidney"}) {
    for (const double rub : {0.0, 5e-3}) {
      Attack attack;
      attack.tissue = model::tissue_preset(name);
      attack.breathing = 10e-3;
      attack.rub = rub;
      const Outcome outcome = outcome_of(attack);
      EXPECT_FALSE(outcome.warned) << name;
      EXPECT_EQ(outcome.damped, 0U) << name;
      EXPECT_LT(outcome.largest_change, 0.02) << name << ": N a tick";
      expect_within_bound(attack, outcome);
    }
  }
}

/// Closed paths over every lump: down beside it, along the tissue to its middle, up; and the same backwards.
scene::ToolPath slides(const Attack& attack) {
  std::vector<scene::PathRow> rows;
  double time = 1.0;
  const auto go = [&](double x, double y, double depth, double seconds) {
    time += seconds;
    rows.push_back({time, Vec3(x, y, kTipRadius - depth) / attack.scale, Quat::Identity(), 0.0});
  };
  constexpr double kAbove = -3e-3;      // m
  for (const double at : {0.0, 1.0}) {  // still, until the force ramp is up
    rows.push_back({at, Vec3(0.0, 0.0, kTipRadius - kAbove) / attack.scale, Quat::Identity(), 0.0});
  }
  for (const model::Inclusion& lump : three_lumps()) {
    const double x = lump.centre_S.x();
    const double y = lump.centre_S.y();
    const double aside = y + 9e-3;
    for (const bool inwards : {true, false}) {
      const double from = inwards ? aside : y;
      const double to = inwards ? y : aside;
      go(x, from, kAbove, 0.3);
      go(x, from, attack.depth, 0.2);
      go(x, to, attack.depth, 0.2);
      go(x, to, kAbove, 0.2);
    }
  }
  return scene::ToolPath(std::move(rows));
}

TEST(Energy, AHeldDeviceGetsNoEnergyFromLumpsAndNoForceAboveTheLimit) {
  for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
    for (const bool dissipates : {false, true}) {
      for (const double limit : {0.1, 20.0}) {
        Attack attack;
        attack.tissue = model::tissue_preset("kidney");
        attack.tissue.contact.friction = dissipates ? 0.3 : 0.0;
        if (dissipates) attack.tissue.relaxation = {{0.3, 0.05}, {0.25, 0.4}};
        attack.grip = grip;
        attack.depth = 10e-3;
        attack.max_force = limit;
        attack.inclusions = three_lumps();
        const Outcome outcome = outcome_of(attack, slides(attack));
        EXPECT_FALSE(outcome.warned);
        EXPECT_GE(outcome.least_energy, -1e-6) << to_string(attack);
        EXPECT_LE(outcome.most_force, limit * (1.0 + 1e-12)) << to_string(attack);
        EXPECT_GT(outcome.most_force, 0.09) << "the hand feels the tissue";
        expect_within_bound(attack, outcome);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::bench

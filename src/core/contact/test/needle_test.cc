// A needle in layered tissue: puncture, slip, withdrawal, energy. Expected values are from the element's
// definition (docs/needle.md), with the law of docs/model.md.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"
#include "palpate/builtin.h"
#include "palpate/units.h"

namespace palpate::contact::test {
namespace {

constexpr double kLength = 90e-3;  // of the needle [m]

geometry::TriangleMesh thick_block() { return block(Vec3(100e-3, 100e-3, 100e-3), 10e-3); }

model::TissueLayer layer(const std::string& name, double thickness, double puncture, double cutting) {
  model::TissueLayer made;
  made.name = name;
  made.thickness = thickness;
  made.puncture_force = puncture;
  made.cutting_force = cutting;
  made.friction = 0.2;
  made.friction_per_length = 20.0;
  made.lateral_stiffness = 1e4;
  return made;
}

constexpr double kOpen = std::numeric_limits<double>::infinity();

model::TissueParameters one_layer() {
  model::TissueParameters tissue = plain_tissue();
  tissue.k1 = 100.0;
  tissue.layers = {layer("muscle", kOpen, 2.0, 0.8)};
  return tissue;
}

model::TissueParameters two_layers() {
  model::TissueParameters tissue = one_layer();
  tissue.layers = {layer("skin", 12e-3, 2.0, 0.9), layer("muscle", kOpen, 1.6, 0.4)};
  return tissue;
}

/// A needle above the block, tip down; `position` is that of its tip.
class NeedleRig {
 public:
  explicit NeedleRig(const model::TissueParameters& tissue, double rate_Hz = 1000.0)
      : rig_(thick_block(), geometry::make_tool("needle"), tissue, rate_Hz), rate_Hz_(rate_Hz) {
    at(Vec3(0, 0, 5e-3));
  }

  const ToolResult& at(const Vec3& tip, const Quat& turn = Quat::Identity()) {
    tip_ = tip;
    const Quat down = turn * Quat(0.0, 1.0, 0.0, 0.0);
    const ToolResult& result = rig_.tick({down, tip - down * Vec3(0, 0, kLength)});
    punctures += result.needle.punctured ? 1 : 0;
    exits += result.needle.left ? 1 : 0;
    return result;
  }
  /// Straight to `goal` [m] of the tip's height at `speed` [m/s].
  const ToolResult& to(double z, double speed = 5e-3) {
    const Vec3 from = tip_;
    const int ticks = std::max(1, static_cast<int>(std::abs(z - from.z()) / speed * rate_Hz_));
    for (int i = 1; i <= ticks; ++i) at({from.x(), from.y(), from.z() + (z - from.z()) * i / ticks});
    return rig_.result();
  }
  [[nodiscard]] const ToolResult& result() const { return rig_.result(); }
  [[nodiscard]] Rig& rig() { return rig_; }

  int punctures = 0;
  int exits = 0;

 private:
  Rig rig_;
  double rate_Hz_;
  Vec3 tip_ = Vec3::Zero();
};

TEST(Needle, BeforeThePunctureItPressesAsTheSameToolWithoutLayers) {
  model::TissueParameters plain = one_layer();
  plain.layers.clear();
  NeedleRig layered(one_layer());
  NeedleRig without(plain);
  const double deepest = -0.98 * layered.rig().world().press_law().deformation_under(2.0).depth;
  for (double z = 5e-3; z > deepest; z -= 0.1e-3) {
    layered.at(Vec3(0, 0, z));
    without.at(Vec3(0, 0, z));
    ASSERT_EQ(layered.result().force_W, without.result().force_W) << z;
    ASSERT_EQ(layered.result().distance, without.result().distance) << z;
  }
  EXPECT_EQ(layered.result().phase, Phase::kPress);
}

TEST(Needle, ThePunctureIsAtThePunctureForceAndTheForceFallsToCuttingAndFriction) {
  NeedleRig needle(one_layer());
  double peak = 0.0;
  needle.rig().each_tick([&](const ToolResult& result) { peak = std::max(peak, result.force_W.z()); });
  needle.to(-40e-3);
  EXPECT_EQ(needle.punctures, 1);
  EXPECT_NEAR(peak, 2.0, 0.02);
  const InsertedNeedle& inside = needle.result().needle;
  const double friction = 0.2 + 20.0 * inside.length;
  EXPECT_NEAR(needle.result().force_W.z(), 0.8 + friction, 0.005);
  EXPECT_NEAR(inside.tip_force, 0.8, 0.005);
  EXPECT_EQ(inside.layer, 1U);
  EXPECT_EQ(inside.slip, 1);
  // The tissue at the entry is displaced by the law's depth at this force; the rest of the way is inside.
  const double displaced = needle.rig().world().press_law().deformation_under(0.8 + friction).depth;
  EXPECT_NEAR(inside.length, 40e-3 - displaced, 0.1e-3);
  EXPECT_EQ(needle.result().phase, Phase::kInsert);
}

TEST(Needle, ATurnFirstUnloadsTheTissueAndThenDrawsItOutWithTheFriction) {
  NeedleRig needle(one_layer());
  needle.to(-40e-3);
  const double length = needle.result().needle.length;
  needle.to(-39.8e-3);
  EXPECT_EQ(needle.result().needle.slip, 0);
  EXPECT_EQ(needle.result().needle.length, length);
  needle.to(-20e-3);
  const InsertedNeedle& inside = needle.result().needle;
  EXPECT_EQ(inside.slip, -1);
  EXPECT_NEAR(needle.result().force_W.z(), -(0.2 + 20.0 * inside.length), 0.005);
  EXPECT_EQ(inside.tip_force, 0.0);
  EXPECT_TRUE(needle.result().views[0].pull);  // the surface is drawn outwards
}

TEST(Needle, PulledOutTheForceFadesToZeroWithoutAStepAndItExitsOnce) {
  NeedleRig needle(one_layer());
  needle.to(-40e-3);
  needle.to(-20e-3);
  StepMeter meter;
  needle.rig().each_tick([&](const ToolResult& result) { meter(result); });
  needle.to(5e-3);
  EXPECT_EQ(needle.exits, 1);
  EXPECT_EQ(needle.result().force_W, Vec3::Zero());
  EXPECT_EQ(needle.result().phase, Phase::kApproach);
  // It snaps off by at most (1 mm + L)/20 in a tick, with L < 1 mm and 100 N/m: 10 mN, and 0.5 mN of motion.
  EXPECT_LT(meter.force_step() * meter.peak_force(), 0.0106);
  needle.to(-40e-3);  // and it can go in again
  EXPECT_EQ(needle.punctures, 2);
}

TEST(Needle, InTheChannelThatItHasCutOnlyFrictionHoldsIt) {
  NeedleRig needle(one_layer());
  needle.to(-40e-3);
  const double cut = needle.result().needle.length;
  needle.to(-15e-3);
  needle.to(-28e-3);
  const InsertedNeedle& inside = needle.result().needle;
  ASSERT_LT(inside.length, cut);
  EXPECT_EQ(inside.slip, 1);
  EXPECT_NEAR(needle.result().force_W.z(), 0.2 + 20.0 * inside.length, 0.005);
  EXPECT_EQ(inside.tip_force, 0.0);
}

TEST(Needle, TheNextMembraneIsIndentedUntilItsForceAtTheDepthOfItsLayer) {
  NeedleRig needle(two_layers());
  needle.to(5e-3 - 9e-3);
  double before = 0.0;  // shaft inside and force at the second puncture
  double force = 0.0;
  int seen = 0;
  ToolResult last;
  needle.rig().each_tick([&](const ToolResult& result) {
    if (result.needle.punctured && ++seen == 2) {
      before = last.needle.length;
      force = last.force_W.z();
    }
    last = result;
  });
  needle.to(-50e-3);
  EXPECT_EQ(seen, 2);
  EXPECT_NEAR(before, 12e-3, 1e-5);  // straight down: the layer's thickness
  EXPECT_NEAR(force, 1.6 + 0.2 + 20.0 * 12e-3, 0.02);
  const double muscle = needle.result().needle.length - 12e-3;
  EXPECT_EQ(needle.result().needle.layer, 2U);
  EXPECT_NEAR(needle.result().force_W.z(), 0.4 + 0.4 + 20.0 * (12e-3 + muscle), 0.005);
}

TEST(Needle, ObliquelyTheLayerIsThickerByTheCosine) {
  NeedleRig needle(two_layers());
  const double angle = 30.0 * std::numbers::pi / 180.0;
  const Quat turn(std::cos(angle / 2.0), 0.0, std::sin(angle / 2.0), 0.0);
  const Vec3 along = turn * Vec3(0, 0, -1);
  double second = 0.0;
  double last = 0.0;
  int seen = 0;
  needle.rig().each_tick([&](const ToolResult& result) {
    if (result.needle.punctured && ++seen == 2) second = last;
    last = result.needle.length;
  });
  for (double way = -5e-3; way < 60e-3; way += 5e-6) needle.at(way * along, turn);
  EXPECT_EQ(seen, 2);
  // The entry is where the press has dragged the surface to, within the first indentation's depth.
  EXPECT_NEAR(second, 12e-3 / std::cos(angle), 0.5e-3);
}

TEST(Needle, AStoneStopsTheTipAndBesideItTheNeedleGoesOn) {
  model::TissueVariation with_stone;
  with_stone.inclusions.push_back({Vec3(0, 0, -25e-3), 5e-3, 100.0});
  const World world(thick_block(), {geometry::make_tool("needle")}, one_layer(), 1e-3, prepared_once(),
                    with_stone);
  for (const double x : {0.0, 12e-3}) {
    State state(world);
    ToolResult result;
    for (double z = 5e-3; z > -33e-3; z -= 5e-6) {
      const ToolInput input{{Quat(0.0, 1.0, 0.0, 0.0), Vec3(x, 0, z + kLength)}, 0.0};
      advance(world, {}, {&input, 1}, state, {&result, 1});
    }
    if (x == 0.0) {
      EXPECT_NEAR(result.needle.length, 20e-3, 0.1e-3);
      EXPECT_GT(result.needle.tip_force, 0.8);
    } else {
      EXPECT_GT(result.needle.length, 22e-3);
      EXPECT_NEAR(result.needle.tip_force, 0.8, 0.01);
    }
  }
}

TEST(Needle, OutOfTheFarSideItCutsNothingAndPunctureIsCounted) {
  model::TissueParameters tissue = one_layer();
  Rig rig(block(Vec3(60e-3, 60e-3, 30e-3), 10e-3), geometry::make_tool("needle"), tissue);
  int punctures = 0;
  for (double z = 5e-3; z > -60e-3; z -= 5e-6) {
    const ToolResult& result = rig.tick({Quat(0.0, 1.0, 0.0, 0.0), Vec3(0, 0, z + kLength)});
    punctures += result.needle.punctured ? 1 : 0;
  }
  EXPECT_EQ(punctures, 2);
  EXPECT_EQ(rig.result().needle.layer, 0U);
  EXPECT_NEAR(rig.result().force_W.z(), 0.2 + 20.0 * 30e-3, 0.01);
}

// The whole shaft is 10 mm. The tip bears the cutting force, the friction is 0.2 + 20 x 0.01 N, and the hub
// pushes with what the law has at 40 - 10 mm above that.
TEST(Needle, InUpToItsHubTheTipBearsItsBoundAndNothingSlips) {
  const model::TissueParameters tissue = one_layer();
  Rig rig(thick_block(), geometry::make_tool("needle:18G,10,bevel"), tissue);
  const auto at = [&](double z) -> const ToolResult& {
    return rig.tick({Quat(0.0, 1.0, 0.0, 0.0), Vec3(0, 0, z + 10e-3)});
  };
  std::uint32_t before = 0;  // status until 9 mm are inside
  for (double z = 5e-3; z > -40e-3; z -= 5e-6) {
    const ToolResult& result = at(z);
    if (result.needle.length < 9e-3) before |= result.status;
  }
  EXPECT_EQ(before & kAtHub, 0U);
  const ToolResult& pushed = at(-40e-3);
  EXPECT_EQ(pushed.status & kAtHub, kAtHub);
  EXPECT_NEAR(pushed.needle.length, 10e-3, 1e-9);
  EXPECT_EQ(pushed.needle.slip, 0);
  EXPECT_NEAR(pushed.needle.tip_force, 0.8, 1e-6);
  EXPECT_NEAR(pushed.force_W.z(), rig.world().press_law().force_at(30e-3).force, 1e-6);
}

TEST(Needle, SidewaysTheChannelHoldsTheShaftByItsSprings) {
  NeedleRig needle(one_layer());
  needle.to(-40e-3);
  const double length = needle.result().needle.length;
  const double x = 1e-3;
  for (int i = 1; i <= 100; ++i) needle.at(Vec3(x * i / 100.0, 0, -40e-3));
  EXPECT_NEAR(needle.result().force_W.x(), -1e4 * length * x, 0.01 * 1e4 * length * x);
  // Moved as a whole, the springs' mean is at half of the length: torque about the entry.
  const Vec3 torque = needle.result().torque_W;
  const Vec3 handle = needle.rig().pose().position;
  const Vec3 force = needle.result().force_W;
  const Vec3 about_entry =
      torque + handle.cross(force) + Vec3(0, x * force.z(), 0);  // without the axial force
  EXPECT_NEAR(about_entry.y(), 1e4 * length * x * length / 2.0, 0.02 * 1e4 * length * x * length);
}

/// Work of the hand on the tool in a tick, by the force at the tick's end. Poses in the organ's frame.
double work(const ToolResult& result, const Pose& organ_W, const Pose& before_S, const Pose& after_S) {
  const Quat to_organ = organ_W.rotation.conjugate();
  const Quat turn = after_S.rotation * before_S.rotation.conjugate();
  const double sign = turn.w() < 0.0 ? -2.0 : 2.0;
  return -(to_organ * result.force_W).dot(after_S.position - before_S.position) -
         (to_organ * result.torque_W).dot(sign * turn.vec());
}

/// A random walk of the tip with reversals, in and out and in again, back to where it began. Every second one
/// also moves sideways and turns, and of these every second one is on an organ that moves and turns.
class ClosedPath {
 public:
  explicit ClosedPath(unsigned seed) : random_(seed), bends_(seed % 2 == 1), moves_(seed % 4 == 3) {}

  /// Work of the hand over the path [J]. Along the needle alone the force is the gradient of a convex energy
  /// at the tick's end, so it is never negative; other motion adds errors of second order in that of a tick.
  double walk(const World& world) {
    State state(world);
    ToolResult result;
    const Vec3 start(0, 0, 3e-3);
    Vec3 tip = start;
    double angle = 0.0;
    double sum = 0.0;
    int number = 0;
    Pose before = pose_at(tip, angle);
    constexpr int kLegs = 8;
    for (int leg = 0; leg < kLegs; ++leg) {
      const bool last = leg + 1 == kLegs;
      const Vec3 goal = last ? start : Vec3(across(4e-3), across(4e-3), 5e-3 - 60e-3 * unit_(random_));
      const double goal_angle = last ? 0.0 : across(0.1);
      const int ticks = 50 + static_cast<int>(400.0 * unit_(random_));
      for (int i = 0; i <= ticks; ++i) {
        const double u = static_cast<double>(i) / ticks;
        const Pose after = pose_at(tip + u * (goal - tip), angle + u * (goal_angle - angle));
        const Pose organ_W = organ_at(number++);
        const ToolInput input{organ_W * after, 0.0};
        advance(world, organ_W, {&input, 1}, state, {&result, 1});
        sum += work(result, organ_W, before, after);
        punctures += result.needle.punctured ? 1 : 0;
        before = after;
      }
      tip = goal;
      angle = goal_angle;
    }
    return sum;
  }

  int punctures = 0;

 private:
  double across(double width) { return bends_ ? width * (unit_(random_) - 0.5) : 0.0; }
  [[nodiscard]] static Pose pose_at(const Vec3& tip, double angle) {
    const Quat turn = Quat(std::cos(angle / 2.0), 0.0, std::sin(angle / 2.0), 0.0) * Quat(0.0, 1.0, 0.0, 0.0);
    return {turn, tip - turn * Vec3(0, 0, kLength)};
  }
  [[nodiscard]] Pose organ_at(int tick) const {
    if (!moves_) return {};
    const double wave = std::sin(2.0 * std::numbers::pi * tick / 700.0);
    return {rotation_about(Vec3::UnitY(), 0.1 * wave), Vec3(0, 0, 2e-3 * wave)};
  }

  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
  bool bends_;
  bool moves_;
};

/// Trapezoid sums, so that the error is of third order in a tick's motion.
TEST(Needle, WithoutFrictionAndUncutItGivesBackExactlyWhatItTook) {
  model::TissueParameters tissue = one_layer();
  tissue.layers[0].friction = tissue.layers[0].friction_per_length = 0.0;
  tissue.layers[0].cutting_force = 1.5;
  NeedleRig needle(tissue);
  needle.to(-40e-3);
  needle.to(-36e-3);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Vec3 start(0, 0, -36e-3);
  const double unloaded = needle.result().force_W.z();
  ASSERT_GT(unloaded, 0.1);
  Vec3 tip = start;
  double angle = 0.0;
  double sum = 0.0;
  double largest = 0.0;
  for (int leg = 0; leg < 20; ++leg) {
    const bool last = leg == 19;
    const Vec3 goal = last ? start : Vec3(start + Vec3(unit(random), unit(random), unit(random)) * 1e-3);
    const double goal_angle = last ? 0.0 : 0.02 * unit(random);
    for (int i = 1; i <= 400; ++i) {
      const double u = i / 400.0;
      const Pose before = needle.rig().pose();
      const ToolResult held = needle.result();
      const double now = angle + u * (goal_angle - angle);
      needle.at(tip + u * (goal - tip), Quat(std::cos(now / 2.0), 0.0, std::sin(now / 2.0), 0.0));
      const Pose after = needle.rig().pose();
      sum += (work(held, {}, before, after) + work(needle.result(), {}, before, after)) / 2.0;
      largest = std::max(largest, std::abs(sum));
    }
    tip = goal;
    angle = goal_angle;
  }
  EXPECT_GT(largest, 0.5e-3);
  EXPECT_NEAR(sum, 0.0, 1e-6);
}

/// PALPATE_PATHS, or 60.
unsigned paths_wanted() {
  const char* text = std::getenv("PALPATE_PATHS");  // NOLINT(concurrency-mt-unsafe): no other thread yet
  return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : 60U;
}

TEST(Needle, ClosedPathsThroughManyLayersGiveNoEnergyAlsoOnAMovingOrganThatRelaxes) {
  model::TissueParameters relaxing = two_layers();
  relaxing.relaxation = {{0.4, 0.5}, {0.2, 5.0}};
  model::TissueParameters epidural = model::tissue_preset("epidural");
  epidural.relaxation = {{0.3, 0.5}};
  for (const model::TissueParameters& tissue : {two_layers(), relaxing, epidural}) {
    const World world(block(Vec3(60e-3, 60e-3, 90e-3), 10e-3), {geometry::make_tool("needle")}, tissue, 1e-3,
                      prepared_once());
    int punctures = 0;
    for (unsigned seed = 0; seed < paths_wanted(); ++seed) {
      ClosedPath path(seed);
      EXPECT_GE(path.walk(world), 0.0) << tissue.name << ", path " << seed;
      punctures += path.punctures;
    }
    EXPECT_GT(punctures, paths_wanted());
  }
}

TEST(Needle, TheTouchIsTheSameAt1And4Kilohertz) {
  NeedleRig slow(two_layers(), 1000.0);
  NeedleRig fast(two_layers(), 4000.0);
  for (int mm = 4; mm >= -45; --mm) {
    slow.to(mm * kMillimetre);
    fast.to(mm * kMillimetre);
    EXPECT_NEAR(slow.result().force_W.z(), fast.result().force_W.z(), 0.04) << mm;
    EXPECT_NEAR(slow.result().needle.length, fast.result().needle.length, 0.05e-3) << mm;
  }
}

TEST(Needle, WithoutLayersItNeverGoesIn) {
  model::TissueParameters tissue = one_layer();
  tissue.layers.clear();
  NeedleRig needle(tissue);
  needle.to(-30e-3);
  EXPECT_EQ(needle.result().phase, Phase::kPress);
  EXPECT_EQ(needle.result().needle.length, 0.0);
}

TEST(Needle, AFasterTipMeetsMoreForceOnlyWithTheRateTerm) {
  model::TissueParameters rated = one_layer();
  rated.layers[0].rate_exponent = 0.5;
  for (const double speed : {3e-3, 8e-3}) {
    NeedleRig plain(one_layer());
    NeedleRig with_rate(rated);
    plain.to(-40e-3, speed);
    with_rate.to(-40e-3, speed);
    EXPECT_NEAR(plain.result().needle.tip_force, 0.8, 0.01) << speed;
    EXPECT_NEAR(with_rate.result().needle.tip_force, 0.8 * std::sqrt(1.0 + speed / 1e-3), 0.05) << speed;
  }
}

}  // namespace
}  // namespace palpate::contact::test

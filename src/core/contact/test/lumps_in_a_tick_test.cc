// Inclusions and stiffness maps in the ticks of a ball on a flat block.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"
#include "palpate/error.h"

namespace palpate::contact::test {
namespace {

constexpr double kTickBall = 5e-3;    // m
constexpr double kTickPeriod = 1e-3;  // s
const Vec3 kBlock(100e-3, 60e-3, 40e-3);

model::Inclusion sphere_under(double x, double y, double depth, double radius, double ratio) {
  model::Inclusion inclusion;
  inclusion.centre_S = Vec3(x, y, -depth);
  inclusion.radius = radius;
  inclusion.ratio = ratio;
  return inclusion;
}

/// A ball whose lowest point is moved over the block's top, z = 0.
class Palpation {
 public:
  explicit Palpation(const model::TissueVariation& variation, model::TissueParameters tissue = plain_tissue())
      : world_(block(kBlock, 0.1), {one_part_tool(geometry::make_ball(kTickBall, 1280))}, tissue, kTickPeriod,
               prepared_once(), variation),
        state_(world_) {
    at(Vec3(0, 0, 5e-3));
  }

  /// One tick with the ball's lowest point here. @return work of the tissue on the tool in this tick [J]
  double at(const Vec3& tip) {
    const Vec3 position = tip + Vec3(0, 0, kTickBall);
    const Vec3 before = input_.pose_W.position;
    const Vec3 force_before = result_.force_W;
    input_ = {Pose{Quat::Identity(), position}, gripper};
    move_inclusions(state_, 1e-3 * static_cast<double>(tick_++));
    advance(world_, Pose{}, {&input_, 1}, state_, {&result_, 1});
    tip_ = tip;
    return 0.5 * (result_.force_W + force_before).dot(position - before);
  }
  /// Straight to `goal` at `speed` [m/s]. @return work of the tissue on the tool [J]
  double go(const Vec3& goal, double speed) {
    const Vec3 from = tip_;
    const int ticks = std::max(1, static_cast<int>(std::ceil((goal - from).norm() / (speed * kTickPeriod))));
    double work = 0.0;
    for (int i = 1; i <= ticks; ++i) work += at(from + (goal - from) * (static_cast<double>(i) / ticks));
    return work;
  }
  /// Presses at a point and waits until all depth is admitted. @return the force on the tool [N]
  Vec3 press(double x, double y, double depth) {
    go(Vec3(x, y, 5e-3), 0.1);
    go(Vec3(x, y, -depth), 0.05);
    for (int i = 0; i < 100; ++i) at(Vec3(x, y, -depth));
    return result_.force_W;
  }
  [[nodiscard]] const ToolResult& result() const { return result_; }
  State& state() { return state_; }
  World& world() { return world_; }

  double gripper = 1.0;

 private:
  World world_;
  State state_;
  ToolInput input_;
  ToolResult result_;
  Vec3 tip_ = Vec3(0, 0, 5e-3);
  long tick_ = 0;
};

TEST(LumpsInATick, AHardInclusionIsHarderAboveItAndPushesTheToolAside) {
  Palpation bench({{sphere_under(0.0, 0.0, 8e-3, 4e-3, 30.0)}, {}});
  const double far = bench.press(40e-3, 0.0, 5e-3).z();
  const Vec3 above = bench.press(0.0, 0.0, 5e-3);
  const Vec3 aside = bench.press(5e-3, 0.0, 5e-3);
  EXPECT_GT(above.z(), 1.1 * far);
  EXPECT_NEAR(above.x(), 0.0, 0.01 * far);
  EXPECT_GT(aside.z(), far);
  EXPECT_LT(aside.z(), above.z());
  EXPECT_GT(aside.x(), 0.03 * far);  // off the inclusion, which is at x = 0
  EXPECT_NEAR(aside.y(), 0.0, 0.01 * far);
}

TEST(LumpsInATick, ARatioOfOneLeavesEveryBitOfTheTicks) {
  Palpation uniform({});
  Palpation bench({{sphere_under(0.0, 0.0, 8e-3, 4e-3, 1.0), sphere_under(9e-3, 5e-3, 9e-3, 8e-3, 1.0)}, {}});
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-15e-3, 15e-3);
  std::uniform_real_distribution<double> depth(-2e-3, 10e-3);
  Vec3 from(0, 0, 5e-3);
  for (int leg = 0; leg < 40; ++leg) {
    const Vec3 to(place(random), place(random), -depth(random));
    for (int i = 1; i <= 50; ++i) {
      const Vec3 here = from + (to - from) * (i / 50.0);
      uniform.at(here);
      bench.at(here);
      ASSERT_EQ(bench.result().force_W, uniform.result().force_W);
      ASSERT_EQ(bench.result().torque_W, uniform.result().torque_W);
    }
    from = to;
  }
}

TEST(LumpsInATick, NoStepOfTheForceIsAboveOnePercentOfThePeakAtAHundredMillimetresPerSecond) {
  Palpation bench({{sphere_under(-12e-3, 1e-3, 6e-3, 4e-3, 100.0),
                    sphere_under(8e-3, -2e-3, 5e-3, 2e-3, 10.0), sphere_under(25e-3, 0.0, 10e-3, 8e-3, 0.2)},
                   {}});
  bench.press(-35e-3, 0.0, 6e-3);
  double peak = 0.0;
  double largest = 0.0;
  Vec3 before = bench.result().force_W;
  for (double x = -35e-3; x < 35e-3; x += 0.1e-3) {
    bench.at(Vec3(x, 0.0, -6e-3));
    largest = std::max(largest, (bench.result().force_W - before).norm());
    before = bench.result().force_W;
    peak = std::max(peak, before.norm());
  }
  EXPECT_LE(largest, 0.01 * peak);
}

const std::vector<model::Inclusion>& three_lumps() {
  static const std::vector<model::Inclusion> kLumps = {sphere_under(-8e-3, 2e-3, 7e-3, 4e-3, 50.0),
                                                       sphere_under(7e-3, -5e-3, 6e-3, 3e-3, 10.0),
                                                       sphere_under(4e-3, 9e-3, 9e-3, 6e-3, 0.15)};
  return kLumps;
}

// The tool rolls over the lumps at constant depth and with changing depth, and rests between. Frictionless.
double most_work_of_closed_paths(const model::TissueParameters& tissue, int paths, double& moved) {
  Palpation bench({three_lumps(), {}}, tissue);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> place(-14e-3, 14e-3);
  std::uniform_real_distribution<double> depth(1e-3, 9e-3);
  double most = -1.0;
  for (int path = 0; path < paths; ++path) {
    const auto somewhere = [&] { return Vec3(place(random), place(random), -depth(random)); };
    const Vec3 first = somewhere();
    bench.go(Vec3(first.x(), first.y(), 3e-3), 1.0);
    double work = bench.go(first, 0.02);
    Vec3 last = first;
    for (int leg = 0; leg < 4; ++leg) {
      last = somewhere();
      const double part = bench.go(last, 0.02);
      work += part;
      moved += std::abs(part);
      for (int i = 0; i < 200; ++i) work += bench.at(last);
    }
    work += bench.go(Vec3(last.x(), last.y(), 3e-3), 0.02);
    most = std::max(most, work);
  }
  return most;
}

TEST(LumpsInATick, ClosedPathsGiveNoEnergy) {
  double moved = 0.0;
  const int paths = 30;
  const double most = most_work_of_closed_paths(plain_tissue(), paths, moved);
  EXPECT_LE(most, 0.01 * moved / paths);
}

TEST(LumpsInATick, ClosedPathsOverRelaxingTissueTakeEnergy) {
  model::TissueParameters tissue = plain_tissue();
  tissue.relaxation = {{0.3, 0.05}, {0.25, 0.4}};
  double moved = 0.0;
  const int paths = 30;
  const double most = most_work_of_closed_paths(tissue, paths, moved);
  EXPECT_LE(most, 0.0);
}

TEST(LumpsInATick, TheLateralForceRelaxesByTheSharesOfTheTerms) {
  model::TissueParameters tissue = plain_tissue();
  const Vec3 elastic = Palpation({three_lumps(), {}}, tissue).press(2e-3, 0.0, 5e-3);
  tissue.relaxation = {{0.3, 0.05}, {0.25, 0.4}};
  Palpation bench({three_lumps(), {}}, tissue);
  bench.press(2e-3, 0.0, 5e-3);
  for (int i = 0; i < 8000; ++i) bench.at(Vec3(2e-3, 0.0, -5e-3));
  EXPECT_GT(elastic.head<2>().norm(), 0.01 * elastic.z());
  EXPECT_LT((bench.result().force_W - 0.45 * elastic).norm(), 1e-3 * elastic.norm());
}

TEST(LumpsInATick, AStiffnessMapOfTwoEverywhereDoublesTheForce) {
  const double uniform = Palpation({}).press(0.0, 0.0, 6e-3).z();
  model::TissueVariation twice;
  for (double x = -50e-3; x <= 50e-3; x += 10e-3) {
    for (double y = -30e-3; y <= 30e-3; y += 10e-3) twice.stiffness.push_back({Vec3(x, y, 0.0), 2.0});
  }
  EXPECT_NEAR(Palpation(twice).press(0.0, 0.0, 6e-3).z(), 2.0 * uniform, 2e-3 * uniform);
}

TEST(LumpsInATick, AStiffnessMapIsHeldAtItsPointsAndPushesTowardsTheSofterSide) {
  const double uniform = Palpation({}).press(0.0, 0.0, 6e-3).z();
  model::TissueVariation map;
  for (double x = -40e-3; x <= 40e-3; x += 10e-3) {
    for (double y = -30e-3; y <= 30e-3; y += 10e-3) {
      map.stiffness.push_back({Vec3(x, y, 0.0), std::exp(x / 40e-3)});
    }
  }
  Palpation bench(map);
  for (const double x : {-20e-3, 0.0, 20e-3}) {
    const Vec3 force = bench.press(x, 0.0, 6e-3);
    EXPECT_NEAR(force.z(), std::exp(x / 40e-3) * uniform, 0.02 * uniform);
    EXPECT_LT(force.x(), 0.0);
  }
}

TEST(LumpsInATick, AStiffnessMapRefusesAFactorOutsideItsLimitsAndAPointThatIsNotFinite) {
  const auto error_of = [](const Vec3& point, double factor) -> std::string {
    try {
      Palpation({{}, {{Vec3::Zero(), 2.0}, {point, factor}}});
    } catch (const ParameterError& error) {
      return error.what();
    } catch (const InputError& error) {
      return std::string("no parameter: ") + error.what();
    }
    return "";
  };
  const Vec3 point(10e-3, 0.0, 0.0);
  EXPECT_EQ(error_of(point, 0.009),
            "factor of point 2 of the stiffness map = 0.009: must be a number >= 0.01 and <= 100");
  for (const double factor : {101.0, -1.0, 0.0, std::nan("")}) {
    EXPECT_EQ(error_of(point, factor).rfind("factor of point 2", 0), 0U) << factor;
  }
  EXPECT_EQ(error_of(point, 0.01), "");
  EXPECT_EQ(error_of(point, 100.0), "");
  EXPECT_EQ(error_of(Vec3(std::nan(""), 0.0, 0.0), 1.0),
            "no parameter: factor of point 2 of the stiffness map: its point must be finite");
}

TEST(LumpsInATick, APulsingInclusionIsFeltAsItRises) {
  model::Inclusion vessel = sphere_under(0.0, 0.0, 6e-3, 3e-3, 10.0);
  vessel.pulse = 1e-3;
  vessel.pulse_period = 1.0;
  Palpation bench({{vessel}, {}});
  bench.press(0.0, 0.0, 3e-3);
  double least = 1e9;
  double most = 0.0;
  for (int i = 0; i < 1000; ++i) {
    bench.at(Vec3(0, 0, -3e-3));
    least = std::min(least, bench.result().force_W.z());
    most = std::max(most, bench.result().force_W.z());
  }
  EXPECT_GT(most, 1.03 * least);
}

TEST(LumpsInATick, AnInclusionMovesDuringARun) {
  const model::Inclusion lump = sphere_under(0.0, 0.0, 6e-3, 3e-3, 50.0);
  Palpation bench({{lump}, {}});
  const double above = bench.press(0.0, 0.0, 4e-3).z();
  model::Inclusion away = lump;
  away.centre_S.x() = 35e-3;
  change_inclusion(bench.state(), 0, placed_inclusion(bench.world(), 0, away));
  bench.at(Vec3(0, 0, -4e-3));
  EXPECT_LT(bench.result().force_W.z(), 0.9 * above);
  EXPECT_NEAR(bench.press(35e-3, 0.0, 4e-3).z(), above, 0.01 * above);
  away.centre_S.z() = 1e-3;
  EXPECT_THROW((void)placed_inclusion(bench.world(), 0, away), InputError) << "outside";
}

TEST(LumpsInATick, APullAboveAHardInclusionIsHarder) {
  const auto pull_at = [](double x) {
    Palpation bench({{sphere_under(0.0, 0.0, 6e-3, 4e-3, 50.0)}, {}});
    bench.go(Vec3(x, 0, 0.5e-3), 0.1);
    for (int i = 1; i <= 100; ++i) {
      bench.gripper = 1.0 - 0.01 * i;
      bench.at(Vec3(x, 0, 0.5e-3));
    }
    bench.go(Vec3(x, 0, 4e-3), 0.05);
    for (int i = 0; i < 100; ++i) bench.at(Vec3(x, 0, 4e-3));
    return -bench.result().force_W.z();
  };
  const double far = pull_at(35e-3);
  EXPECT_GT(far, 0.01);
  EXPECT_GT(pull_at(0.0), 1.2 * far);
}

}  // namespace
}  // namespace palpate::contact::test

// Both spring laws and relaxation in the tick, and their change during a run.
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"

namespace palpate::contact::test {
namespace {

constexpr double kLawRadius = 3e-3;
constexpr double kLawPeriod = 1e-3;
const model::RelaxationTerms kTwoTerms = {{0.3, 0.1}, {0.25, 1.5}};

/// A ball on a block with laws that the test can change.
struct Bench {
  explicit Bench(const model::TissueParameters& tissue, double ball_radius = kLawRadius,
                 const model::TissueVariation& variation = {})
      : radius(ball_radius),
        world(block(Vec3(60e-3, 60e-3, 40e-3), 0.1), {ball_tool(ball_radius)}, tissue, kLawPeriod,
              prepared_once(), variation),
        state(world) {
    at(Vec3(0, 0, radius + 5e-3), 1.0);
  }
  static geometry::Tool ball_tool(double radius) {
    geometry::Tool tool = one_part_tool(geometry::make_ball(radius, 320));
    tool.tip_radius = radius;
    return tool;
  }

  const ToolResult& at(const Vec3& position, double new_gripper) {
    gripper = new_gripper;
    input = {place(position), gripper};
    advance(world, Pose{}, {&input, 1}, state, {&result, 1});
    return result;
  }
  const ToolResult& at(const Vec3& position) { return at(position, gripper); }
  const ToolResult& still() { return at(input.pose_W.position); }

  /// Moves straight to `goal` in steps of 0.02 mm per tick.
  void go(const Vec3& goal) {
    const Vec3 from = input.pose_W.position;
    const int ticks = std::max(1, static_cast<int>(std::ceil((goal - from).norm() / 0.02e-3)));
    for (int i = 1; i <= ticks; ++i) at(from + (goal - from) * (static_cast<double>(i) / ticks));
  }
  /// Moves the ball's lowest point to this depth [m] and waits until all depth is admitted.
  void press(double depth) {
    go(Vec3(0, 0, -depth - lowest_z(geometry::make_ball(radius, 320))));
    for (int i = 0; i < 100; ++i) still();
  }
  void close() {
    for (int i = 1; i <= 100; ++i) at(input.pose_W.position, 1.0 - 0.01 * i);
  }
  void change(const model::TissueParameters& tissue) {
    change_tissue(world, state, TissueLaws(tissue, kLawPeriod));
  }

  double radius;
  World world;
  State state;
  ToolInput input;
  ToolResult result;
  double gripper = 1.0;
};

/// The layered law by an independent sum: layers fill in order.
double layered_by_sum(const model::TissueParameters& t, double first_limit, double depth) {
  double force = 0.0;
  double limit = first_limit;
  double slope = t.k1;
  double left = depth;
  while (left > 0.0) {
    force += slope * std::min(left, limit);
    left -= limit;
    limit *= t.q;
    slope *= 4.0 * std::exp(1.0 / t.beta);
  }
  return force;
}

/// The smooth law by Simpson's rule over its stiffness; ln K is linear between the middles of the layers.
double smooth_by_quadrature(const model::TissueParameters& t, double first_limit, double depth) {
  const auto stiffness = [&](double d) {
    double limit = first_limit;
    double middle = 0.5 * limit;
    double log_k = std::log(t.k1);
    const double step = std::log(4.0) + 1.0 / t.beta;
    double between = 0.5 * (limit + limit * t.q);
    while (d > middle + between) {
      middle += between;
      log_k += step;
      limit *= t.q;
      between = 0.5 * (limit + limit * t.q);
    }
    return std::exp(log_k + step * (d - middle) / between);
  };
  constexpr int kPieces = 4000;
  const double h = depth / kPieces;
  double sum = 0.0;
  for (int i = 0; i < kPieces; ++i) {
    sum += h / 6.0 * (stiffness(h * i) + 4.0 * stiffness(h * (i + 0.5)) + stiffness(h * (i + 1)));
  }
  return sum;
}

model::TissueParameters random_tissue(std::mt19937_64& random) {
  static constexpr const char* kNames[] = {"gallbladder", "heart", "liver", "kidney"};
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  model::TissueParameters tissue = model::tissue_preset(kNames[random() % 4]);
  tissue.law = model::LawKind::kLayered;
  tissue.contact.friction = 0.0;
  if (random() % 2 == 0) {  // otherwise the unchanged preset
    tissue.k1 *= 0.3 + unit(random);
    tissue.beta = 1.2 + 3.0 * unit(random);
    tissue.q = 0.65 + 0.3 * unit(random);
    tissue.min_length = tissue.rest_length - (6e-3 + 4e-3 * unit(random));
    tissue.max_length = tissue.rest_length + (6e-3 + 4e-3 * unit(random));
  }
  return tissue;
}

TEST(Laws, PressedTheForceIsTheClosedFormOfEitherLawAtTheDepth) {
  std::mt19937_64 random(1);
  Bench bench(plain_tissue());
  for (const double depth : {0.5e-3, 3e-3, 7.5e-3, 11e-3}) {
    bench.press(depth);
    for (int trial = 0; trial < 40; ++trial) {
      model::TissueParameters tissue = random_tissue(random);
      const double limit = tissue.rest_length - tissue.min_length;
      bench.change(tissue);
      const ToolResult layered = bench.still();
      EXPECT_NEAR(layered.depth, depth, 1e-6);
      const double by_sum = layered_by_sum(tissue, limit, layered.depth);
      ASSERT_NEAR(layered.force_W.z(), by_sum, 1e-9 * by_sum + 1e-12) << tissue.name << ' ' << depth;
      tissue.law = model::LawKind::kSmooth;
      bench.change(tissue);
      const ToolResult smooth = bench.still();
      const double by_quadrature = smooth_by_quadrature(tissue, limit, smooth.depth);
      ASSERT_NEAR(smooth.force_W.z(), by_quadrature, 1e-6 * by_quadrature) << tissue.name << ' ' << depth;
      EXPECT_EQ(smooth.cutoff_layer, layered.cutoff_layer) << "layers fill by depth in both";
    }
  }
}

TEST(Laws, PulledTheForceIsTheClosedFormOfEitherLawAtTheStretch) {
  std::mt19937_64 random(2);
  Bench bench(plain_tissue());
  bench.go(Vec3(0, 0, kLawRadius));
  bench.close();
  for (const Vec3& stretch : {Vec3(0, 0, 2e-3), Vec3(3e-3, 0, 4e-3), Vec3(-2e-3, 6e-3, 3e-3)}) {
    bench.go(Vec3(0, 0, kLawRadius) + stretch);
    for (int trial = 0; trial < 20; ++trial) {
      model::TissueParameters tissue = random_tissue(random);
      tissue.contact.grip_limit = 1e3;
      const double limit = tissue.max_length - tissue.rest_length;
      bench.change(tissue);
      const double by_sum = layered_by_sum(tissue, limit, stretch.norm());
      ASSERT_NEAR(bench.still().force_W.norm(), by_sum, 1e-6 * by_sum);
      tissue.law = model::LawKind::kSmooth;
      bench.change(tissue);
      const double by_quadrature = smooth_by_quadrature(tissue, limit, stretch.norm());
      ASSERT_NEAR(bench.still().force_W.norm(), by_quadrature, 1e-6 * by_quadrature);
      ASSERT_LT((bench.result.force_W.normalized() + stretch.normalized()).norm(), 1e-6);
    }
  }
}

/// Force of either law at a depth past 9 mm, which lies in the second layer: the tangent there stays.
double past_nine_millimetres(const model::TissueParameters& t, double depth) {
  constexpr double kLimit = 8e-3;
  constexpr double kDeepest = 9e-3;
  const double step = std::log(4.0) + 1.0 / t.beta;
  const bool smooth = t.law == model::LawKind::kSmooth;
  // Smooth: ln K is linear from the middle of layer 1, 4 mm, to that of layer 2, 8 mm + 2.8 mm.
  const double tangent = t.k1 * std::exp(smooth ? step * 5.0 / 6.8 : step);
  const double force =
      smooth ? smooth_by_quadrature(t, kLimit, kDeepest) : layered_by_sum(t, kLimit, kDeepest);
  return force + tangent * (depth - kDeepest);
}

TEST(Laws, PastTheMaxDepthATickGivesTheTangentThereAndSaysSo) {
  for (const model::LawKind law : {model::LawKind::kLayered, model::LawKind::kSmooth}) {
    model::TissueParameters tissue = plain_tissue();
    tissue.law = law;
    tissue.max_depth = 9e-3;
    tissue.contact.grip_limit = 1e3;
    Bench pressed(tissue);
    pressed.press(8.9e-3);
    EXPECT_EQ(pressed.result.status & kExtrapolated, 0U);
    pressed.press(16e-3);
    const double want = past_nine_millimetres(tissue, pressed.result.depth);
    EXPECT_NEAR(pressed.result.force_W.z(), want, 1e-6 * want);
    EXPECT_EQ(pressed.result.status, kExtrapolated);
    EXPECT_FALSE(pressed.result.saturated);
    Bench pulled(tissue);
    pulled.go(Vec3(0, 0, kLawRadius));
    pulled.close();
    pulled.go(Vec3(0, 0, kLawRadius + 16e-3));
    const double want_pulled = past_nine_millimetres(tissue, 16e-3);
    EXPECT_NEAR(-pulled.still().force_W.z(), want_pulled, 1e-6 * want_pulled);
    EXPECT_EQ(pulled.result.status, kExtrapolated);
  }
}

// Hertz: the force on a ball grows as the square root of its radius, so from 1 to 10 mm by sqrt(10) = 3.162.
TEST(Laws, TheSizeExponentScalesEveryForceByTheToolsRadiusOverTheSources) {
  model::TissueParameters tissue = plain_tissue();
  tissue.source = model::SourceParameters{"ball", 4e-3};
  tissue.contact.grip_limit = 1e3;
  tissue.size_exponent = 0.5;
  for (const double radius : {1e-3, 4e-3, 10e-3}) {
    const double factor = std::sqrt(radius / 4e-3);
    Bench pressed(tissue, radius);
    pressed.press(7e-3);  // within the first layer
    EXPECT_NEAR(pressed.result.force_W.z(), factor * 18.0 * pressed.result.depth, 1e-9) << radius;
    Bench pulled(tissue, radius);
    pulled.go(Vec3(0, 0, radius));
    pulled.close();
    pulled.go(Vec3(0, 0, radius + 5e-3));
    EXPECT_NEAR(-pulled.still().force_W.z(), factor * 18.0 * 5e-3, 1e-9) << radius;
  }
  const auto pressed_by = [&](double radius, const model::TissueVariation& variation) {
    Bench bench(tissue, radius, variation);
    bench.press(7e-3);
    return bench.result.force_W.z() / bench.result.depth;
  };
  EXPECT_NEAR(pressed_by(10e-3, {}) / pressed_by(1e-3, {}), std::sqrt(10.0), 1e-9);
  model::TissueVariation twice;  // stiffness factor 2 everywhere
  for (const double x : {-30e-3, 0.0, 30e-3}) twice.stiffness.push_back({{x, 0.0, 0.0}, 2.0});
  EXPECT_NEAR(pressed_by(10e-3, twice) / pressed_by(1e-3, twice), std::sqrt(10.0), 1e-6);
  EXPECT_NEAR(pressed_by(10e-3, twice) / pressed_by(10e-3, {}), 2.0, 1e-6);
  tissue.size_exponent = 1.0;  // flat punch
  EXPECT_NEAR(pressed_by(10e-3, {}) / pressed_by(1e-3, {}), 10.0, 1e-9);
  tissue.size_exponent = 0.0;
  EXPECT_NEAR(pressed_by(10e-3, {}), 18.0, 1e-9);
}

/// F(t) = integral G(t - s) dF_e by the midpoint rule, one sample per tick.
double by_convolution(const std::vector<double>& elastic, std::size_t end) {
  double force = 0.0;
  for (std::size_t i = 0; i < end; ++i) {
    const double age = (static_cast<double>(end - i) - 0.5) * kLawPeriod;
    double g = 1.0;
    for (const model::RelaxationTerm& term : kTwoTerms) g -= term.g * (1.0 - std::exp(-age / term.tau));
    force += g * (elastic[i + 1] - elastic[i]);
  }
  return force;
}

void expect_relaxation_of_a_held_press(model::LawKind law) {
  model::TissueParameters tissue = plain_tissue();
  tissue.law = law;
  const auto elastic_at = [&](double depth) {
    if (depth <= 0.0) return 0.0;
    return law == model::LawKind::kSmooth ? smooth_by_quadrature(tissue, 8e-3, depth)
                                          : layered_by_sum(tissue, 8e-3, depth);
  };
  tissue.relaxation = kTwoTerms;
  Bench bench(tissue);
  bench.go(Vec3(0, 0, kLawRadius));
  const double lowest = -lowest_z(geometry::make_ball(kLawRadius, 320));
  std::vector<double> elastic{0.0};
  for (int i = 1; i <= 2500; ++i) {
    const double depth = std::min(9e-3, 0.03e-3 * i);  // 30 mm/s for 0.3 s, then held
    bench.at(Vec3(0, 0, lowest - depth));
    elastic.push_back(i % 50 == 0 || i <= 300 ? elastic_at(depth) : elastic.back());
    if (i % 50 != 0) continue;
    const double want = by_convolution(elastic, elastic.size() - 1);
    ASSERT_NEAR(bench.result.force_W.z(), want, 0.01 * want) << i << " ms";
  }
  EXPECT_LT(bench.result.force_W.z(), 0.7 * elastic.back()) << "it has let go of much";
}

TEST(Laws, AHeldPressRelaxesAsTheConvolutionOfEitherLaw) {
  expect_relaxation_of_a_held_press(model::LawKind::kLayered);
  expect_relaxation_of_a_held_press(model::LawKind::kSmooth);
}

/// The hand's work on a random path within the box from `low` to `high` is never negative.
void expect_no_energy_back(Bench& bench, const Vec3& low, const Vec3& high, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double work = 0.0;
  double most = 0.0;
  Vec3 target = bench.input.pose_W.position;
  double speed = 0.1e-3;
  for (int n = 0; n < 6000; ++n) {
    if (n % 173 == 0) {
      for (int k = 0; k < 3; ++k) target[k] = low[k] + unit(random) * (high[k] - low[k]);
      speed = 0.01e-3 + 0.1e-3 * unit(random);
    }
    const Vec3 here = bench.input.pose_W.position;
    const Vec3 before = bench.result.force_W;
    const Vec3 way = target - here;
    const Vec3 next = way.norm() > speed ? Vec3(here + speed * way.normalized()) : target;
    bench.at(next);
    work -= 0.5 * (before + bench.result.force_W).dot(next - here);
    most = std::max(most, work);
    ASSERT_GE(work, -5e-3 * most - 1e-9) << n;
  }
  EXPECT_GT(most, 1e-4) << "the way must load the tissue to mean anything";
}

TEST(Laws, PressedAndRelaxingNoEnergyComesBackThatWasNotPutIn) {
  for (const model::LawKind law : {model::LawKind::kLayered, model::LawKind::kSmooth}) {
    model::TissueParameters tissue = plain_tissue();
    tissue.law = law;
    tissue.relaxation = kTwoTerms;
    Bench bench(tissue);
    bench.go(Vec3(0, 0, kLawRadius));
    expect_no_energy_back(bench, Vec3(0, 0, kLawRadius - 12e-3), Vec3(0, 0, kLawRadius + 2e-3), 3);
  }
}

TEST(Laws, PulledAnyWayAndRelaxingNoEnergyComesBackThatWasNotPutIn) {
  for (const model::LawKind law : {model::LawKind::kLayered, model::LawKind::kSmooth}) {
    model::TissueParameters tissue = plain_tissue();
    tissue.law = law;
    tissue.relaxation = kTwoTerms;
    tissue.contact.grip_limit = 1e3;
    Bench bench(tissue);
    bench.go(Vec3(0, 0, kLawRadius));
    bench.close();
    const Vec3 reach(6e-3, 6e-3, 6e-3);
    const Vec3 middle(0, 0, kLawRadius);
    expect_no_energy_back(bench, middle - reach, middle + reach, 4);
    EXPECT_EQ(bench.result.phase, Phase::kPull);
  }
}

// Stretches in 0.2 s, holds for ten time constants and returns.
TEST(Laws, AHeldStretchRelaxesAlongItsOwnDirectionAndANewHoldHasForgotten) {
  model::TissueParameters tissue = plain_tissue();
  tissue.relaxation = {{0.4, 0.5}};
  Bench bench(tissue);
  const Vec3 touch(0, 0, kLawRadius);
  bench.go(touch);
  bench.close();
  bench.go(touch + Vec3(0, 0, 4e-3));
  const double elastic = layered_by_sum(tissue, 8e-3, 4e-3);
  for (int i = 0; i < 5000; ++i) bench.still();
  EXPECT_NEAR(bench.result.force_W.z(), -0.6 * elastic, 1e-3 * elastic);
  bench.go(touch);  // in 0.2 s: the relaxed part along z pushes back along z only
  EXPECT_GT(bench.result.force_W.z(), 0.2 * elastic);
  EXPECT_LT(bench.result.force_W.head<2>().norm(), 1e-9);
  bench.at(touch, 1.0);
  for (int i = 0; i < 100; ++i) bench.still();
  bench.close();
  EXPECT_NEAR(bench.still().force_W.norm(), 0.0, 1e-9);
  EXPECT_EQ(bench.result.phase, Phase::kPull);
}

TEST(Laws, ATissueThatWasLetGoOfAndIsTouchedAgainHasForgotten) {
  model::TissueParameters tissue = plain_tissue();
  tissue.relaxation = kTwoTerms;
  Bench bench(tissue);
  bench.press(5e-3);
  const double first = bench.result.force_W.z();
  for (int i = 0; i < 2000; ++i) bench.still();
  EXPECT_LT(bench.result.force_W.z(), 0.8 * first);
  bench.go(Vec3(0, 0, kLawRadius + 1e-3));
  bench.press(5e-3);
  EXPECT_NEAR(bench.result.force_W.z(), first, 1e-3 * first);
}

TEST(Laws, ARelaxationThatIsNewHasLetNothingGoYetAndOneThatGoesGivesAllBack) {
  model::TissueParameters tissue = plain_tissue();
  Bench bench(tissue);
  bench.press(5e-3);
  const double elastic = bench.result.force_W.z();
  tissue.relaxation = {kTwoTerms[0]};
  bench.change(tissue);
  EXPECT_NEAR(bench.still().force_W.z(), elastic, 2e-3 * elastic);
  for (int i = 0; i < 1000; ++i) bench.still();
  EXPECT_NEAR(bench.result.force_W.z(), 0.7 * elastic, 1e-3 * elastic);
  tissue.relaxation = kTwoTerms;  // the first term continues, the second begins
  bench.change(tissue);
  EXPECT_NEAR(bench.still().force_W.z(), 0.7 * elastic, 3e-3 * elastic);
  tissue.relaxation.clear();
  bench.change(tissue);
  EXPECT_NEAR(bench.still().force_W.z(), elastic, 1e-12);
}

TEST(Laws, AStifferTissueInAHeldGripThatIsPastTheLimitLetsGo) {
  model::TissueParameters tissue = plain_tissue();
  Bench bench(tissue);
  bench.go(Vec3(0, 0, kLawRadius));
  bench.close();
  bench.go(Vec3(0, 0, kLawRadius + 5e-3));
  EXPECT_EQ(bench.result.status & kGripReleased, 0U);
  tissue.k1 *= 100.0;
  bench.change(tissue);
  EXPECT_EQ(bench.still().status & kGripReleased, kGripReleased);
}

TEST(Laws, OverAnEdgeARelaxedForceHasNoStepsThatAnElasticOneHasNot) {
  model::TissueParameters tissue = plain_tissue();
  double elastic_step = 0.0;
  for (const bool relaxes : {false, true}) {
    if (relaxes) tissue.relaxation = kTwoTerms;
    Rig rig(block(Vec3(60e-3, 60e-3, 40e-3), 2e-3), one_part_tool(geometry::make_ball(8e-3, 1280)), tissue);
    rig.tick(place(Vec3(20e-3, 0, 14e-3)));
    rig.move_to(Vec3(20e-3, 0, 4e-3), 10e-3);
    rig.hold(0.5);
    StepMeter meter;
    rig.each_tick([&](const ToolResult& result) { meter(result); });
    rig.move_to(Vec3(34e-3, 0, 1e-3), 10e-3);
    rig.move_to(Vec3(20e-3, 0, 4e-3), 10e-3);
    if (!relaxes) elastic_step = meter.force_step();
    EXPECT_LT(meter.force_step(), std::max(0.04, 1.5 * elastic_step)) << (relaxes ? "relaxing" : "elastic");
  }
}

}  // namespace
}  // namespace palpate::contact::test

#include "learning/environment/environment.h"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

#include "learning/environment/policy.h"

namespace palpate::learning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Environment make(const Settings& settings) {
  scene::Overrides request;
  request.organ = "box";
  request.no_noise = true;
  return Environment(scene::load(with_defaults(settings.task, request)), settings);
}

double at(std::span<const Channel> channels, std::span<const double> values, const std::string& name) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == name) return values[i];
  }
  throw std::out_of_range(name);
}

double seen(const Environment& environment, const std::string& name) {
  return at(environment.observation_channels(), environment.observation(), name);
}

double drawn(const Environment& environment, const std::string& name) {
  return at(environment.parameter_channels(), environment.parameters(), name);
}

std::string refusal(const Settings& settings) {
  try {
    (void)make(settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Presses straight down by steps of 1 mm, then rests for one, without the damping's force.
StepResult press(Environment& environment, int steps) {
  for (int i = 0; i < steps; ++i) (void)environment.step(std::vector<double>{0.0, 0.0, -1e-3});
  return environment.step(std::vector<double>(3));
}

TEST(Environment, ThePolicyBringsANeedleIntoTheLumenAndNotThroughItsFarWall) {
  Settings settings;
  settings.task = Task::kInsert;
  settings.steps = 600;
  Environment environment = make(settings);
  StepResult last = environment.reset(1);
  const std::unique_ptr<Policy> policy = make_policy(PolicyKind::kScripted, environment, 1);
  std::vector<double> action(3);
  double sum = 0.0;
  while (!last.truncated && !last.terminated) {
    policy->act(last, action);
    last = environment.step(action);
    sum += last.reward;
  }
  EXPECT_TRUE(last.truncated);
  EXPECT_EQ(last.reward, 1.0);
  EXPECT_GT(sum, 100.0);
  EXPECT_GT(seen(environment, "inserted"), 4.1e-3);
  EXPECT_LT(seen(environment, "inserted"), 8.1e-3);
}

TEST(Environment, TheForceIsThatOfTheLawAtTheDepthOfTheTool) {
  Environment environment = make({});
  (void)environment.reset(1);
  const StepResult last = press(environment, 15);  // it starts 10 mm above
  EXPECT_NEAR(seen(environment, "z"), -15e-3, 1e-12);
  EXPECT_NEAR(seen(environment, "depth"), 5e-3, 1e-4);
  const model::LayeredSpringLaw law(environment.scene().tissue, model::Direction::kPress, 1e-3);
  EXPECT_NEAR(last.tissue_force, law.force_at(seen(environment, "depth")).force, 1e-9);
  EXPECT_GT(seen(environment, "force_z"), 0.0);
  EXPECT_EQ(last.tick, 10U + 160U - 1U);
}

TEST(Environment, TheRewardIsMinusTheErrorOverTheTarget) {
  Environment environment = make({});
  (void)environment.reset(1);
  const double target = drawn(environment, "target");
  EXPECT_EQ(seen(environment, "target"), target);
  EXPECT_EQ(press(environment, 1).reward, -1.0);  // in air
  const StepResult last = press(environment, 14);
  EXPECT_EQ(last.reward, -std::abs(last.tissue_force - target) / target);
}

TEST(Environment, AStiffnessFactorScalesTheForce) {
  Settings twice;
  twice.stiffness_factor = {2.0, 2.0};
  Environment soft = make({});
  Environment stiff = make(twice);
  (void)soft.reset(1);
  (void)stiff.reset(1);
  const double force = press(soft, 15).tissue_force;
  EXPECT_NEAR(press(stiff, 15).tissue_force, 2.0 * force, 1e-6 * force);
}

TEST(Environment, AnEpisodeDrawsFromItsRangesBySeedAlone) {
  Settings settings;
  settings.stiffness_factor = {0.5, 2.0};
  settings.noise_gain = {1e-5, 5e-5};
  settings.start_offset = 4e-3;
  Environment one = make(settings);
  Environment other = make(settings);
  (void)other.reset(7);  // has no effect on the next episode
  std::vector<double> factors;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    (void)one.reset(seed);
    (void)other.reset(seed);
    EXPECT_EQ(press(one, 12).tissue_force, press(other, 12).tissue_force);
    EXPECT_THAT(one.observation(), testing::ElementsAreArray(other.observation()));
    for (std::size_t i = 0; i < one.parameters().size(); ++i) {
      EXPECT_GE(one.parameters()[i], one.parameter_channels()[i].low);
      EXPECT_LE(one.parameters()[i], one.parameter_channels()[i].high);
    }
    EXPECT_NEAR(seen(one, "x"), drawn(one, "start_x"), 1e-15);
    factors.push_back(drawn(one, "stiffness_factor"));
  }
  EXPECT_NE(factors[0], factors[1]);
  EXPECT_NE(factors[1], factors[2]);
}

TEST(Environment, TheNoiseOfAnEpisodeIsInItsForceAndDiffersBySeed) {
  Settings settings;
  settings.noise_gain = {5e-5, 5e-5};
  Environment environment = make(settings);
  const auto force_in_air = [&environment](std::uint64_t seed) {
    (void)environment.reset(seed);
    (void)press(environment, 8);
    return seen(environment, "force_z");
  };
  const double first = force_in_air(1);
  EXPECT_NE(first, 0.0);
  EXPECT_NE(first, force_in_air(2));
  EXPECT_EQ(first, force_in_air(1));
}

TEST(Environment, AMarkFindsTheLumpWithinTheToleranceAlone) {
  Settings settings;
  settings.task = Task::kSearch;
  settings.tolerance = 3e-3;
  Environment environment = make(settings);
  (void)environment.reset(5);
  const double x = drawn(environment, "lump_x");
  const double y = drawn(environment, "lump_y");
  ASSERT_GT(std::hypot(x, y), 5e-3) << "this seed's lump is not under the start";
  const StepResult wrong = environment.step(std::vector<double>{0.0, 0.0, 0.0, 1.0});
  EXPECT_EQ(wrong.reward, -0.1);
  EXPECT_FALSE(wrong.terminated);
  StepResult last;
  for (int i = 0; i < 400 && !last.terminated; ++i) {
    const double away_x = x - seen(environment, "x");
    const double away_y = y - seen(environment, "y");
    const double near = std::hypot(away_x, away_y) < 2e-3 ? 1.0 : 0.0;
    last = environment.step(std::vector<double>{away_x, away_y, 0.0, near});
  }
  EXPECT_EQ(last.reward, 1.0);
  EXPECT_TRUE(last.terminated);
  EXPECT_THROW((void)environment.step(std::vector<double>(4)), std::logic_error);
}

TEST(Environment, SurfacePointsMoveUnderThePress) {
  Settings settings;
  settings.surface_points = 200;
  Environment environment = make(settings);
  (void)environment.reset(1);
  const auto moved = [&environment] {
    double sum = 0.0;
    for (const double value : environment.observation().subspan(9)) sum += value;
    return sum;
  };
  ASSERT_EQ(environment.observation().size(), 9U + 200U);
  EXPECT_EQ(moved(), 0.0);
  (void)press(environment, 15);
  EXPECT_GT(moved(), 1e-3);
}

TEST(Environment, AStepLongerThanTheHandIsFastIsShortened) {
  Environment environment = make({});
  (void)environment.reset(1);
  (void)environment.step(std::vector<double>{3.0, 4.0, 0.0});
  EXPECT_NEAR(seen(environment, "x"), 0.6e-3, 1e-15);
  EXPECT_NEAR(seen(environment, "y"), 0.8e-3, 1e-15);
}

TEST(Environment, RefusesSettingsAndActionsByNameAndValue) {
  Settings settings;
  settings.ticks = 0;
  EXPECT_EQ(refusal(settings), "ticks = 0: must be 1 to 1000");
  settings = {};
  settings.steps = 2'000'000;
  EXPECT_EQ(refusal(settings), "steps = 2000000: must be 1 to 1000000");
  settings = {};
  settings.stiffness_factor = {2.0, 0.5};
  EXPECT_EQ(refusal(settings), "stiffness_factor = 2 to 0.5: must be ascending, within 0.01 to 100");
  settings = {};
  settings.noise_gain = {0.0, 0.1};
  EXPECT_THAT(refusal(settings), HasSubstr("gain_N_m"));  // found by the limit of sigma, at the upper end
  settings = {};
  settings.start_offset = -1.0;
  EXPECT_THAT(refusal(settings), HasSubstr("start_offset = -1 to -1: must be"));
  Environment environment = make({});
  EXPECT_THROW((void)environment.step(std::vector<double>(3)), std::logic_error);  // no reset()
  (void)environment.reset(1);
  EXPECT_THROW((void)environment.step(std::vector<double>(4)), InputError);
  EXPECT_THROW((void)environment.step(std::vector<double>{0.0, 0.0, NAN}), InputError);
  EXPECT_THROW((void)parse_task("dance"), InputError);
  scene::Overrides bare;
  bare.organ = "box";
  settings = {};
  settings.task = Task::kSearch;
  EXPECT_THROW(Environment(scene::load(bare), settings), InputError);  // has no inclusion
}

TEST(Policy, TheScriptedOneSettlesNearTheTarget) {
  for (const Task task : {Task::kPress, Task::kHold}) {
    Settings settings;
    settings.task = task;
    Environment environment = make(settings);
    StepResult last = environment.reset(4);
    const auto policy = make_policy(PolicyKind::kScripted, environment, 4);
    std::vector<double> action(3);
    double late = 0.0;
    for (int i = 0; !last.truncated; ++i) {
      policy->act(last, action);
      last = environment.step(action);
      if (i >= 300) late += last.reward / 200.0;
    }
    EXPECT_GT(late, -0.1) << to_string(task);
  }
}

TEST(Policy, TheRandomOneStaysWithinItsBoundsAndTouchesTheOrgan) {
  Settings settings;
  settings.steps = 2000;
  Environment environment = make(settings);
  StepResult last = environment.reset(4);
  const auto policy = make_policy(PolicyKind::kRandom, environment, 4);
  std::vector<double> action(3);
  int touched = 0;
  while (!last.truncated) {
    policy->act(last, action);
    last = environment.step(action);
    touched += last.tissue_force > 0.0 ? 1 : 0;
    EXPECT_LE(std::abs(seen(environment, "x")), 16e-3);
    EXPECT_LE(std::abs(seen(environment, "z") + 7.5e-3), 13.5e-3);
  }
  EXPECT_GT(touched, 100);
}

TEST(Policy, TheRasterFindsTheLump) {
  Settings settings;
  settings.task = Task::kSearch;
  settings.steps = 6000;
  Environment environment = make(settings);
  int found = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    StepResult last = environment.reset(seed);
    const auto policy = make_policy(PolicyKind::kScripted, environment, seed);
    std::vector<double> action(4);
    while (!last.terminated && !last.truncated) {
      policy->act(last, action);
      last = environment.step(action);
    }
    found += last.terminated ? 1 : 0;
  }
  EXPECT_EQ(found, 5);
}

}  // namespace
}  // namespace palpate::learning

#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

constexpr double kSmoothNaN = std::numeric_limits<double>::quiet_NaN();

// The tissue of the examples in docs/model.md.
TissueParameters hand_worked_smooth() {
  TissueParameters tissue;
  tissue.k1 = 18.0;
  tissue.beta = 1.6;
  tissue.q = 0.7;
  tissue.rest_length = 10e-3;
  tissue.max_length = 17e-3;
  tissue.min_length = 5e-3;  // L_1 = 5 mm in press
  tissue.t1 = 10e-6;
  return tissue;
}

// At a period of 0.04 ms only layers with T_i < T count: 0 and 10 us (two layers), not 50 us.
constexpr double kTwoLayers = 0.04e-3;
constexpr double kOneLayer = 0.01e-3;

struct SmoothCase {
  TissueParameters tissue;
  Direction direction;
  double period;
};

std::vector<SmoothCase> many_smooth_cases() {
  std::vector<TissueParameters> tissues;
  for (const char* name : {"gallbladder", "heart", "liver", "kidney"}) {
    tissues.push_back(tissue_preset(name));
    tissues.back().max_depth.reset();  // continuation_test.cc
  }
  std::mt19937_64 random(7);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 200; ++i) {
    TissueParameters tissue;
    tissue.k1 = std::exp(between(0.0, 7.0));
    tissue.beta = between(0.3, 8.0);
    tissue.q = between(0.3, 1.3);
    tissue.rest_length = between(2e-3, 40e-3);
    tissue.max_length = tissue.rest_length * between(1.05, 3.0);
    tissue.min_length = tissue.rest_length * between(0.0, 0.95);
    tissue.t1 = std::exp(between(std::log(1e-7), std::log(1e-4)));
    tissues.push_back(tissue);
  }
  std::vector<SmoothCase> cases;
  for (const TissueParameters& tissue : tissues) {
    for (const Direction direction : {Direction::kPress, Direction::kPull}) {
      for (const double rate : {1000.0, 10000.0}) cases.push_back({tissue, direction, 1.0 / rate});
    }
  }
  return cases;
}

TEST(SmoothSpringLaw, OneLayerIsOneSpring) {  // K = k_1, so 18 N/m x 2 mm = 0.036 N
  const SmoothSpringLaw law(hand_worked_smooth(), Direction::kPress, kOneLayer);
  EXPECT_EQ(law.layers_allowed(), 1);
  EXPECT_DOUBLE_EQ(law.force_at(2e-3).force, 0.036);
  EXPECT_DOUBLE_EQ(law.force_at(2e-3).stiffness, 18.0);
  EXPECT_DOUBLE_EQ(law.deformation_under(0.036).depth, 2e-3);
  EXPECT_DOUBLE_EQ(law.max_force(), 0.09);
}

// By hand: m_1 = 2.5 mm, m_2 = 5 + 1.75 = 6.75 mm; growth (ln 4 + 1/1.6)/4.25 mm = 2.011294361/4.25 mm =
// 473.2457 1/m; K(0) = 18 e^(-473.2457 x 0.0025) = 5.51382 N/m; F(4 mm) = 5.51382 (e^1.892983 - 1)/473.2457.
TEST(SmoothSpringLaw, HandWorkedDepthInTwoLayers) {
  const SmoothSpringLaw law(hand_worked_smooth(), Direction::kPress, kTwoLayers);
  EXPECT_EQ(law.layers_allowed(), 2);
  EXPECT_NEAR(law.force_at(0.0).stiffness, 5.51382, 1e-5);
  EXPECT_NEAR(law.force_at(2.5e-3).stiffness, 18.0, 1e-12);
  EXPECT_NEAR(law.force_at(6.75e-3).stiffness, 134.5137, 1e-4);  // P_2 k_2
  EXPECT_NEAR(law.force_at(4e-3).force, 5.51382 * (std::exp(1.892983) - 1.0) / 473.2457, 2e-6);
}

TEST(SmoothSpringLaw, StiffnessAtTheMiddleOfALayerIsThatLayersSlope) {
  for (const SmoothCase& c : many_smooth_cases()) {
    const SmoothSpringLaw law(c.tissue, c.direction, c.period);
    double limit = c.tissue.first_limit(c.direction);
    double start = 0.0;
    for (int i = 0; i < law.layers_allowed(); ++i) {
      const double slope = std::pow(4.0, i) * c.tissue.k1 * std::exp(i / c.tissue.beta);
      EXPECT_NEAR(law.force_at(start + 0.5 * limit).stiffness / slope, 1.0, 1e-9);
      start += limit;
      limit *= c.tissue.q;
    }
  }
}

TEST(SmoothSpringLaw, ForceToDepthToForceIsTheIdentity) {
  for (const SmoothCase& c : many_smooth_cases()) {
    const SmoothSpringLaw law(c.tissue, c.direction, c.period);
    for (int i = 1; i <= 100; ++i) {
      const double depth = law.max_depth() * i / 100;
      const double force = law.force_at(depth).force;
      const auto back = law.deformation_under(force);
      EXPECT_NEAR(back.depth, depth, 1e-12 * law.max_depth());
      EXPECT_EQ(back.force, force);
      EXPECT_FALSE(back.saturated);
      EXPECT_NEAR(law.force_at(back.depth).force, force, 1e-10 * force);
    }
  }
}

TEST(SmoothSpringLaw, ForceIsZeroAtZeroAndRises) {
  for (const SmoothCase& c : many_smooth_cases()) {
    const SmoothSpringLaw law(c.tissue, c.direction, c.period);
    EXPECT_EQ(law.force_at(0.0).force, 0.0);
    EXPECT_EQ(law.force_at(-1e-3).force, 0.0);
    EXPECT_EQ(law.deformation_under(-1.0).depth, 0.0);
    double before = 0.0;
    for (int i = 1; i <= 200; ++i) {
      const double force = law.force_at(law.max_depth() * i / 200).force;
      EXPECT_GT(force, before);
      before = force;
    }
  }
}

TEST(SmoothSpringLaw, ElasticForceIsThatOfForceAtToTheLastBit) {
  for (const SmoothCase& c : many_smooth_cases()) {
    for (const std::optional<double> deepest : {std::optional<double>(), std::optional<double>(6e-3)}) {
      TissueParameters tissue = c.tissue;
      tissue.max_depth = deepest;
      const SmoothSpringLaw law(tissue, c.direction, c.period);
      tissue.max_depth.reset();
      const double end = SmoothSpringLaw(tissue, c.direction, c.period).max_depth();
      for (int i = -100; i <= 1200; ++i)
        ASSERT_EQ(law.elastic_force(end * i / 1000), law.force_at(end * i / 1000).force) << i;
      for (int i = -20; i <= 20; ++i) {  // where the last layer ends
        const double depth = end * (1.0 + i * 0x1p-52);
        ASSERT_EQ(law.elastic_force(depth), law.force_at(depth).force) << i;
      }
    }
  }
}

TEST(SmoothSpringLaw, ForceAndStiffnessHaveNoJumps) {
  for (const SmoothCase& c : many_smooth_cases()) {
    const SmoothSpringLaw law(c.tissue, c.direction, c.period);
    const double step = law.max_depth() * 1e-9;
    for (int i = 1; i < 300; ++i) {
      const double depth = law.max_depth() * i / 300;
      const ContactResponse a = law.force_at(depth);
      const ContactResponse b = law.force_at(depth + step);
      EXPECT_NEAR(b.stiffness / a.stiffness, 1.0, 1e-5);
      EXPECT_NEAR(b.force - a.force, a.stiffness * step, 1e-2 * a.stiffness * step + 1e-13 * a.force);
    }
  }
}

TEST(SmoothSpringLaw, StiffnessIsTheSlopeOfTheForce) {
  for (const SmoothCase& c : many_smooth_cases()) {
    const SmoothSpringLaw law(c.tissue, c.direction, c.period);
    for (int i = 1; i < 100; ++i) {
      const double depth = law.max_depth() * i / 100;
      const double h = law.max_depth() * 1e-6;
      const double slope = (law.force_at(depth + h).force - law.force_at(depth - h).force) / (2.0 * h);
      EXPECT_NEAR(slope / law.force_at(depth).stiffness, 1.0, 1e-3);
    }
  }
}

TEST(SmoothSpringLaw, SaturatesPastTheLastLayer) {
  const SmoothSpringLaw law(hand_worked_smooth(), Direction::kPress, kTwoLayers);
  EXPECT_DOUBLE_EQ(law.max_depth(), 8.5e-3);
  EXPECT_FALSE(law.force_at(8.5e-3).saturated);
  const ContactResponse past = law.force_at(9e-3);
  EXPECT_TRUE(past.saturated);
  EXPECT_EQ(past.force, law.max_force());
  EXPECT_EQ(past.stiffness, 0.0);
  const auto under = law.deformation_under(2.0 * law.max_force());
  EXPECT_TRUE(under.saturated);
  EXPECT_EQ(under.force, law.max_force());
  EXPECT_DOUBLE_EQ(under.depth, law.max_depth());
}

TEST(SmoothSpringLaw, LayersFillByDepth) {
  const SmoothSpringLaw law(hand_worked_smooth(), Direction::kPress, kTwoLayers);
  const auto state = law.deformation_under(law.force_at(6e-3).force);
  EXPECT_EQ(state.cutoff_layer, 2);
  EXPECT_DOUBLE_EQ(state.deformation[0], 5e-3);
  EXPECT_NEAR(state.deformation[1], 1e-3, 1e-12);
}

TEST(SmoothSpringLaw, NotANumberStaysNotANumber) {
  const SmoothSpringLaw law(hand_worked_smooth(), Direction::kPress, kTwoLayers);
  EXPECT_TRUE(std::isnan(law.force_at(kSmoothNaN).force));
  EXPECT_TRUE(std::isnan(law.elastic_force(kSmoothNaN)));
}

TEST(SmoothSpringLaw, RefusesWhatTheLayeredLawRefusesAndAForceWithoutEnd) {
  TissueParameters tissue = hand_worked_smooth();
  tissue.k1 = -1.0;
  EXPECT_THROW(SmoothSpringLaw(tissue, Direction::kPress, 1e-3), ParameterError);
  tissue = hand_worked_smooth();
  EXPECT_THROW(SmoothSpringLaw(tissue, Direction::kPress, 0.0), ParameterError);
  tissue.beta = 1e-2;  // the second layer's slope is 7e43 x 4 k_1; its end is far above
  tissue.q = 1e-3;     // the last piece hardly grows over L_n/2
  tissue.t1 = 1e-9;
  EXPECT_NO_THROW(SmoothSpringLaw(tissue, Direction::kPress, 1e-3));
  tissue.q = 1.9;
  tissue.beta = 1.0 / 640.0;  // layer 2: e^640 = 8.7e277 is finite; half a layer further it is not
  EXPECT_THROW(SmoothSpringLaw(tissue, Direction::kPress, 1e-3), ParameterError);
}

}  // namespace
}  // namespace palpate::model

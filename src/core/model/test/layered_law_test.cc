#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The tissue of the examples in docs/model.md: f_1 = 0.09 N, f_2 = 0.470798 N.
TissueParameters hand_worked() {
  TissueParameters tissue;
  tissue.name = "hand-worked";
  tissue.k1 = 18.0;
  tissue.beta = 1.6;
  tissue.q = 0.7;
  tissue.rest_length = 10e-3;
  tissue.max_length = 17e-3;  // L_1 = 7 mm in pull
  tissue.min_length = 5e-3;   // L_1 = 5 mm in press
  tissue.t1 = 10e-6;
  return tissue;
}

LayeredSpringLaw pressed(double rate_Hz) { return {hand_worked(), Direction::kPress, 1.0 / rate_Hz}; }

// Equations 3 to 5 layer by layer with the C library: a reference that shares no code with the law.
struct Oracle {
  TissueParameters tissue;
  double first_limit;
  int layers;

  Oracle(const TissueParameters& t, Direction direction, double period)
      : tissue(t), first_limit(t.first_limit(direction)), layers(0) {
    while (layers < LayeredSpringLaw::kMaxLayers && t.t1 * (std::pow(4.0, layers) - 1.0) / 3.0 < period)
      ++layers;
  }
  [[nodiscard]] double slope(int layer) const {
    return std::pow(4.0, layer - 1) * tissue.k1 * std::exp((layer - 1) / tissue.beta);
  }
  [[nodiscard]] double limit(int layer) const { return first_limit * std::pow(tissue.q, layer - 1); }
  [[nodiscard]] double force(double depth) const {
    double sum = 0.0;
    for (int layer = 1; layer <= layers; ++layer) {
      const double part = std::min(depth, limit(layer));
      sum += slope(layer) * part;
      depth -= part;
      if (depth <= 0.0) break;
    }
    return sum;
  }
};

// Presets and random tissues in both directions, each at four rates.
struct Case {
  TissueParameters tissue;
  Direction direction;
  double period;
};

std::vector<Case> many_cases() {
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
  std::vector<Case> cases;
  for (const TissueParameters& tissue : tissues) {
    for (const Direction direction : {Direction::kPress, Direction::kPull}) {
      for (const double rate : {1000.0, 2000.0, 4000.0, 10000.0})
        cases.push_back({tissue, direction, 1.0 / rate});
    }
  }
  return cases;
}

TEST(LayeredSpringLaw, HandWorkedForceInTheFirstLayer) {
  const auto state = pressed(1000).deformation_under(0.05);  // 0.05 / 18 m
  EXPECT_EQ(state.cutoff_layer, 1);
  EXPECT_NEAR(state.depth, 2.777778e-3, 1e-9);
  EXPECT_DOUBLE_EQ(state.stiffness, 18.0);
  EXPECT_FALSE(state.saturated);
}

TEST(LayeredSpringLaw, HandWorkedForceInTheSecondLayer) {
  const auto state = pressed(1000).deformation_under(0.5);  // 5 mm + 0.41 / 134.5137 m
  EXPECT_EQ(state.cutoff_layer, 2);
  EXPECT_NEAR(state.depth, 8.048016e-3, 1e-9);
  EXPECT_DOUBLE_EQ(state.deformation[0], 5e-3);
  EXPECT_NEAR(state.deformation[1], 3.048016e-3, 1e-9);
  EXPECT_NEAR(state.stiffness, 134.5137, 1e-4);
}

// By hand: k_3 = 18 e^(2/1.6) = 18 x 3.490343 = 62.82617 N/m, times 16 springs 1005.2188 N/m. Layers 1 and 2
// end at 8.5 mm and 0.560798 N; at 10 mm 0.560798 + 1005.2188 x 0.0015 = 2.068626 N.
TEST(LayeredSpringLaw, HandWorkedDepthInTheThirdLayer) {
  const auto response = pressed(1000).force_at(10e-3);
  EXPECT_EQ(response.cutoff_layer, 3);
  EXPECT_NEAR(response.force, 2.068626, 1e-6);
  EXPECT_NEAR(response.stiffness, 1005.2188, 1e-3);
}

// By hand: L_1 = 7 mm in pull, f_1 = 0.126 N; at 8 mm 0.126 + 134.5137 x 0.001 = 0.2605137 N.
TEST(LayeredSpringLaw, HandWorkedPullHasItsOwnLimit) {
  const LayeredSpringLaw law(hand_worked(), Direction::kPull, 1e-3);
  EXPECT_NEAR(law.force_at(8e-3).force, 0.2605137, 1e-7);
}

// (4^(i-1) - 1)/3 x 10 us: 0, 10, 50, 210, 850, 3410, 13650 us.
TEST(LayeredSpringLaw, DelayBudgetAllowsTheLayersOfTheHandWorkedTable) {
  EXPECT_EQ(pressed(1000).layers_allowed(), 5);
  EXPECT_EQ(pressed(4000).layers_allowed(), 4);
  EXPECT_EQ(pressed(2000).layers_allowed(), 4);
  EXPECT_EQ(pressed(10000).layers_allowed(), 3);
  EXPECT_EQ(pressed(100).layers_allowed(), 6);
}

TEST(LayeredSpringLaw, DelayBudgetIsStrict) {
  TissueParameters tissue = hand_worked();
  tissue.t1 = 0x1p-10;  // powers of two, so that T_3 = 5 t_1 is exact
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, 5 * 0x1p-10).layers_allowed(), 2);
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, std::nextafter(5 * 0x1p-10, 1.0)).layers_allowed(),
            3);
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, 0x1p-10).layers_allowed(), 1);
}

TEST(LayeredSpringLaw, LayersEndAtTheTable) {
  TissueParameters tissue = hand_worked();
  tissue.t1 = 1e-30;
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, 1e-3).layers_allowed(), LayeredSpringLaw::kMaxLayers);
}

TEST(LayeredSpringLaw, ALayerThatIsNotFiniteEndsTheList) {
  TissueParameters tissue = hand_worked();
  tissue.beta = 1e-3;  // e^1000 overflows
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, 1e-3).layers_allowed(), 1);
  tissue.beta = 1.6;
  tissue.q = 1e300;  // L_2 is finite, L_3 is not
  tissue.k1 = 1e-3;
  EXPECT_EQ(LayeredSpringLaw(tissue, Direction::kPress, 1e-3).layers_allowed(), 2);
}

TEST(LayeredSpringLaw, AFirstLayerThatIsNotFiniteIsRefused) {
  TissueParameters tissue = hand_worked();
  tissue.k1 = 1e308;
  tissue.max_length = 1e3;
  EXPECT_THROW(LayeredSpringLaw(tissue, Direction::kPull, 1e-3), ParameterError);
}

TEST(LayeredSpringLaw, RefusesBadTissueAndBadPeriod) {
  TissueParameters tissue = hand_worked();
  for (const double bad : {0.0, -1e-3, kInfinity, kNaN}) {
    try {
      static_cast<void>(LayeredSpringLaw(tissue, Direction::kPress, bad));
      ADD_FAILURE() << "accepted a period of " << bad;
    } catch (const ParameterError& error) {
      EXPECT_EQ(error.field(), "loop_period_s");
    }
  }
  tissue.k1 = -18.0;
  EXPECT_THROW(LayeredSpringLaw(tissue, Direction::kPress, 1e-3), ParameterError);
}

TEST(LayeredSpringLaw, NothingAtTheSurfaceAndAboveIt) {
  for (const double depth : {0.0, -0.0, -1e-3, -kInfinity}) {
    const auto response = pressed(1000).force_at(depth);
    EXPECT_EQ(response.force, 0.0);
    EXPECT_EQ(response.cutoff_layer, 1);
    EXPECT_EQ(response.stiffness, 18.0);
    EXPECT_FALSE(response.saturated);
    const auto state = pressed(1000).deformation_under(depth);
    EXPECT_EQ(state.depth, 0.0);
    EXPECT_EQ(state.force, 0.0);
    EXPECT_EQ(state.cutoff_layer, 1);
    EXPECT_EQ(state.deformation[0], 0.0);
    EXPECT_EQ(pressed(1000).deformation_at(depth).depth, 0.0);
  }
}

TEST(LayeredSpringLaw, NaNIsNotHidden) {
  EXPECT_TRUE(std::isnan(pressed(1000).force_at(kNaN).force));
  EXPECT_TRUE(std::isnan(pressed(1000).deformation_under(kNaN).force));
}

TEST(LayeredSpringLaw, AJointBelongsToTheLayerBelow) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    const Oracle oracle(c.tissue, c.direction, c.period);
    double joint = 0.0;
    for (int layer = 1; layer <= law.layers_allowed(); ++layer) {
      joint += law.deformation_under(kInfinity).deformation[static_cast<std::size_t>(layer - 1)];
      const auto at = law.force_at(joint);
      EXPECT_EQ(at.cutoff_layer, layer);
      EXPECT_FALSE(at.saturated);
      EXPECT_NEAR(at.stiffness / oracle.slope(layer), 1.0, 1e-14);
      const auto past = law.force_at(joint * (1.0 + 1e-14));
      EXPECT_EQ(past.saturated, layer == law.layers_allowed());
      EXPECT_EQ(past.cutoff_layer, std::min(layer + 1, law.layers_allowed()));
    }
  }
}

// Joints as a user types them in millimetres: 8, 8 + 5.6, 8 + 5.6 + 3.92.
TEST(LayeredSpringLaw, JointsTypedInMillimetresBelongToTheLayerBelow) {
  for (const char* name : {"gallbladder", "heart", "liver"}) {
    for (const Direction direction : {Direction::kPress, Direction::kPull}) {
      const LayeredSpringLaw law(tissue_preset(name), direction, 1e-3);
      EXPECT_EQ(law.force_at(8.0 * 1e-3).cutoff_layer, 1);
      EXPECT_EQ(law.force_at(13.6 * 1e-3).cutoff_layer, 2);
      EXPECT_EQ(law.force_at(17.52 * 1e-3).cutoff_layer, 3);
    }
  }
  // 12.75 x 1e-3 and 16.425 x 1e-3 differ by rounding from the sums of the limits, 7.5 + 5.25 and 3.675 mm.
  const LayeredSpringLaw kidney(tissue_preset("kidney"), Direction::kPress, 1e-3);
  EXPECT_EQ(kidney.force_at(12.75 * 1e-3).cutoff_layer, 2);
  EXPECT_EQ(kidney.force_at(16.425 * 1e-3).cutoff_layer, 3);
  const LayeredSpringLaw heart(tissue_preset("heart"), Direction::kPull, 1e-3);
  EXPECT_EQ(heart.deformation_under(0.12).cutoff_layer, 1);  // 15 N/m x 8 mm
  EXPECT_EQ(heart.deformation_under(0.12).deformation[0], 8e-3);
}

TEST(LayeredSpringLaw, AgreesWithTheEquationsSummedLayerByLayer) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    const Oracle oracle(c.tissue, c.direction, c.period);
    ASSERT_EQ(law.layers_allowed(), oracle.layers);
    for (int i = 0; i <= 60; ++i) {
      const double depth = law.max_depth() * i / 50.0;  // up to 1.2 times the largest depth
      const double want = oracle.force(depth);
      EXPECT_NEAR(law.force_at(depth).force, want, 1e-12 * (want + law.max_force() * 1e-3));
    }
  }
}

TEST(LayeredSpringLaw, ForceToDepthToForceIsTheIdentity) {
  std::mt19937_64 random(8);
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    for (int i = 0; i < 50; ++i) {
      const double depth = law.max_depth() * std::uniform_real_distribution<double>(0.0, 1.0)(random);
      const auto response = law.force_at(depth);
      const auto state = law.deformation_under(response.force);
      EXPECT_NEAR(state.depth, depth, 1e-15 * law.max_depth());
      EXPECT_EQ(state.cutoff_layer, response.cutoff_layer);
      EXPECT_EQ(state.stiffness, response.stiffness);
      EXPECT_NEAR(law.force_at(state.depth).force, response.force, 1e-15 * law.max_force());
    }
  }
}

TEST(LayeredSpringLaw, ForceRisesAndIsContinuous) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    const Oracle oracle(c.tissue, c.direction, c.period);
    const double step = law.max_depth() / 500;
    const double steepest = oracle.slope(law.layers_allowed());
    double previous = 0.0;
    for (int i = 1; i <= 500; ++i) {
      const double force = law.force_at(std::min(step * i, law.max_depth())).force;
      EXPECT_GT(force, previous);
      EXPECT_LE(force - previous, steepest * step * (1 + 1e-9) + 1e-13 * law.max_force());
      previous = force;
    }
    EXPECT_NEAR(previous, law.max_force(), 1e-13 * law.max_force());
  }
}

TEST(LayeredSpringLaw, StatedStiffnessIsTheSlope) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    for (int i = 1; i < 40; ++i) {
      const double depth = law.max_depth() * i / 40.0 * 0.9999;
      const double half = 1e-6 * law.max_depth();
      const auto low = law.force_at(depth - half);
      const auto high = law.force_at(depth + half);
      if (low.cutoff_layer != high.cutoff_layer) continue;
      EXPECT_NEAR((high.force - low.force) / (2 * half), law.force_at(depth).stiffness,
                  1e-9 * law.force_at(depth).stiffness + 1e-9 * law.max_force() / law.max_depth());
    }
  }
}

TEST(LayeredSpringLaw, LayersFillInOrderAndAddUpToTheDepth) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    const Oracle oracle(c.tissue, c.direction, c.period);
    for (int i = 0; i <= 24; ++i) {
      const double depth = law.max_depth() * i / 20.0;
      const double force = law.force_at(depth).force;
      for (const auto& state : {law.deformation_at(depth), law.deformation_under(force)}) {
        double sum = 0.0;
        double carried = 0.0;
        for (int layer = 1; layer <= LayeredSpringLaw::kMaxLayers; ++layer) {
          const double deformation = state.deformation[static_cast<std::size_t>(layer - 1)];
          if (layer < state.cutoff_layer) {
            EXPECT_NEAR(deformation / oracle.limit(layer), 1.0, 1e-13);
          } else if (layer > state.cutoff_layer) {
            EXPECT_EQ(deformation, 0.0);
          }
          sum += deformation;
          carried += deformation * oracle.slope(layer);
        }
        EXPECT_NEAR(sum, std::min(depth, law.max_depth()), 1e-14 * law.max_depth());
        EXPECT_NEAR(carried, force, 1e-12 * law.max_force());
        EXPECT_EQ(state.force, force);
      }
    }
  }
}

TEST(LayeredSpringLaw, PastTheLastLayerForceAndDepthHold) {
  for (const Case& c : many_cases()) {
    const LayeredSpringLaw law(c.tissue, c.direction, c.period);
    for (const double factor : {1.000001, 2.0, kInfinity}) {
      const auto response = law.force_at(law.max_depth() * factor);
      EXPECT_TRUE(response.saturated);
      EXPECT_EQ(response.force, law.max_force());
      EXPECT_EQ(response.stiffness, 0.0);
      EXPECT_EQ(response.cutoff_layer, law.layers_allowed());
      const auto under = law.deformation_under(law.max_force() * factor);
      EXPECT_TRUE(under.saturated);
      EXPECT_EQ(under.depth, law.max_depth());
      EXPECT_EQ(under.force, law.max_force());
      EXPECT_EQ(under.stiffness, 0.0);
      const auto at = law.deformation_at(law.max_depth() * factor);
      EXPECT_TRUE(at.saturated);
      EXPECT_EQ(at.depth, law.max_depth());
    }
    EXPECT_FALSE(law.deformation_under(law.max_force()).saturated);
    EXPECT_FALSE(law.force_at(law.max_depth()).saturated);
  }
}

// The rule for built-in tissues (docs/tissues.md).
TEST(TissuePresets, StayStableToTheEndOfTheirEvidenceAndEqualAtEveryRate) {
  for (const std::string name : {"gallbladder", "heart", "liver", "kidney"}) {
    for (const Direction direction : {Direction::kPress, Direction::kPull}) {
      const SpringLaw slow(tissue_preset(name), direction, 1e-3);
      const double end = *tissue_preset(name).max_depth;
      EXPECT_GE(end, 14.5e-3) << name;
      for (const double rate : {1000.0, 2000.0, 4000.0, 10000.0}) {
        const SpringLaw law(tissue_preset(name), direction, 1.0 / rate);
        for (int i = 0; i <= 1500; ++i) {
          const double depth = end * i / 1500;
          const auto response = law.force_at(depth);
          ASSERT_FALSE(response.saturated) << name << ' ' << depth;
          ASSERT_LE(response.force, 5.0) << name << ' ' << depth;
          ASSERT_LE(response.stiffness, 1200.0) << name << ' ' << depth;
          ASSERT_EQ(response.force, slow.force_at(depth).force) << name << ' ' << depth << ' ' << rate;
          ASSERT_EQ(response.stiffness, slow.force_at(depth).stiffness);
        }
      }
    }
  }
}

// By hand: 0.144 N + 134.5137 x 0.0056 N + 1005.2188 x 0.0014 N = 2.304582 N; the third layer ends at 17.52
// mm.
TEST(TissuePresets, GallbladderGivesTwoPointThreeNewtonsAtFifteenMillimetres) {
  TissueParameters tissue = tissue_preset("gallbladder");
  tissue.max_depth.reset();
  const LayeredSpringLaw law(tissue, Direction::kPress, 1e-3);
  EXPECT_NEAR(law.force_at(15e-3).force, 2.304582, 1e-5);
  EXPECT_LE(law.force_at(17.5e-3).stiffness, 1.0e3 * 1.006);  // 1.0 N/mm to the stated digits
  EXPECT_GT(law.force_at(17.53e-3).stiffness, 1.2e3);
}

// Modulus of an elastic incompressible half-space with the same force at 10 mm under a flat punch of radius a
// = 5 mm: E = (F/D) (1 - 1/4)/(2 a).
double apparent_modulus(const std::string& name) {
  constexpr double kDepth = 10e-3;
  constexpr double kPunchRadius = 5e-3;
  const SpringLaw law(tissue_preset(name), Direction::kPress, 1e-3);
  return law.force_at(kDepth).force / kDepth * 0.75 / (2 * kPunchRadius);
}

TEST(TissuePresets, KidneyIsStifferThanLiverAndBothAreOfThePublishedOrder) {
  EXPECT_GT(apparent_modulus("liver"), 1e3);
  EXPECT_LT(apparent_modulus("liver"), 6e3);
  EXPECT_GT(apparent_modulus("kidney"), 4e3);
  EXPECT_LT(apparent_modulus("kidney"), 10e3);
  const SpringLaw liver(tissue_preset("liver"), Direction::kPress, 1e-3);
  const SpringLaw kidney(tissue_preset("kidney"), Direction::kPress, 1e-3);
  for (int i = 1; i <= 150; ++i) EXPECT_GT(kidney.force_at(i * 1e-4).force, liver.force_at(i * 1e-4).force);
}

}  // namespace
}  // namespace palpate::model

// The continuation of both laws past the tissue's max_depth.
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "palpate/spring_law.h"
#include "palpate/tissue.h"

namespace palpate::model {
namespace {

constexpr std::array kBothDirections{Direction::kPress, Direction::kPull};
constexpr double kDeepestHand = 60e-3;  // m

TissueParameters with_law(const char* preset, LawKind law) {
  TissueParameters tissue = tissue_preset(preset);
  tissue.law = law;
  return tissue;
}

/// Calls `check(limited, whole, deepest)` with the law of each preset with and without its max_depth [m].
template <class Check>
void for_each_law(Check check) {
  for (const char* preset : tissue_preset_names()) {
    for (const LawKind kind : {LawKind::kLayered, LawKind::kSmooth}) {
      for (const Direction direction : kBothDirections) {
        TissueParameters tissue = with_law(preset, kind);
        SCOPED_TRACE(std::string(preset) + ' ' + to_string(kind));
        const double deepest = *tissue.max_depth;
        const SpringLaw limited(tissue, direction, 1e-3);
        tissue.max_depth.reset();
        check(limited, SpringLaw(tissue, direction, 1e-3), deepest);
      }
    }
  }
}

// By hand, the gallbladder at 15 mm: 2.304582 N at 16 x 18 N/m x e^(2/1.6) = 1005.2188 N/m. So 45 mm deeper
// it gives 2.304582 N + 1005.2188 N/m x 0.045 m, with the work 2.304582 N x 0.045 m + 1005.2188 N/m x (0.045
// m)^2/2.
TEST(Continuation, HandWorkedForceEnergyAndDepthOfTheGallbladder) {
  const LayeredSpringLaw law(tissue_preset("gallbladder"), Direction::kPress, 1e-3);
  const ContactResponse deep = law.force_at(60e-3);
  EXPECT_NEAR(deep.force, 47.53943, 1e-4);
  EXPECT_NEAR(deep.stiffness, 1005.2188, 1e-3);
  EXPECT_EQ(deep.cutoff_layer, 3);
  EXPECT_FALSE(deep.saturated);
  EXPECT_TRUE(deep.extrapolated);
  EXPECT_NEAR(law.energy_at(60e-3) - law.energy_at(15e-3), 1.121490, 1e-5);
  const auto state = law.deformation_under(47.53943);
  EXPECT_NEAR(state.depth, 60e-3, 1e-7);
  EXPECT_TRUE(state.extrapolated);
  EXPECT_NEAR(state.deformation[2], 60e-3 - 13.6e-3, 1e-7);  // layers 1 and 2 end at 8 mm + 5.6 mm
}

TEST(Continuation, WithinTheEvidenceTheLawKeepsItsBits) {
  for_each_law([](const SpringLaw& limited, const SpringLaw& whole, double deepest) {
    for (int i = 0; i <= 1000; ++i) {
      const double depth = deepest * i / 1000;
      const ContactResponse here = limited.force_at(depth);
      ASSERT_EQ(here.force, whole.force_at(depth).force) << depth;
      ASSERT_EQ(here.stiffness, whole.force_at(depth).stiffness) << depth;
      ASSERT_EQ(limited.energy_at(depth), whole.energy_at(depth)) << depth;
      ASSERT_EQ(limited.deformation_under(here.force).depth, whole.deformation_under(here.force).depth);
      ASSERT_FALSE(here.extrapolated) << depth;
    }
  });
}

TEST(Continuation, APresetIsFiniteAndRisesByAtMostTheLastTangentAsDeepAsAHandReaches) {
  for_each_law([](const SpringLaw& limited, const SpringLaw& /*whole*/, double deepest) {
    const double tangent = limited.force_at(deepest).stiffness;
    double before = 0.0;
    for (int i = 1; i <= 6000; ++i) {
      const double depth = kDeepestHand * i / 6000;
      const ContactResponse here = limited.force_at(depth);
      ASSERT_TRUE(std::isfinite(here.force)) << depth;
      ASSERT_GT(here.force, before) << depth;
      ASSERT_GT(here.stiffness, 0.0) << depth;
      ASSERT_LE(here.stiffness, tangent) << depth;
      if (depth > deepest) {
        ASSERT_EQ(here.stiffness, tangent) << depth;
      }
      ASSERT_LE(here.force - before, tangent * kDeepestHand / 6000 * (1.0 + 1e-9)) << depth;
      ASSERT_EQ(here.extrapolated, depth > deepest) << depth;
      before = here.force;
    }
  });
}

TEST(Continuation, TheEnergyIsTheIntegralOfTheForce) {
  for_each_law([](const SpringLaw& limited, const SpringLaw& /*whole*/, double deepest) {
    double work = limited.energy_at(deepest);
    constexpr int kSteps = 1000;
    const double step = (kDeepestHand - deepest) / kSteps;
    for (int i = 0; i < kSteps; ++i) work += step * limited.force_at(deepest + (i + 0.5) * step).force;
    EXPECT_NEAR(limited.energy_at(kDeepestHand), work, 1e-9 * work);
  });
}

TEST(Continuation, ForceToDepthIsTheInverse) {
  for_each_law([](const SpringLaw& limited, const SpringLaw& /*whole*/, double /*deepest*/) {
    for (int i = 1; i <= 600; ++i) {
      const double depth = kDeepestHand * i / 600;
      const ContactResponse here = limited.force_at(depth);
      const auto state = limited.deformation_under(here.force);
      ASSERT_NEAR(state.depth, depth, 1e-12) << depth;
      ASSERT_EQ(state.force, here.force) << depth;
      ASSERT_NEAR(state.stiffness, here.stiffness, 1e-9 * here.stiffness) << depth;
      const double sum = std::accumulate(state.deformation.begin(), state.deformation.end(), 0.0);
      ASSERT_NEAR(sum, depth, 1e-12) << depth;
    }
    EXPECT_EQ(limited.max_depth(), std::numeric_limits<double>::infinity());
    EXPECT_EQ(limited.max_force(), std::numeric_limits<double>::infinity());
  });
}

// At 10 us a layer and 0.04 ms a loop two layers are allowed, which end at 8 mm + 5.6 mm.
TEST(Continuation, ALawThatEndsBeforeTheEvidenceStillHolds) {
  for (const LawKind kind : {LawKind::kLayered, LawKind::kSmooth}) {
    TissueParameters tissue = with_law("gallbladder", kind);
    tissue.t1 = 10e-6;
    const SpringLaw law(tissue, Direction::kPress, 0.04e-3);
    EXPECT_NEAR(law.max_depth(), 13.6e-3, 1e-12);
    EXPECT_TRUE(std::isfinite(law.max_force()));
    const ContactResponse deep = law.force_at(20e-3);
    EXPECT_EQ(deep.force, law.max_force());
    EXPECT_EQ(deep.stiffness, 0.0);
    EXPECT_TRUE(deep.saturated);
    EXPECT_TRUE(deep.extrapolated);
    EXPECT_NEAR(law.energy_at(20e-3) - law.energy_at(15e-3), 5e-3 * law.max_force(), 1e-12);
    const auto under = law.deformation_under(2.0 * law.max_force());
    EXPECT_TRUE(under.saturated);
    EXPECT_EQ(under.depth, law.max_depth());
  }
}

TEST(Continuation, NaNStaysNaN) {
  for_each_law([](const SpringLaw& limited, const SpringLaw& /*whole*/, double /*deepest*/) {
    EXPECT_TRUE(std::isnan(limited.force_at(std::numeric_limits<double>::quiet_NaN()).force));
  });
}

}  // namespace
}  // namespace palpate::model

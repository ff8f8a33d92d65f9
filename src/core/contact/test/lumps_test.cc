// Tissue that is not uniform: inclusions and stiffness maps.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"
#include "core/contact/tool_tissue.h"
#include "palpate/error.h"

namespace palpate::contact::test {
namespace {

using model::Inclusion;
using model::InclusionLaw;

constexpr double kPi = 3.14159265358979323846;
constexpr double kBall = 5e-3;  // m

double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

struct RandomInclusion {
  double radius, depth, ratio, tip_radius;
  [[nodiscard]] InclusionLaw law() const { return {radius, depth, ratio}; }
};

RandomInclusion random_inclusion(std::mt19937_64& random) {
  RandomInclusion made{};
  made.radius = std::exp(between(random, std::log(0.5e-3), std::log(20e-3)));
  made.depth = made.radius * between(random, 1.0, 6.0);
  made.ratio = std::exp(between(random, std::log(0.1), std::log(100.0)));
  made.tip_radius = std::exp(between(random, std::log(1e-3), std::log(20e-3)));
  return made;
}

TEST(InclusionLaw, ItsSlopesAreThoseOfDifferences) {
  constexpr double kTip = 4e-3;
  constexpr double kSmall = 1e-7;  // of the changes whose effect is to first order
  constexpr double kStep = 1e-4;   // of the differences
  for (const double ratio : {0.2, 3.0, 100.0}) {
    for (const double depth : {0.5e-3, 4e-3}) {
      for (const double square : {0.0, 20e-6, 400e-6}) {
        const auto law = [ratio](double length, double height, double stiffness) {
          return model::InclusionLaw(3e-3 * (1.0 + length), 8e-3 * (1.0 + height), ratio * (1.0 + stiffness));
        };
        const model::InclusionLaw here = law(0.0, 0.0, 0.0);
        const model::PressedTip tip(kTip, depth);
        const model::InclusionLaw::Slopes slopes =
            here.slopes(tip, square, model::PressedTip(kTip, depth * (1.0 + kSmall)),
                        {law(0.0, kSmall, 0.0), law(kSmall, 0.0, 0.0), law(0.0, 0.0, kSmall)});
        const model::InclusionLaw::Extra extra = here.at(tip, square);
        EXPECT_DOUBLE_EQ(slopes.here.energy, extra.energy);
        EXPECT_NEAR(slopes.here.by_depth, extra.by_depth, 1e-12 * std::abs(extra.by_depth));
        EXPECT_NEAR(slopes.here.by_square, extra.by_square, 1e-12 * std::abs(extra.by_square));
        const auto expect_slope = [](double slope, double up, double down, double scale) {
          EXPECT_NEAR(slope, (up - down) / (2.0 * kStep), 1e-5 * std::abs(scale));
        };
        const double length = kStep * 64e-6;
        expect_slope(64e-6 * slopes.by_depth_and_square, here.at(tip, square + length).by_depth,
                     here.at(tip, square - length).by_depth, extra.by_depth);
        const auto steeper = [&](double step) {
          return here.at(model::PressedTip(kTip, depth * (1.0 + step)), square).by_depth;
        };
        expect_slope(slopes.by_depth_twice / kSmall, steeper(kStep), steeper(-kStep), extra.by_depth);
        const model::InclusionLaw up[] = {law(0.0, kStep, 0.0), law(kStep, 0.0, 0.0), law(0.0, 0.0, kStep)};
        const model::InclusionLaw down[] = {law(0.0, -kStep, 0.0), law(-kStep, 0.0, 0.0),
                                            law(0.0, 0.0, -kStep)};
        for (std::size_t i = 0; i < 3; ++i) {
          expect_slope(slopes.by_law.at(i).energy / kSmall, up[i].at(tip, square).energy,
                       down[i].at(tip, square).energy, extra.energy);
          expect_slope(slopes.by_law.at(i).by_depth / kSmall, up[i].at(tip, square).by_depth,
                       down[i].at(tip, square).by_depth, extra.by_depth);
        }
      }
    }
  }
}

// A thin layer on a stiff floor is stiffer by its contact radius over its thickness: X is in proportion to
// c / (h - a). Where c^2 is far over a (h - a), and c under a, the inclusion is pressed as if it were bare: X
// is in proportion to a / c.
TEST(InclusionLaw, ACoverActsAsALayerOnAFloorUntilTheInclusionItselfIsPressed) {
  constexpr double kRadius = 10e-3;
  const auto x_of = [](double cover, double contact) {
    constexpr double kContrast = 1e-6;  // e = kContrast X / (1 + X), as P = 1
    constexpr double kTip = 10.0;       // m, so large that c^2 = R D
    const InclusionLaw law(kRadius, kRadius + cover, 1.0 + kContrast);
    const double share = law.at(model::PressedTip(kTip, contact * contact / kTip), 0.0).energy / kContrast;
    return share / (1.0 - share);
  };
  const double narrow = x_of(0.2e-3, 4e-6);
  EXPECT_NEAR(x_of(0.2e-3, 8e-6) / narrow, 2.0, 0.01);
  EXPECT_NEAR(x_of(0.4e-3, 4e-6) / narrow, 0.5, 0.025);
  EXPECT_NEAR(x_of(0.1e-3, 2.2e-3) / x_of(0.1e-3, 4.4e-3), 2.0, 0.1);
}

TEST(Lumps, TheDerivativesOfTheLawAreThoseOfItsEnergy) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    const RandomInclusion inclusion = random_inclusion(random);
    const InclusionLaw law = inclusion.law();
    const auto at = [&](double d, double s) { return law.at(model::PressedTip(inclusion.tip_radius, d), s); };
    const double depth = between(random, 0.2e-3, 25e-3);
    const double square = std::pow(between(random, 0.0, 30e-3), 2);
    const auto energy = [&](double d, double s) { return at(d, s).energy; };
    constexpr double kStep = 1e-7;
    const InclusionLaw::Extra here = at(depth, square);
    const double by_depth = (energy(depth + kStep, square) - energy(depth - kStep, square)) / (2.0 * kStep);
    EXPECT_NEAR(here.by_depth, by_depth, 1e-6 * std::abs(by_depth) + 1e-4);
    constexpr double kArea = 1e-9;
    const double by_square = (energy(depth, square + 2.0 * kArea) - energy(depth, square)) / (2.0 * kArea);
    const double middle = at(depth, square + kArea).by_square;
    EXPECT_NEAR(middle, by_square, 1e-5 * std::abs(by_square) + 1e-2);
  }
}

TEST(Lumps, ARatioOfOneIsNoInclusion) {
  const InclusionLaw law(4e-3, 8e-3, 1.0);
  for (double depth = 0.0; depth < 20e-3; depth += 1e-3) {
    for (double s = 0.0; s < 30e-3; s += 3e-3) {
      const InclusionLaw::Extra extra = law.at(model::PressedTip(kBall, depth), s * s);
      EXPECT_EQ(extra.energy, 0.0);
      EXPECT_EQ(extra.by_depth, 0.0);
      EXPECT_EQ(extra.by_square, 0.0);
    }
  }
}

/// A flat organ with several inclusions, as one tool of 5 mm radius meets it. The place (x, y) is on z = 0.
struct FlatTissue {
  explicit FlatTissue(std::mt19937_64& random, model::LawKind kind) : laws(tissue_of(random, kind), 1e-3) {
    const std::size_t count = 1 + random() % 5;
    for (std::size_t j = 0; j < count; ++j) {
      const RandomInclusion one = random_inclusion(random);
      inclusions.push_back({Vec3(between(random, -20e-3, 20e-3), between(random, -20e-3, 20e-3), -one.depth),
                            one.depth * one.depth, one.law()});
    }
  }
  static model::TissueParameters tissue_of(std::mt19937_64& random, model::LawKind kind) {
    model::TissueParameters tissue = plain_tissue();
    tissue.law = kind;
    tissue.k1 = between(random, 5.0, 50.0);
    tissue.beta = between(random, 1.0, 4.0);
    return tissue;
  }
  [[nodiscard]] Vec3 force_at(const Vec3& tool) const {  // tool: x, y, -depth
    const ToolTissue tissue{laws, inclusions, map, kBall};
    const TissueAt place(tissue, {Vec3(tool.x(), tool.y(), 0.0), 0});
    const TissueAt::Force force = place.force_at(laws.press, -tool.z());
    return {force.lateral_S.x(), force.lateral_S.y(), force.normal};
  }
  TissueLaws laws;
  std::vector<InclusionNow> inclusions;
  StiffnessMap map;
};

// Work of the tissue along a closed path: Gauss-Legendre quadrature on the pieces of a polygon. The layered
// law's slope has steps, so its path is cut where the depth passes the end of a layer.
TEST(Lumps, AClosedPathGivesNoEnergy) {
  std::mt19937_64 random(11);
  constexpr double kNodes[] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                               0.9061798459386640};
  constexpr double kWeights[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                 0.4786286704993665, 0.2369268850561891};
  constexpr int kPieces = 60;  // of each side
  for (int loop = 0; loop < 10000; ++loop) {
    const FlatTissue tissue(random, model::LawKind::kSmooth);
    std::vector<Vec3> corners;
    for (int i = 0; i < 4; ++i) {
      corners.emplace_back(between(random, -25e-3, 25e-3), between(random, -25e-3, 25e-3),
                           between(random, -14e-3, -0.1e-3));
    }
    double work = 0.0;
    double moved = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 from = corners[i];
      const Vec3 step = (corners[(i + 1) % corners.size()] - from) / kPieces;
      for (int piece = 0; piece < kPieces; ++piece) {
        for (std::size_t k = 0; k < 5; ++k) {
          const Vec3 here = from + (piece + 0.5 * (1.0 + kNodes[k])) * step;
          const double given = 0.5 * kWeights[k] * tissue.force_at(here).dot(step);
          work += given;
          moved += std::abs(given);
        }
      }
    }
    ASSERT_LE(std::abs(work), 1e-9 + 1e-6 * moved) << "loop " << loop;
  }
}

/// Several coincident stones.
FlatTissue pile_of_stones(std::mt19937_64& random, std::size_t count) {
  FlatTissue tissue(random, model::LawKind::kSmooth);
  tissue.inclusions.assign(count,
                           {Vec3(0.0, 0.0, -5.1e-3), 5.1e-3 * 5.1e-3, InclusionLaw(5e-3, 5.1e-3, 100.0)});
  return tissue;
}

TEST(Lumps, APileOfStonesIsAtMostTenTimesAsHard) {
  std::mt19937_64 random(7);
  for (const std::size_t count : {2U, 5U, 8U}) {
    const FlatTissue tissue = pile_of_stones(random, count);
    double energy = 0.0;
    constexpr double kStep = 1e-5;
    for (double depth = 0.5 * kStep; depth < 14e-3; depth += kStep) {
      energy += kStep * tissue.force_at(Vec3(0.0, 0.0, -depth)).z();
      const double uniform = tissue.laws.press.energy_at(depth + 0.5 * kStep);
      ASSERT_LE(energy, model::kLargestEnergyFactor * uniform * 1.001 + 1e-9) << count << ", " << depth;
    }
  }
}

// d(normal)/dx is -d(lateral)/dD of one energy.
TEST(Lumps, TheForcesOverAPileOfStonesAreThoseOfOneEnergy) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 500; ++i) {
    const FlatTissue tissue = pile_of_stones(random, 1 + random() % 8);
    const Vec3 here(between(random, -8e-3, 8e-3), between(random, -8e-3, 8e-3),
                    between(random, -9e-3, -1e-3));
    constexpr double kStep = 1e-6;
    const Vec3 aside(kStep, 0.0, 0.0);
    const Vec3 below(0.0, 0.0, -kStep);
    const double by_place = (tissue.force_at(here + aside).z() - tissue.force_at(here - aside).z()) / kStep;
    const double by_depth = (tissue.force_at(here + below).x() - tissue.force_at(here - below).x()) / kStep;
    EXPECT_NEAR(by_place, -by_depth, 1e-3 * std::abs(by_depth) + 1e-2) << i;
  }
}

TEST(Lumps, TheCapLeavesOneInclusionAsItIs) {
  for (double factor = 0.01; factor <= model::kUncappedFactor; factor *= 1.1) {
    EXPECT_EQ(model::cap_factor(factor).value, factor);
    EXPECT_EQ(model::cap_factor(factor).slope, 1.0);
  }
  std::mt19937_64 random(9);
  for (int i = 0; i < 5000; ++i) {
    RandomInclusion one = random_inclusion(random);
    const model::PressedTip tip(one.tip_radius, between(random, 0.1e-3, 25e-3));
    EXPECT_LT(1.0 + one.law().at(tip, 0.0).energy, 10.8);
    one.depth = std::max(one.depth, 1.06 * one.radius);  // not just under the skin
    EXPECT_LT(1.0 + one.law().at(tip, 0.0).energy, model::kUncappedFactor);
  }
}

TEST(Lumps, TheCapRisesSmoothlyToTenAndItsSlopeIsItsDerivative) {
  constexpr double kStep = 1e-6;
  for (double factor = 4.0; factor < 1e6; factor *= 1.07) {
    const model::CappedFactor here = model::cap_factor(factor);
    const double slope =
        (model::cap_factor(factor + kStep).value - model::cap_factor(factor - kStep).value) / (2.0 * kStep);
    EXPECT_NEAR(here.slope, slope, 1e-6) << factor;
    EXPECT_LE(here.value, model::kLargestEnergyFactor);
  }
}

TEST(Lumps, TheNormalForceRisesWithDepthOverSoftAndHardInclusions) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 1000; ++i) {
    const FlatTissue tissue(random, i % 2 == 0 ? model::LawKind::kSmooth : model::LawKind::kLayered);
    const double x = between(random, -25e-3, 25e-3);
    const double y = between(random, -25e-3, 25e-3);
    double before = 0.0;
    for (double depth = 0.1e-3; depth < 16e-3; depth += 0.1e-3) {
      const double force = tissue.force_at(Vec3(x, y, -depth)).z();
      ASSERT_GT(force, before) << i << " at " << depth;
      before = force;
    }
  }
}

TEST(Lumps, FollowedFromAnyDepthTheDepthOfANormalForceIsFound) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 1000; ++i) {
    const FlatTissue flat(random, i % 2 == 0 ? model::LawKind::kSmooth : model::LawKind::kLayered);
    const ToolTissue tissue{flat.laws, flat.inclusions, flat.map, kBall};
    const TissueAt place(tissue, {Vec3(between(random, -25e-3, 25e-3), 0.0, 0.0), 0});
    const double depth = between(random, 0.1e-3, 15e-3);
    const TissueAt::Force force = place.force_at(flat.laws.press, depth);
    double found = between(random, 0.0, 15e-3);
    for (int tick = 0; tick < 40; ++tick) (void)place.follow(flat.laws.press, force.normal, found);
    EXPECT_NEAR(found, depth, 1e-9);
    const Vec3 lateral = place.follow(flat.laws.press, force.normal, found);
    EXPECT_LT((lateral - force.lateral_S).norm(), 1e-6 * force.lateral_S.norm() + 1e-12);
  }
}

}  // namespace
}  // namespace palpate::contact::test

// Skipping queries changes no result: comparison with plain loops over all points.
#include "core/contact/distance_cache.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/contact/contact_patch.h"
#include "core/contact/load_sharing.h"
#include "core/contact/test/rig.h"
#include "palpate/builtin.h"

namespace palpate::contact::test {
namespace {

constexpr double kReference = 10e-3;
constexpr double kPeriod = 1e-3;

PartPoints jaw() { return sample_part(geometry::make_tool("curved-forceps").parts.front(), 0.0); }

Quat random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

/// A smooth hand motion: the point `tip` of the part moves through the organ, along it and out again.
Pose wander(double time, const Quat& turn, const Vec3& tip) {
  const Vec3 place(30e-3 * std::sin(2.1 * time), 25e-3 * std::sin(1.7 * time + 1.0),
                   22e-3 * std::sin(3.1 * time + 1.5));
  const Quat rotation = rotation_about(Vec3(0.6, 0.0, 0.8), 0.8 * std::sin(1.3 * time)) * turn;
  return {rotation, place - rotation * tip};
}

TEST(DistanceCache, NearestIsThatOfAllPointsAlongAnyWay) {
  std::mt19937 random(1);
  const OrganSurface surface(geometry::make_organ("gallbladder"), kReference);
  const PartPoints points = jaw();
  for (int run = 0; run < 3; ++run) {
    DistanceCache part(surface, points);
    const Quat turn = random_turn(random);
    for (int tick = 0; tick < 1500; ++tick) {
      part.move(wander(tick * kPeriod, turn, points.point(0)), kPeriod, {}, kReference);
      if (tick % 7 != 0) continue;  // also after ticks without a query
      part.find_nearest();
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < points.size(); ++i) {
        nearest = std::min(nearest, surface.nearest(part.point_S(i), -1).distance);
      }
      ASSERT_EQ(part.nearest().distance, nearest) << "run " << run << ", tick " << tick;
    }
  }
}

double nearest_of_all(const OrganSurface& surface, const PartPoints& points, const DistanceCache& part) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    nearest = std::min(nearest, surface.nearest(part.point_S(i), -1).distance);
  }
  return nearest;
}

TEST(DistanceCache, NearestIsThatOfAllPointsTickByTickAndBoundsHold) {
  const OrganSurface surface(geometry::make_organ("heart"), kReference);
  const PartPoints points = jaw();
  DistanceCache part(surface, points);
  for (int tick = 0; tick < 1200; ++tick) {
    const double time = tick * kPeriod;
    const Vec3 aside(10e-3 * std::sin(3.0 * time), 8e-3 * std::sin(4.0 * time), 4e-3 * std::sin(9.0 * time));
    const Pose pose{rotation_about(Vec3::UnitX(), 0.2 * std::sin(5.0 * time)),
                    aside - Vec3(0.0, 0.0, 135e-3)};
    part.move(pose, kPeriod, {}, kReference);
    part.find_nearest();
    if (tick % 4 != 0) continue;
    ASSERT_EQ(part.nearest().distance, nearest_of_all(surface, points, part)) << "tick " << tick;
    if (tick % 20 != 0) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = part.point_S(i);
      const double distance = surface.nearest(p, -1).distance;
      ASSERT_LE(part.lower_bound(i), distance + 1e-12);
    }
  }
}

TEST(DistanceCache, RaisedBoundsAreNeverAboveTheDistance) {
  std::mt19937 random(7);
  const PartPoints points = jaw();
  int raised = 0;
  for (const std::string name : {"gallbladder", "heart"}) {
    const OrganSurface surface(geometry::make_organ(name), kReference);
    DistanceCache part(surface, points);
    const Quat turn = random_turn(random);
    for (int tick = 0; tick < 600; ++tick) {
      part.move(wander(tick * kPeriod, turn, points.point(0)), kPeriod, {}, kReference);
      part.find_nearest();
      if (tick % 15 != 0) continue;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double before = part.lower_bound(i);
        const double bound = part.raise_bound(i);
        ASSERT_LE(bound, surface.nearest(part.point_S(i), -1).distance + 1e-12) << name << ", tick " << tick;
        ASSERT_EQ(bound, part.lower_bound(i));
        raised += bound > before ? 1 : 0;
      }
    }
  }
  EXPECT_GT(raised, 100);  // the turn, and with it the number, depends on the compiler
}

TEST(DistanceCache, KnowsAllSidesAndTheNearestPointAfterTicksAsAnInsertedNeedle) {
  std::mt19937 random(9);
  const OrganSurface surface(geometry::make_organ("gallbladder"), kReference);
  const PartPoints points = jaw();
  DistanceCache part(surface, points);
  const Quat turn = random_turn(random);
  int inside = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    const Pose pose = wander(tick * kPeriod, turn, points.point(0));
    if (tick % 100 < 90) {
      part.move_inserted(pose, kPeriod);
      ASSERT_TRUE(part.entries().empty());
      if (tick % 100 != 89 || tick % 200 < 100) continue;
      part.find_nearest();
      ASSERT_EQ(part.nearest().distance, nearest_of_all(surface, points, part)) << "tick " << tick;
      continue;
    }
    part.move(pose, kPeriod, {}, kReference);
    if (tick % 200 == 90) {  // in the other hundreds find_nearest() has found the sides a tick ago
      ASSERT_TRUE(part.entries().empty()) << "tick " << tick;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool is_inside = surface.nearest(part.point_S(i), -1).distance < kInside;
      ASSERT_EQ(part.is_inside(i), is_inside) << "tick " << tick << ", point " << i;
      inside += is_inside ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(DistanceCache, KnowsTheSideOfEachPointAfterAJumpToAnyPlaceOfTheSurface) {
  std::mt19937 random(8);
  const OrganSurface surface(geometry::make_organ("heart"), kReference);
  const PartPoints points = jaw();
  std::uniform_int_distribution<std::size_t> vertex(0, surface.mesh().vertices.size() - 1);
  std::uniform_int_distribution<std::size_t> point(0, points.size() - 1);
  DistanceCache part(surface, points);
  int inside = 0;
  int outside = 0;
  for (int jump = 0; jump < 150; ++jump) {
    const Quat turn = random_turn(random);
    const Vec3 place_S = surface.mesh().vertices[vertex(random)];
    part.move({turn, place_S - turn * points.point(point(random))}, kPeriod, {}, kReference);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = surface.nearest(part.point_S(i), -1).distance;
      ASSERT_EQ(part.is_inside(i), distance < kInside) << "jump " << jump << ", point " << i;
      ASSERT_LE(part.lower_bound(i), distance + 1e-12);
      ++(distance < kInside ? inside : outside);
    }
    part.find_nearest();
    ASSERT_EQ(part.nearest().distance, nearest_of_all(surface, points, part)) << "jump " << jump;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(DistanceCache, NearestIsThatOfAllPointsWheneverItIsNearerThanEnough) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.9, 1.1);
  const OrganSurface surface(geometry::make_organ("heart"), kReference);
  const PartPoints points = jaw();
  DistanceCache part(surface, points);
  int nearer = 0;
  int farther = 0;
  for (int tick = 0; tick < 600; ++tick) {
    const double time = tick * kPeriod;
    const Vec3 aside(10e-3 * std::sin(3.0 * time), 8e-3 * std::sin(4.0 * time), 4e-3 * std::sin(9.0 * time));
    const Pose pose{rotation_about(Vec3::UnitX(), 0.2 * std::sin(5.0 * time)),
                    aside - Vec3(0.0, 0.0, 140e-3)};
    part.move(pose, kPeriod, {}, kReference);
    const double nearest = nearest_of_all(surface, points, part);
    ASSERT_GT(nearest, 0.0);
    const double enough = share(random) * nearest;
    part.find_nearest(enough);
    if (nearest < enough) {
      ASSERT_EQ(part.nearest().distance, nearest) << "tick " << tick;
      ++nearer;
    } else {
      ASSERT_GE(part.nearest().distance, enough) << "tick " << tick;
      ++farther;
    }
  }
  EXPECT_GT(nearer, 200);
  EXPECT_GT(farther, 200);
}

/// Moves the part's tip straight up from far below until it is `depth` [m] inside the organ.
double height_of_depth(const OrganSurface& surface, const PartPoints& points, double depth) {
  DistanceCache part(surface, points);
  for (int step = 0; step < 2000; ++step) {
    const double z = -0.2 + 0.1e-3 * step;
    part.move(place(Vec3(0.0, 0.0, z)), kPeriod, {}, kReference);
    part.find_nearest();
    if (part.nearest().distance < -depth) return z;
  }
  return 0.0;
}

TEST(DistanceCache, FindsWhatGoesInAgainAfterAContactHasHeldItsPlace) {
  const OrganSurface surface(geometry::make_organ("gallbladder"), kReference);
  const PartPoints points = jaw();
  const double deep = height_of_depth(surface, points, 1.5e-3);
  DistanceCache part(surface, points);
  std::vector<Vec3> contacts;
  const auto go_to = [&](double from, double to) {
    for (int k = 1; k <= 40; ++k) {
      const double z = from + (to - from) * k / 40.0;
      part.move(place(Vec3(0.0, 0.0, z)), kPeriod, contacts, kReference);
      if (contacts.empty()) part.find_nearest();
    }
  };
  go_to(deep - 4e-3, deep);
  ASSERT_GT(part.inside_count(), 0U);
  // A proxy at this position while the tool leaves: clusters near it are deferred.
  contacts.push_back(part.nearest().point);
  go_to(deep, deep - 2e-3);
  contacts.clear();
  part.find_nearest();
  ASSERT_GT(part.nearest().distance, 0.0);
  // The next tick enters again, slower than a jump.
  part.move(place(Vec3(0.0, 0.0, deep)), kPeriod, {}, kReference);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (surface.nearest(part.point_S(i), -1).distance < kInside) ++inside;
  }
  EXPECT_GT(inside, 3U);
  EXPECT_EQ(part.entries().size(), inside);
}

TEST(DistanceCache, IsRightAgainInTheTickInWhichAContactHasLeft) {
  std::mt19937 random(6);
  const OrganSurface surface(geometry::make_organ("gallbladder"), kReference);
  const PartPoints points = jaw();
  DistanceCache part(surface, points);
  const Quat turn = random_turn(random);
  std::vector<Vec3> contacts;
  std::vector<bool> was_inside(points.size());
  for (int tick = 0; tick < 3000; ++tick) {
    part.move(wander(tick * kPeriod, turn, points.point(0)), kPeriod, contacts, kReference);
    if (tick % 100 < 50) {  // a contact stays where the tool was nearest
      if (contacts.empty()) contacts.push_back(surface.nearest(part.point_S(0), -1).point);
      continue;
    }
    if (tick % 100 == 50) {  // it ends: with or without a nearest-point query before the next tick
      contacts.clear();
      for (std::size_t i = 0; i < points.size(); ++i) {
        was_inside[i] = surface.nearest(part.point_S(i), -1).distance < kInside;
      }
      if (tick % 200 == 50) part.find_nearest();
      continue;
    }
    if (tick % 100 > 51 && tick % 10 != 0) continue;
    if (tick % 100 == 51) {  // earlier crossings are no entries
      for (const EntryEvent& entry : part.entries()) EXPECT_FALSE(was_inside[entry.point]) << "tick " << tick;
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = surface.nearest(part.point_S(i), -1).distance;
      ASSERT_EQ(part.is_inside(i), distance < kInside) << "tick " << tick << ", point " << i;
      ASSERT_LE(part.lower_bound(i), distance + 1e-12);
    }
    part.find_nearest();
    ASSERT_EQ(part.nearest().distance, nearest_of_all(surface, points, part)) << "tick " << tick;
  }
}

TEST(DistanceCache, KnowsWhichPointsAreInsideAndFindsAllThatWentIn) {
  std::mt19937 random(2);
  const OrganSurface surface(geometry::make_organ("gallbladder"), kReference);
  const PartPoints points = jaw();
  DistanceCache part(surface, points);
  const Quat turn = random_turn(random);
  std::vector<bool> was_inside(points.size(), false);
  int entered = 0;
  for (int tick = 0; tick < 1500; ++tick) {
    part.move(wander(tick * kPeriod, turn, points.point(0)), kPeriod, {}, kReference);
    std::uint32_t inside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool now = surface.nearest(part.point_S(i), -1).distance < kInside;
      ASSERT_EQ(part.is_inside(i), now) << "tick " << tick << ", point " << i;
      inside += now ? 1U : 0U;
      if (now && !was_inside[i] && tick > 0 && part.entries().size() < DistanceCache::kMaxEntries) {
        ++entered;
        EXPECT_TRUE(std::any_of(part.entries().begin(), part.entries().end(),
                                [&](const EntryEvent& entry) { return entry.point == i; }));
      }
      was_inside[i] = now;
    }
    ASSERT_EQ(part.inside_count(), inside);
  }
  EXPECT_GT(entered, 50);
}

/// The rule of docs/model.md, section 4, as a plain loop in double precision.
ContactPatch plain_patch(const PartPoints& part, const Vec3& point, const Vec3& normal) {
  std::vector<double> depths(part.size());
  ContactPatch patch;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Vec3 offset = part.point(i) - point;
    depths[i] = -offset.dot(normal);
    if (depths[i] <= 0.0) continue;
    const double rho_squared = offset.squaredNorm() - depths[i] * depths[i];
    const double inner = 0.5 * kReference;
    if (rho_squared > inner * inner) {
      const double t = (std::sqrt(rho_squared) - inner) / inner;
      depths[i] *= t >= 1.0 ? 0.0 : 1.0 - t * t * (3.0 - 2.0 * t);
    }
    patch.depth = std::max(patch.depth, depths[i]);
  }
  if (patch.depth <= 0.0) return patch;
  double total = 0.0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const double share = 1.0 - (patch.depth - depths[i]) / std::min(kPatchBand, patch.depth);
    if (share <= 0.0) continue;
    total += part.area[i] * share;
    patch.centroid += part.area[i] * share * part.point(i);
  }
  patch.centroid /= total;
  return patch;
}

TEST(ContactPatch, IsThatOfAPlainLoopOverAllPointsToTheBitWhateverTheGuess) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const std::string name : {"curved-forceps", "straight-forceps"}) {
    for (const geometry::ToolPart& tool_part : geometry::make_tool(name).parts) {
      const PartPoints part = sample_part(tool_part, 0.0);
      std::uniform_int_distribution<std::size_t> index(0, part.size() - 1);
      for (int i = 0; i < 3000; ++i) {
        const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
        const double depth = i % 3 == 0 ? 1e-5 : 4e-3;
        const Vec3 point =
            part.point(index(random)) + depth * Vec3(normal(random), normal(random), normal(random));
        const ContactPatch plain = plain_patch(part, point, direction);
        const auto guess = static_cast<std::uint32_t>(static_cast<std::size_t>(i) % part.clusters.size());
        const ContactPatch found = contact_patch_of(part, point, direction, kReference, guess);
        ASSERT_EQ(found.depth, plain.depth);
        ASSERT_EQ(found.centroid, plain.centroid);
      }
    }
  }
}

TEST(ToolPoints, OfADensePartAreThinnedOutAndStandOutAsFar) {
  geometry::ToolPart coarse = geometry::make_tool("curved-forceps").parts.front();
  geometry::ToolPart dense = coarse;
  for (int i = 0; i < 4; ++i) dense.mesh = geometry::subdivide(dense.mesh);
  const PartPoints points = sample_part(dense, 0.0);
  ASSERT_GT(dense.mesh.vertices.size(), 40'000U);
  EXPECT_LE(points.size(), 2000U);
  double area = 0.0;
  double dense_area = 0.0;
  for (const double a : points.area) area += a;
  for (const geometry::Triangle& t : dense.mesh.triangles) {
    dense_area += 0.5 * geometry::area_vector_doubled(dense.mesh, t).norm();
  }
  EXPECT_NEAR(area, dense_area, 1e-3 * dense_area);
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    double farthest = -1.0;
    double kept = -1.0;
    for (const Vec3& p : dense.mesh.vertices) farthest = std::max(farthest, p.dot(direction));
    for (std::size_t k = 0; k < points.size(); ++k) kept = std::max(kept, points.point(k).dot(direction));
    EXPECT_LT(farthest - kept, 50e-6);
  }
}

TEST(Sharing, DoesNotJumpWhenOneOfTwoCoincidentContactsHasLeft) {
  // Two coincident contacts, the second nearly faded out, and a third 4 mm away: as if the second did not
  // exist.
  std::array<Load, 3> contacts;
  for (Load& contact : contacts) contact.elastic_force = 0.1;
  contacts[2].at.point = Vec3(4e-3, 0, 0);
  std::array<Load*, 3> three{&contacts[0], &contacts[1], &contacts[2]};
  contacts[1].fade_weight = 1e-9;
  share_load(kReference, three);
  const double with_first = contacts[0].share;
  const double with_third = contacts[2].share;
  EXPECT_NEAR(contacts[1].share, 0.0, 1e-8);
  std::array<Load*, 2> two{&contacts[0], &contacts[2]};
  share_load(kReference, two);
  EXPECT_NEAR(contacts[0].share, with_first, 1e-8);
  EXPECT_NEAR(contacts[2].share, with_third, 1e-8);
}

TEST(Sharing, CoincidentContactsWeighAsOneWhileOneLeaves) {
  std::array<Load, 2> contacts;
  for (Load& contact : contacts) contact.elastic_force = 0.3;
  std::array<Load*, 2> both{&contacts[0], &contacts[1]};
  for (const double presence : {1.0, 0.7, 0.3, 0.01}) {
    contacts[1].fade_weight = presence;
    share_load(kReference, both);
    EXPECT_NEAR(contacts[0].share + contacts[1].share, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace palpate::contact::test

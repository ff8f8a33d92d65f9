// Load sharing between several contacts on one organ.
#include "core/contact/load_sharing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/contact/test/rig.h"

namespace palpate::contact {
namespace {

constexpr double kSharedReference = 10e-3;

Load contact_at(const Vec3& point, double force, const Vec3& normal = Vec3::UnitZ()) {
  Load contact;
  contact.at.point = point;
  contact.normal = normal;
  contact.elastic_force = force;
  return contact;
}

double total(std::vector<Load>& contacts) {
  std::vector<Load*> all;
  for (Load& contact : contacts) all.push_back(&contact);
  share_load(kSharedReference, all);
  double sum = 0.0;
  for (const Load& contact : contacts) sum += contact.share * contact.elastic_force;
  return sum;
}

TEST(Sharing, CoincidentContactsWeighAsOne) {
  for (std::size_t n = 1; n <= 6; ++n) {
    std::vector<Load> contacts(n, contact_at(Vec3::Zero(), 0.7));
    EXPECT_NEAR(total(contacts), 0.7, 1e-12) << n;
  }
}

TEST(Sharing, DistantContactsAdd) {
  std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.7), contact_at(Vec3(kSharedReference, 0, 0), 0.4)};
  EXPECT_DOUBLE_EQ(total(contacts), 1.1);
}

TEST(Sharing, AWeakContactNeverLowersAStrongOneByMoreThanOnePercent) {
  for (int step = 0; step <= 11; ++step) {
    const double weak = 0.05 * step;
    std::vector<Load> contacts{contact_at(Vec3::Zero(), 1.0), contact_at(Vec3::Zero(), weak)};
    total(contacts);
    EXPECT_GE(contacts[0].share, 0.99) << weak;
  }
}

TEST(Sharing, HalfWayIsTheFormulaWorkedByHand) {
  // r = 5 mm: c = 1 - 1/4 = 0.75 for both; equal forces: share = 0.25 + 0.75/(1 + 0.75) = 0.678571...
  std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.5), contact_at(Vec3(5e-3, 0, 0), 0.5)};
  EXPECT_NEAR(total(contacts), 0.6785714285714286, 1e-12);
}

TEST(Sharing, OverAnEdgeTheDistanceIsTheArc) {
  // Normals at 90 degrees, chord 5 mm: arc = 5 mm x (pi/4)/sin(pi/4) = 5.5536 mm; c = 1 - 0.308425 =
  // 0.691575.
  std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.5), contact_at(Vec3(5e-3, 0, 0), 0.5, Vec3::UnitX())};
  total(contacts);
  EXPECT_NEAR(contacts[0].share, 1.0 - 0.691575 + 0.691575 / 1.691575, 1e-5);
}

TEST(Sharing, NothingJumpsAsTwoContactsPart) {
  double last = 0.5;
  for (int step = 0; step <= 1200; ++step) {
    const double r = 0.01e-3 * step;
    std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.5), contact_at(Vec3(r, 0, 0), 0.5)};
    const double sum = total(contacts);
    EXPECT_GE(sum, last - 1e-12);
    EXPECT_LT(sum - last, 0.002);
    last = sum;
  }
}

TEST(Sharing, NothingJumpsAsAStrongContactLeavesOneThatHasACloseNeighbour) {
  // The strong contact counts 10^8 times as much: with a plain sum any overlap would outweigh the neighbour.
  double last = 0.0;
  for (int step = 0; step <= 2000; ++step) {
    const double r = 9e-3 + 1e-6 * step;
    std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.1), contact_at(Vec3(0, 4e-3, 0), 0.1),
                               contact_at(Vec3(r, 0, 0), 1.0)};
    total(contacts);
    if (step > 0) {
      EXPECT_LT(std::fabs(contacts[0].share - last), 0.0004) << r;  // c falls by 0.0002 per step
    }
    last = contacts[0].share;
  }
  // Without the strong contact: c = 1 - 0.4^2 = 0.84, equal forces, share = 0.16 + 0.84/1.84 = 0.616522.
  EXPECT_NEAR(last, 0.616522, 1e-6);
}

TEST(Sharing, OneThatIsLessCloseWeighsByWhatItLowersAlone) {
  // c = 0.84 (4 mm) and 0.36 (8 mm), equal forces. The farther contact alone lowers the share by 0.36 x
  // 0.36/1.36 = 0.0952941; at C = 0.84 that is a weight of 0.0952941/(0.84 - 0.0952941) = 0.127962. Share:
  // 0.16 + 0.84/(1 + 0.84 + 0.127962) = 0.586837.
  std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.1), contact_at(Vec3(0, 4e-3, 0), 0.1),
                             contact_at(Vec3(8e-3, 0, 0), 0.1)};
  total(contacts);
  EXPECT_NEAR(contacts[0].share, 0.586837, 2e-6);
}

TEST(Sharing, ANeighbourAsCloseAsTheClosestCountsAsInTheFormula) {
  // c = 0.84 twice: 0.16 + 0.84/(1 + 1.68) = 0.473433. A slightly larger distance must give nearly the same.
  for (const double r : {4e-3, 4e-3 + 1e-9}) {
    std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.1), contact_at(Vec3(0, 4e-3, 0), 0.1),
                               contact_at(Vec3(r, 0, 0), 0.1)};
    total(contacts);
    EXPECT_NEAR(contacts[0].share, 0.473433, 2e-6);
  }
}

TEST(Sharing, WithoutForceThereIsNothingToShare) {
  std::vector<Load> contacts{contact_at(Vec3::Zero(), 0.0), contact_at(Vec3::Zero(), 0.0)};
  EXPECT_EQ(total(contacts), 0.0);
  EXPECT_TRUE(std::isfinite(contacts[0].share));
}

TEST(Sharing, ContactsThatBecomeOneRememberTheMeanOfWhatTheyDid) {
  Load relaxed;
  relaxed.memory = {{0.2, 0.0, 0.0}, 1.0};  // the term's history is 0.2 N at an elastic force of 1 N
  Load fresh;
  fresh.memory = {{1.0, 1.0, 0.0}, 1.0};
  const double before = relaxed.memory.history[0] + fresh.memory.history[0];
  merge_histories(relaxed, fresh);
  EXPECT_DOUBLE_EQ(relaxed.memory.history[0] + fresh.memory.history[0], before);
  EXPECT_DOUBLE_EQ(relaxed.memory.history[0], 0.6);
  EXPECT_DOUBLE_EQ(fresh.memory.history[1], 0.5);

  fresh.memory = {{3.0, 0.0, 0.0}, 3.0};  // three times as strong, the same relative history
  merge_histories(relaxed, fresh);
  EXPECT_DOUBLE_EQ(relaxed.memory.history[0], 0.9);
  EXPECT_DOUBLE_EQ(fresh.memory.history[0], 2.7);

  Load none;
  Load nothing;
  merge_histories(none, nothing);
  EXPECT_EQ(none.memory.history[0], 0.0);
}

TEST(Sharing, TwoEqualJawsInOnePlacePressAsOne) {
  geometry::Tool one = test::one_part_tool(geometry::make_ball(3e-3, 320));
  geometry::Tool two = one;
  two.parts.push_back(two.parts.front());
  double force[2];
  for (int i = 0; i < 2; ++i) {
    test::Rig rig(test::block(Vec3(60e-3, 60e-3, 40e-3), 0.1), i == 0 ? one : two, test::plain_tissue());
    rig.tick(test::place(Vec3(0, 0, 5e-3)));
    rig.move_to(Vec3(0, 0, -4e-3), 20e-3);
    force[i] = rig.hold(0.1).force_W.z();
  }
  EXPECT_NEAR(force[1], force[0], 1e-6 * force[0]);
}

}  // namespace
}  // namespace palpate::contact

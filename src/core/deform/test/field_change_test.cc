#include "core/deform/field_change.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "palpate/surface.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr float kShare = 0.015F;  // fraction of the depth at which profiles end

const ProfileTable& table() {
  static const ProfileTable profile({}, 0.2);
  return profile;
}

class Random {
 public:
  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(bits_); }
  Vector3f direction() {
    std::normal_distribution<float> normal;
    return Vector3f(normal(bits_), normal(bits_), normal(bits_)).normalized();
  }

 private:
  std::mt19937 bits_{7};
};

// A contact at the origin whose tangential part reaches `spread` times as far.
ContactField field(const Vector3f& direction, float depth, float tip_radius, float spread) {
  ContactField f;
  f.normal_part = depth * direction.z() * Vector3f::UnitZ();
  f.side_part = depth * direction - f.normal_part;
  f.reach = static_cast<float>(
      DisplacementProfile({}, static_cast<double>(depth), static_cast<double>(tip_radius)).outer_radius());
  f.side_reach = spread * f.reach;
  f.lowered = f.lowered_side = kShare;
  f.limit = table().where(kShare) * f.side_reach;
  return f;
}

// A block of vertices at given distances from every contact, and their displaced positions.
class Vertices {
 public:
  explicit Vertices(Random& random, float from) {
    for (Vector3f& v : vertices_) v = random.between(from, 3.0F * from + 0.01F) * random.direction();
    normals_.fill(Vector3f::UnitZ());
  }
  std::vector<SurfaceVertex> under(std::vector<ContactField> contacts) const {
    const std::array<float, SurfaceBlocks::kBlock> excess{};
    std::vector<const ContactField*> all;
    for (ContactField& contact : contacts) {
      contact.excess = excess;
      all.push_back(&contact);
    }
    std::vector<SurfaceVertex> out(vertices_.size());
    const SurfaceBlocks blocks(vertices_, normals_);
    blocks.rest(0, out.data());
    blocks.move(0, all, table(), out.data());
    return out;
  }

 private:
  std::array<Vector3f, SurfaceBlocks::kBlock> vertices_;
  std::array<Vector3f, SurfaceBlocks::kBlock> normals_;
};

float largest_way(const std::vector<SurfaceVertex>& a, const std::vector<SurfaceVertex>& b) {
  float largest = 0.0F;
  for (std::size_t v = 0; v < a.size(); ++v)
    largest = std::max(largest, (a[v].position - b[v].position).norm());
  return largest;
}

// Contacts at one position before and after a random change of each. @param cone spread of their directions
struct Scene {
  std::vector<ContactField> before, now;

  Scene(Random& random, int contacts, float cone, bool spread) {
    const Vector3f axis = random.direction();
    const float size = std::pow(10.0F, random.between(-3.0F, 0.0F));  // of the changes
    for (int i = 0; i < contacts; ++i) {
      const Vector3f direction = (axis + cone * random.direction()).normalized();
      const Vector3f turned = (direction + 0.3F * size * random.direction()).normalized();
      const float depth = random.between(0.2e-3F, 12e-3F);
      const float tip = random.between(0.3e-3F, 5e-3F);
      const float wide = spread ? random.between(1.0F, 3.0F) : 1.0F;
      before.push_back(field(direction, depth, tip, wide));
      now.push_back(field(turned, depth * (1.0F + size * random.between(-0.9F, 1.0F)), tip,
                          spread ? 1.1F * wide : wide));
    }
  }
  [[nodiscard]] float most_moved_from(float distance) const {
    std::vector<FieldChange> changes(before.size());
    std::vector<NearChange> near;
    for (std::size_t i = 0; i < before.size(); ++i) {
      changes[i].set(&before[i], &now[i], 0.0F, table());
      if (distance < changes[i].limit()) near.push_back({&changes[i], distance});
    }
    return max_motion(near);
  }
};

// Largest ratio of motion to bound over random changes; it must not exceed 1.
float largest_share(int contacts, float cone, bool spread) {
  Random random;
  float largest = 0.0F;
  for (int i = 0; i < 3000; ++i) {
    const Scene scene(random, contacts, cone, spread);
    const float from = random.between(0.0F, 0.03F);
    const Vertices vertices(random, from);
    const float way = largest_way(vertices.under(scene.before), vertices.under(scene.now));
    if (way < 1e-6F) continue;
    largest = std::max(largest, way / scene.most_moved_from(from));
  }
  return largest;
}

TEST(FieldChange, BoundsWhatOneContactsChangeMoves) {
  EXPECT_LT(largest_share(1, 0.0F, false), 1.0F);
  EXPECT_LT(largest_share(1, 0.0F, true), 1.0F);
  EXPECT_GT(largest_share(1, 0.0F, false), 0.9F);  // and the bound is tight
}

TEST(FieldChange, BoundsWhatContactsOfLikeDirectionsMoveTogether) {
  for (const int contacts : {2, 3, 5}) EXPECT_LT(largest_share(contacts, 0.1F, false), 1.0F) << contacts;
  EXPECT_GT(largest_share(2, 0.05F, false), 0.6F);
}

TEST(FieldChange, BoundsWhatContactsOfAnyDirectionsMoveTogether) {
  for (const int contacts : {2, 3, 5}) {
    EXPECT_LT(largest_share(contacts, 3.0F, false), 1.0F) << contacts;
    EXPECT_LT(largest_share(contacts, 0.5F, true), 1.0F) << contacts;
  }
}

TEST(FieldChange, BoundsWhatAContactThatComesOrGoesMoves) {
  const ContactField pressed = field(-Vector3f::UnitZ(), 0.008F, 0.003F, 1.0F);
  Random random;
  for (const float from : {0.0F, 0.004F, 0.012F, 0.025F}) {
    const Vertices vertices(random, from);
    const float way = largest_way(vertices.under({pressed}), vertices.under({}));
    FieldChange change;
    change.set(nullptr, &pressed, 0.0F, table());
    EXPECT_GE(change.at(from).displacement, way) << from;
    change.set(&pressed, nullptr, 0.0F, table());
    EXPECT_GE(change.at(from).displacement, way) << from;
  }
}

TEST(FieldChange, CountsByHowMuchDistancesChangeByThemselves) {
  const ContactField pressed = field(-Vector3f::UnitZ(), 0.008F, 0.003F, 1.0F);
  FieldChange change;
  const float drift = 0.0005F;
  change.set(&pressed, &pressed, drift, table());
  EXPECT_FALSE(change.is_still());
  for (float r = 0.002F; r < 0.03F; r += 0.0007F) {
    const float u = table().at(r / pressed.reach).u;
    const float farther = table().at((r + drift) / pressed.reach).u;
    EXPECT_GE(change.at(r).displacement, 0.008F * (u - farther)) << r;
  }
}

TEST(FieldChange, OfAContactThatStaysAsItIsIsNothing) {
  const ContactField pressed = field(-Vector3f::UnitZ(), 0.008F, 0.003F, 1.0F);
  FieldChange change;
  change.set(&pressed, &pressed, 0.0F, table());
  EXPECT_TRUE(change.is_still());
  EXPECT_EQ(change.at(0.0F).displacement, 0.0F);
  EXPECT_EQ(max_motion(std::vector<NearChange>{{&change, 0.0F}, {&change, 0.0F}}), 0.0F);
  EXPECT_EQ(max_motion({}), 0.0F);
}

TEST(FieldChange, IsNothingBeyondItsLimit) {
  const ContactField shallow = field(-Vector3f::UnitZ(), 0.004F, 0.003F, 1.0F);
  const ContactField deep = field(-Vector3f::UnitZ(), 0.008F, 0.003F, 1.0F);
  FieldChange change;
  change.set(&shallow, &deep, 0.0F, table());
  EXPECT_EQ(change.limit(), deep.limit);
  EXPECT_GT(change.at(0.98F * deep.limit).displacement, 0.0F);
  EXPECT_EQ(change.at(deep.limit).displacement, 0.0F);
}

}  // namespace
}  // namespace palpate::deform

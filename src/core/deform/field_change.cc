#include "core/deform/field_change.h"

#include <algorithm>
#include <cmath>

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr float kBlendGrowth = 2.06F;     // see max_motion
constexpr float kAlikeDirections = 0.5F;  // largest distance between the ends of the unit vectors
constexpr float kMeanGain = 1.07F;        // 1 / the smallest length of the mean of such directions
constexpr float kArc = 1.05F;             // an arc is at most this times its chord, for chords below 1
// Margin for the profile between table entries: its curvature over 1/128 of the reach.
constexpr float kBetweenEntries = 1.05F;

// A contact's effect at one distance.
struct Moving {
  Vector3f displacement = Vector3f::Zero();  // [m]
  float slope = 0.0F;                        // largest derivative with respect to the distance
};

struct Share {
  float value, slope;
};

Share share_at(const ProfileTable& profile, float r, float reach, float lowered) {
  const ProfileTable::Value u = profile.at(r / reach);
  const float left = 1.0F / (1.0F - lowered);
  const float value = (u.u - lowered) * left;
  if (!(value > 0.0F)) return {0.0F, 0.0F};
  return {value, std::abs(u.slope) * left / reach};
}

bool is_straight(const ContactField* field) {
  return field == nullptr || (field->side_reach == field->reach && field->lowered_side == field->lowered);
}

Moving moving_at(const ContactField* field, const ProfileTable& profile, float r) {
  if (field == nullptr || r >= field->limit) return {};
  const Share normal = share_at(profile, r, field->reach, field->lowered);
  const Share side =
      is_straight(field) ? normal : share_at(profile, r, field->side_reach, field->lowered_side);
  return {normal.value * field->normal_part + side.value * field->side_part,
          is_straight(field)
              ? normal.slope * (field->normal_part + field->side_part).norm()
              : normal.slope * field->normal_part.norm() + side.slope * field->side_part.norm()};
}

Vector3f direction_of(const ContactField* field) {
  return field == nullptr ? Vector3f::Zero() : (field->normal_part + field->side_part).normalized();
}

bool same(const ContactField& a, const ContactField& b) {
  return a.normal_part == b.normal_part && a.side_part == b.side_part && a.reach == b.reach &&
         a.side_reach == b.side_reach && a.lowered == b.lowered && a.lowered_side == b.lowered_side &&
         a.limit == b.limit;
}

}  // namespace

void FieldChange::set(const ContactField* before, const ContactField* now, float drift,
                      const ProfileTable& profile) noexcept {
  limit_ = 0.0F;
  for (const ContactField* field : {before, now})
    if (field != nullptr) limit_ = std::max(limit_, field->limit);
  is_still_ = before != nullptr && now != nullptr && !(drift > 0.0F) && same(*before, *now);
  is_straight_ = deform::is_straight(before) && deform::is_straight(now);
  direction_ = direction_of(now != nullptr ? now : before);
  turn_ = before != nullptr && now != nullptr ? kArc * (direction_ - direction_of(before)).norm() : 0.0F;
  if (is_still_ || !(limit_ > 0.0F)) return;
  entries_a_metre_ = static_cast<float>(kEntries) / limit_;
  Bound largest;
  for (std::size_t i = kEntries; i-- > 0;) {
    const float r = static_cast<float>(i) / entries_a_metre_;
    const Moving old = moving_at(before, profile, r);
    const Moving young = moving_at(now, profile, r);
    const float by_drift = drift * old.slope;
    const float old_length = old.displacement.norm();
    const float length = young.displacement.norm();
    largest.displacement =
        std::max(largest.displacement, (young.displacement - old.displacement).norm() + by_drift);
    largest.length = std::max(largest.length, std::abs(length - old_length) + by_drift);
    largest.longest = std::max({largest.longest, length, old_length});
    bounds_[i] = {kBetweenEntries * largest.displacement, kBetweenEntries * largest.length,
                  kBetweenEntries * largest.longest};
  }
}

const FieldChange::Bound& FieldChange::at(float distance) const noexcept {
  static constexpr Bound kNothing{};
  if (is_still_ || distance >= limit_) return kNothing;
  const auto entry = static_cast<std::size_t>(std::max(0.0F, distance) * entries_a_metre_);
  return bounds_[std::min(entry, kEntries - 1)];
}

float max_motion(std::span<const NearChange> changes) noexcept {
  if (changes.size() == 1) return changes.front().change->at(changes.front().distance).displacement;
  float ways = 0.0F;
  float length = 0.0F;   // the largest of the contacts'
  float turned = 0.0F;   // largest motion by a direction's turn
  float turn = 0.0F;     // [rad], the largest
  float between = 0.0F;  // largest squared difference of directions
  bool straight = true;
  for (const NearChange& one : changes) {
    const FieldChange::Bound& bound = one.change->at(one.distance);
    ways += bound.displacement;
    length = std::max(length, bound.length);
    turned = std::max(turned, one.change->turn() * bound.longest);
    turn = std::max(turn, one.change->turn());
    straight = straight && one.change->is_straight();
    for (const NearChange& other : changes.first(static_cast<std::size_t>(&one - changes.data())))
      between = std::max(between, (one.change->direction() - other.change->direction()).squaredNorm());
  }
  const float most = kBlendGrowth * ways;
  const float apart = std::sqrt(between) + 2.0F * turn;
  if (!straight || apart > kAlikeDirections) return most;
  const float root = std::sqrt(static_cast<float>(changes.size()));
  const float alike = (1.0F + 0.25F * root + kMeanGain * apart * (1.0F + root)) * length +
                      0.5F * kMeanGain * (1.0F + root) * turned;
  return std::min(most, alike);
}

}  // namespace palpate::deform

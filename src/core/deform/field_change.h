#pragma once
#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/deform/profile_table.h"
#include "core/deform/surface_blocks.h"

namespace palpate::deform {

/// What one contact's change from one picture to the next can do at most to vertices by their distance from
/// it, so that a run of them may be left as it was drawn. Tables over the distance, each entry the largest
/// from there on.
class FieldChange final {
 public:
  /// [any] @param before, now of one contact; null: it was not there, or is not any more
  /// @param drift by how much a vertex's distance from the contact differs between the two, at most [m]
  void take(const ContactField* before, const ContactField* now, float drift,
            const ProfileTable& profile) noexcept;

  /// [any] Nothing farther than this [m] moved before or moves now.
  [[nodiscard]] float limit() const noexcept { return limit_; }
  /// [any] Whether nothing changes at all.
  [[nodiscard]] bool is_still() const noexcept { return is_still_; }

  /// What may happen to vertices at least some distance off.
  struct Bound {
    float way = 0.0F;      // how far the displacement changes [m]
    float length = 0.0F;   // by how much its length does [m]
    float longest = 0.0F;  // how long it is, before or now [m]
  };
  /// [any] @param distance [m] that vertices have at least, before and now
  [[nodiscard]] const Bound& at(float distance) const noexcept;

  /// [any] Whether the displacement has one direction() at all distances; it turns by turn() [rad].
  [[nodiscard]] bool is_straight() const noexcept { return is_straight_; }
  [[nodiscard]] const Eigen::Vector3f& direction() const noexcept { return direction_; }
  [[nodiscard]] float turn() const noexcept { return turn_; }

 private:
  static constexpr std::size_t kEntries = 128;

  std::array<Bound, kEntries> bounds_{};
  float limit_ = 0.0F;
  float entries_a_metre_ = 0.0F;
  bool is_still_ = true;
  bool is_straight_ = true;
  Eigen::Vector3f direction_ = Eigen::Vector3f::Zero();
  float turn_ = 0.0F;
};

/// A change and the least distance [m] that a run's vertices have from its contact.
struct NearChange {
  const FieldChange* change = nullptr;
  float distance = 0.0F;
};

/// [any] How far [m] these changes, of all contacts that reach the run, together move a vertex of the run at
/// most, several contacts blended as SurfaceDeformer says.
///
/// One contact's displacement is the vertex's. Of several, a is each one's displacement, u its length, n how
/// many they are, and the vertex's displacement m d: m = sum u^9 / sum u^8, d the mean direction.
/// - In general no change of one a moves the vertex by more than 2.06 times as much (the largest found by a
///   search over directions and lengths, the same for 2 to 6 contacts), so the changes' sum bounds it.
/// - Where all directions are within e <= 0.5 of one another (as ends of unit vectors) much less does:
///   |dm| <= (1 + sqrt(n)/4) max |du| (searched up to n = 24; 1.205 at n = 2), and, u being multiplied into
///   d's mean twice and |d| before it is made a unit vector at least 1 / 1.07,
///   m |dd| <= 1.07 sum (2 e u |du| + u |turn of a|) m / sum u^2, with m sum u / sum u^2 <= (1 + sqrt(n))/2.
[[nodiscard]] float most_moved(std::span<const NearChange> changes) noexcept;

}  // namespace palpate::deform

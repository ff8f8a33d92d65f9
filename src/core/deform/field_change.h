#pragma once
#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/deform/profile_table.h"
#include "core/deform/surface_blocks.h"

namespace palpate::deform {

/// Bounds how far one contact's change between two frames can move vertices, as a function of their distance
/// from it, so that a block of them need not be computed again. Each table entry is the maximum over all
/// larger distances.
class FieldChange final {
 public:
  /// [any] @param before, now of one contact; null: it did not exist or no longer exists
  /// @param drift largest change of a vertex's distance from the contact between the two [m]
  void set(const ContactField* before, const ContactField* now, float drift,
           const ProfileTable& profile) noexcept;

  /// [any] Nothing farther than this moves, before or now [m].
  [[nodiscard]] float limit() const noexcept { return limit_; }
  /// [any] Whether nothing changes.
  [[nodiscard]] bool is_still() const noexcept { return is_still_; }

  /// Bounds for vertices beyond some distance.
  struct Bound {
    float displacement = 0.0F;  // change of the displacement [m]
    float length = 0.0F;        // change of its length [m]
    float longest = 0.0F;       // its length, before or now [m]
  };
  /// [any] @param distance lower bound of the vertices' distance, before and now [m]
  [[nodiscard]] const Bound& at(float distance) const noexcept;

  /// [any] Whether the displacement has one direction() at all distances. It turns by turn() [rad].
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

/// A change, and a lower bound of a block's distance from its contact [m].
struct NearChange {
  const FieldChange* change = nullptr;
  float distance = 0.0F;
};

/// [any] Bound of the motion [m] of a block's vertices under the changes of all contacts that reach it.
/// Several contacts are blended as described at SurfaceDeformer.
///
/// The displacement of one contact is the vertex's. For n contacts, with a the displacement of each and u its
/// length, the vertex moves by m d: m = sum u^9 / sum u^8, and d is the mean direction.
/// - In general a change of one a moves the vertex by at most 2.06 times as much (the maximum of a search
///   over directions and lengths, equal for 2 to 6 contacts). The sum of the changes is then the bound.
/// - If all directions differ by at most e <= 0.5 (distance between the ends of unit vectors), the bound is
///   smaller:
/// |dm| <= (1 + sqrt(n)/4) max |du| (searched up to n = 24; 1.205 at n = 2).
/// u enters d's mean twice, and |d| before normalization is at least 1 / 1.07. So m |dd| <= 1.07 sum (2 e u
/// |du| + u |turn of a|) m / sum u^2, with m sum u / sum u^2 <= (1 + sqrt(n))/2.
[[nodiscard]] float max_motion(std::span<const NearChange> changes) noexcept;

}  // namespace palpate::deform

#pragma once
#include <span>
#include <vector>

#include "palpate/geometry/tool.h"
#include "palpate/haptics/loop.h"

namespace palpate::render {

/// How deep a tool reaches around one press contact: a map over the plane across the contact's direction,
/// within 17 mm of its axis, continued beside the tool by a slope of 2.5 and evened out over 0.8 mm.
///
/// The profile of model.md section 3 knows the tool's radius at one point only; a jaw that lies on the organ
/// would be drawn half buried. So vertices above the imprint are lowered towards it along the contact's
/// direction (all but the last 0.5 mm of the way), never by more than the contact's depth in all, and only
/// where the rest surface faces the tool.
class ToolImprint final {
 public:
  /// [setup] @param triangles corners of the tool's triangles, three each, organ frame [m]
  /// @param depth D [m]: the imprint is never deeper
  ToolImprint(std::span<const Vec3> triangles, const Vec3& point, const Vec3& direction, double depth);

  /// [setup] How far [m] a vertex is to be lowered further along the direction; 0 where the tool is not.
  /// @param now where it is, @param rest where it was, @param rest_normal unit. Organ frame.
  [[nodiscard]] double lowering(const Vec3& now, const Vec3& rest, const Vec3& rest_normal) const;

  [[nodiscard]] const Vec3& direction() const noexcept { return direction_; }

 private:
  void rasterize(const Vec3& a, const Vec3& b, const Vec3& c);
  void skirt();
  void blur();
  [[nodiscard]] Vec3 in_map(const Vec3& p) const noexcept;
  [[nodiscard]] double& cell(int i, int j) noexcept;
  [[nodiscard]] double cell(int i, int j) const noexcept;

  Vec3 point_;
  Vec3 direction_;
  Vec3 across_u_;
  Vec3 across_v_;
  double depth_;
  std::vector<double> map_;  // [m] along the direction, from the contact point
};

/// [setup] The imprints of all press contacts of a snapshot. @param tools of the hands, in order
[[nodiscard]] std::vector<ToolImprint> imprints_of(const haptics::Snapshot& snapshot,
                                                   std::span<const geometry::Tool> tools);

}  // namespace palpate::render

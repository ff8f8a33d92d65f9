#include "view/render/tool_imprint.h"

#include <algorithm>
#include <cmath>

namespace palpate::render {
namespace {

constexpr float kCell = 0.4e-3F;                                   // m
constexpr float kHalf = 0.5F * DepthMap::kSide;                    // half the side, in cells
constexpr float kFadeFrom = 12e-3F;                                // m from the contact's axis: full effect
                                                                   // up to here
constexpr auto kFadeTo = static_cast<float>(ToolImprint::kReach);  // m: no effect from here on
constexpr float kSlope = 2.5F;                                     // of the slope beside the tool, depth over
                                                                   // distance
constexpr int kRounds = 6;                                         // of smoothing over 3 x 3 cells: 0.8 mm in
                                                                   // total
constexpr float kOnset = 0.5e-3F;  // m: a vertex this far above the imprint is lowered by half of this
constexpr float kFacing = 0.3F;    // cosine between surface and direction above which the effect is full

constexpr double kMapReach = 0.71 * DepthMap::kSide * 0.4e-3;  // m: half the diagonal of the map
constexpr std::size_t kGroup = 96;                             // corners per group of triangles
constexpr double kShared = 8e-3;                               // m: contacts closer than this share an
                                                               // imprint ...
constexpr double kSameWay = 0.94;  // ... if their directions differ by less than 20 degrees

float ramp(float x) {
  const float t = std::clamp(x, 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace

ToolImprint::ToolImprint(std::span<const Vec3> triangles, const Vec3& point, const Vec3& direction,
                         double depth)
    : point_(point),
      direction_(direction),
      origin_(point.cast<float>()),
      row_(direction.unitOrthogonal().cast<float>() / kCell),
      column_(direction.cross(direction.unitOrthogonal()).cast<float>() / kCell),
      down_(direction.cast<float>()),
      depth_(static_cast<float>(depth)) {
  const auto in_map = [this](const Vec3& p) {
    const Eigen::Vector3f offset = (p - point_).cast<float>();
    return Eigen::Vector3f(offset.dot(row_) + kHalf, offset.dot(column_) + kHalf, offset.dot(down_));
  };
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    map_.add_triangle(in_map(triangles[i]), in_map(triangles[i + 1]), in_map(triangles[i + 2]), depth_);
  map_.add_slopes(kSlope * kCell);
  map_.smooth(kRounds);
}

float ToolImprint::lowering(const Eigen::Vector3f& now, const Eigen::Vector3f& rest,
                            const Eigen::Vector3f& rest_normal, Eigen::Vector3f* slope) const {
  const Eigen::Vector3f offset = now - origin_;
  const float u = offset.dot(row_);
  const float v = offset.dot(column_);
  const float squared = u * u + v * v;
  constexpr float kLargest = kFadeTo / kCell;
  if (!(squared < kLargest * kLargest)) return 0.0F;  // so that all cells used below are inside the map
  const float x = u + kHalf;
  const float y = v + kHalf;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const float s = x - static_cast<float>(i);
  const float t = y - static_cast<float>(j);
  const auto between = [s, t](float a, float b, float c, float d) {
    return (1.0F - s) * ((1.0F - t) * a + t * b) + s * ((1.0F - t) * c + t * d);
  };
  const float imprint = between(map_.at(i, j), map_.at(i, j + 1), map_.at(i + 1, j), map_.at(i + 1, j + 1));
  const float room = depth_ - (now - rest).dot(down_);  // never displaced by more than D in total
  const float above = imprint - offset.dot(down_);
  const float wanted = std::min(above, room);
  if (!(wanted > 0.0F)) return 0.0F;
  const float off_axis = kCell * std::sqrt(squared);
  const float share =
      ramp((kFadeTo - off_axis) / (kFadeTo - kFadeFrom)) * ramp(-rest_normal.dot(down_) / kFacing);
  if (slope != nullptr) {
    // Differences over two cells give a gradient that looks smooth when shaded.
    const auto rise_u = [this](int a, int b) { return map_.at(a + 1, b) - map_.at(a - 1, b); };
    const auto rise_v = [this](int a, int b) { return map_.at(a, b + 1) - map_.at(a, b - 1); };
    const float along_u = between(rise_u(i, j), rise_u(i, j + 1), rise_u(i + 1, j), rise_u(i + 1, j + 1));
    const float along_v = between(rise_v(i, j), rise_v(i, j + 1), rise_v(i + 1, j), rise_v(i + 1, j + 1));
    const float gain = share * wanted * (wanted + 2.0F * kOnset) / ((wanted + kOnset) * (wanted + kOnset));
    *slope = -gain * down_;
    if (above <= room) *slope += 0.5F * gain * (along_u * row_ + along_v * column_);
  }
  return share * wanted * wanted / (wanted + kOnset);
}

ToolShape::ToolShape(const geometry::Tool& tool) {
  for (const geometry::ToolPart& part : tool.parts) {
    Part shape;
    shape.pose = part;
    shape.pose.mesh = {};
    for (const geometry::Triangle& t : part.mesh.triangles)
      for (const std::int32_t v : t) shape.corners.push_back(part.mesh.vertices[static_cast<std::size_t>(v)]);
    for (std::size_t first = 0; first < shape.corners.size(); first += kGroup) {
      Group group{first, std::min(kGroup, shape.corners.size() - first), Vec3::Zero(), 0.0};
      const std::span<const Vec3> corners = std::span(shape.corners).subspan(first, group.count);
      for (const Vec3& p : corners) group.middle += p / static_cast<double>(group.count);
      for (const Vec3& p : corners) group.radius = std::max(group.radius, (p - group.middle).norm());
      shape.groups.push_back(group);
    }
    parts_.push_back(std::move(shape));
  }
}

void ToolShape::append_near(const Pose& handle_S, double gripper, const Vec3& point, double radius,
                            std::vector<Vec3>& corners) const {
  for (const Part& part : parts_) {
    const Pose part_S = handle_S * geometry::part_pose(part.pose, gripper);
    const Mat3 turn = part_S.rotation.toRotationMatrix();
    const Vec3 point_in_part = part_S.inverse() * point;
    for (const Group& group : part.groups) {
      const double reach = radius + group.radius;
      if ((group.middle - point_in_part).squaredNorm() > reach * reach) continue;
      for (std::size_t i = group.first; i < group.first + group.count; ++i)
        corners.emplace_back(turn * part.corners[i] + part_S.position);
    }
  }
}

namespace {

// The deepest press contacts of a hand, without those that share the imprint of a deeper one.
std::vector<const contact::ContactView*> leading_presses(const contact::ToolResult& result) {
  std::vector<const contact::ContactView*> presses;
  for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
    const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
    if (view.depth > 0.0 && !view.pull) presses.push_back(&view);
  }
  std::stable_sort(presses.begin(), presses.end(),
                   [](const auto* a, const auto* b) { return a->depth > b->depth; });
  std::vector<const contact::ContactView*> leading;
  for (const contact::ContactView* press : presses) {
    const bool stood_for =
        std::any_of(leading.begin(), leading.end(), [press](const contact::ContactView* other) {
          return (other->point_S - press->point_S).norm() < kShared &&
                 other->direction_S.dot(press->direction_S) > kSameWay;
        });
    if (!stood_for) leading.push_back(press);
  }
  return leading;
}

}  // namespace

std::vector<ToolImprint> imprints_of(const haptics::Snapshot& snapshot, std::span<const ToolShape> shapes) {
  std::vector<ToolImprint> imprints;
  const std::size_t hands = std::min({shapes.size(), static_cast<std::size_t>(snapshot.hands), kMaxHands});
  const Pose organ_from_world = snapshot.organ_W.inverse();
  std::vector<Vec3> corners;
  for (std::size_t hand = 0; hand < hands; ++hand) {
    for (const contact::ContactView* press : leading_presses(snapshot.results[hand])) {
      // The corners of the map are half its diagonal away; triangles deeper than D count as well.
      corners.clear();
      shapes[hand].append_near(organ_from_world * snapshot.tools[hand].pose_W, snapshot.tools[hand].gripper,
                               press->point_S, kMapReach + press->depth, corners);
      imprints.emplace_back(corners, press->point_S, press->direction_S, press->depth);
    }
  }
  return imprints;
}

}  // namespace palpate::render

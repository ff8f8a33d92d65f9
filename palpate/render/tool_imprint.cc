#include "palpate/render/tool_imprint.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::render {
namespace {

constexpr int kSide = 90;                        // cells
constexpr double kCell = 0.4e-3;                 // m
constexpr double kHalf = 0.5 * kSide;            // cells
constexpr double kFadeFrom = 12e-3;              // m from the contact's axis: full effect
constexpr double kFadeTo = ToolImprint::kReach;  // m: none
constexpr double kSlope = 2.5;                   // of the skirt, depth over distance
constexpr float kNoTool = -1.0F;                 // m: far above any surface
constexpr int kBlurRounds = 6;                   // of 3 x 3 cells: evens out 0.8 mm
constexpr double kOnset = 0.5e-3;  // m: a vertex this high above the imprint is lowered by half of it
constexpr double kFacing = 0.3;    // cosine between surface and direction from which the effect is full

constexpr double kMapReach = 0.71 * kSide * kCell;  // m: half the map's diagonal
constexpr std::size_t kGroup = 96;                  // corners of a group of triangles
constexpr double kShared = 8e-3;                    // m: contacts this near to one another ...
constexpr double kSameWay = 0.94;                   // ... whose directions differ by under 20 degrees

double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

std::size_t place_of(int i, int j) {
  return static_cast<std::size_t>(i) * static_cast<std::size_t>(kSide) + static_cast<std::size_t>(j);
}

}  // namespace

ToolImprint::ToolImprint(std::span<const Vec3> triangles, const Vec3& point, const Vec3& direction,
                         double depth)
    : point_(point),
      direction_(direction),
      across_u_(direction.unitOrthogonal()),
      across_v_(direction.cross(across_u_)),
      depth_(depth),
      map_(place_of(kSide, 0), kNoTool) {
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    rasterize(in_map(triangles[i]), in_map(triangles[i + 1]), in_map(triangles[i + 2]));
  skirt();
}

Vec3 ToolImprint::in_map(const Vec3& p) const noexcept {
  const Vec3 offset = p - point_;
  return {offset.dot(across_u_) / kCell + kHalf, offset.dot(across_v_) / kCell + kHalf,
          offset.dot(direction_)};
}

float& ToolImprint::cell(int i, int j) noexcept { return map_[place_of(i, j)]; }
double ToolImprint::cell(int i, int j) const noexcept { return static_cast<double>(map_[place_of(i, j)]); }

void ToolImprint::rasterize(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double low_x = std::min({a.x(), b.x(), c.x()});
  const double high_x = std::max({a.x(), b.x(), c.x()});
  const double low_y = std::min({a.y(), b.y(), c.y()});
  const double high_y = std::max({a.y(), b.y(), c.y()});
  if (high_x < 0.0 || low_x > kSide - 1 || high_y < 0.0 || low_y > kSide - 1) return;
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  if (std::abs(area) < 1e-12) return;  // seen on edge: its neighbours cover it
  const int last_i = std::min(kSide - 1, static_cast<int>(std::floor(high_x)));
  const int last_j = std::min(kSide - 1, static_cast<int>(std::floor(high_y)));
  for (int i = std::max(0, static_cast<int>(std::ceil(low_x))); i <= last_i; ++i) {
    for (int j = std::max(0, static_cast<int>(std::ceil(low_y))); j <= last_j; ++j) {
      const double v = ((i - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (j - a.y())) / area;
      const double w = ((b.x() - a.x()) * (j - a.y()) - (i - a.x()) * (b.y() - a.y())) / area;
      if (v < 0.0 || w < 0.0 || v + w > 1.0) continue;
      const double depth = a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z());
      cell(i, j) = std::max(cell(i, j), static_cast<float>(std::min(depth, depth_)));
    }
  }
}

void ToolImprint::skirt() {
  // Two sweeps, each taking from the neighbours already seen: a chamfer distance map with knight's moves,
  // whose distances are at most 3 % too long.
  struct Step {
    int i, j;
    float fall;
  };
  const auto fall = [](double i, double j) { return static_cast<float>(kSlope * kCell * std::hypot(i, j)); };
  const std::array<Step, 8> behind = {{{-1, 0, fall(1, 0)},
                                       {0, -1, fall(0, 1)},
                                       {-1, -1, fall(1, 1)},
                                       {-1, 1, fall(1, 1)},
                                       {-2, -1, fall(2, 1)},
                                       {-2, 1, fall(2, 1)},
                                       {-1, -2, fall(1, 2)},
                                       {-1, 2, fall(1, 2)}}};
  const auto sweep = [this, &behind](int sign) {
    for (int n = 0; n < kSide * kSide; ++n) {
      const int at = sign > 0 ? n : kSide * kSide - 1 - n;
      const int i = at / kSide;
      const int j = at % kSide;
      float best = cell(i, j);
      for (const Step& step : behind) {
        const int from_i = i + sign * step.i;
        const int from_j = j + sign * step.j;
        if (from_i < 0 || from_j < 0 || from_i >= kSide || from_j >= kSide) continue;
        best = std::max(best, map_[place_of(from_i, from_j)] - step.fall);
      }
      cell(i, j) = best;
    }
  };
  sweep(1);
  sweep(-1);
  for (int round = 0; round < kBlurRounds; ++round) blur();
}

void ToolImprint::blur() {
  // The mean of 3 x 3 cells, along and then across.
  std::vector<float> along = map_;
  for (int i = 0; i < kSide; ++i)
    for (int j = 1; j < kSide - 1; ++j)
      along[place_of(i, j)] =
          (map_[place_of(i, j - 1)] + map_[place_of(i, j)] + map_[place_of(i, j + 1)]) * (1.0F / 3.0F);
  for (int i = 1; i < kSide - 1; ++i)
    for (int j = 1; j < kSide - 1; ++j)
      map_[place_of(i, j)] =
          (along[place_of(i - 1, j)] + along[place_of(i, j)] + along[place_of(i + 1, j)]) * (1.0F / 3.0F);
}

double ToolImprint::lowering(const Vec3& now, const Vec3& rest, const Vec3& rest_normal, Vec3* slope) const {
  const Vec3 place = in_map(now);
  const double x = place.x();
  const double y = place.y();
  if (!(x >= 1.0 && y >= 1.0 && x < kSide - 2 && y < kSide - 2)) return 0.0;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const double s = x - i;
  const double t = y - j;
  const auto between = [s, t](double a, double b, double c, double d) {
    return (1.0 - s) * ((1.0 - t) * a + t * b) + s * ((1.0 - t) * c + t * d);
  };
  const double imprint = between(cell(i, j), cell(i, j + 1), cell(i + 1, j), cell(i + 1, j + 1));
  const double room = depth_ - (now - rest).dot(direction_);  // never moved by more than D in all
  const double above = imprint - place.z();
  const double wanted = std::min(above, room);
  if (wanted <= 0.0) return 0.0;
  const double off_axis = kCell * std::hypot(x - kHalf, y - kHalf);
  const double share =
      ramp((kFadeTo - off_axis) / (kFadeTo - kFadeFrom)) * ramp(-rest_normal.dot(direction_) / kFacing);
  if (slope != nullptr) {
    // Of the imprint by differences over two cells, which a light shows as smooth.
    const auto rise_u = [this](int a, int b) { return cell(a + 1, b) - cell(a - 1, b); };
    const auto rise_v = [this](int a, int b) { return cell(a, b + 1) - cell(a, b - 1); };
    const double u = between(rise_u(i, j), rise_u(i, j + 1), rise_u(i + 1, j), rise_u(i + 1, j + 1));
    const double v = between(rise_v(i, j), rise_v(i, j + 1), rise_v(i + 1, j), rise_v(i + 1, j + 1));
    const Vec3 rises = (u * across_u_ + v * across_v_) / (2.0 * kCell);
    const double gain = share * wanted * (wanted + 2.0 * kOnset) / ((wanted + kOnset) * (wanted + kOnset));
    *slope = gain * ((above <= room ? rises : Vec3::Zero()) - direction_);
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

// The deepest press contacts of a hand, without those that one before them stands for.
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
  const std::size_t hands =
      std::min({shapes.size(), static_cast<std::size_t>(snapshot.hands), haptics::Snapshot::kMaxHands});
  const Pose organ_from_world = snapshot.organ_W.inverse();
  std::vector<Vec3> corners;
  for (std::size_t hand = 0; hand < hands; ++hand) {
    for (const contact::ContactView* press : leading_presses(snapshot.results[hand])) {
      // The map's corners are half its diagonal away; what lies deeper than D counts, too.
      corners.clear();
      shapes[hand].append_near(organ_from_world * snapshot.tools[hand].pose_W, snapshot.tools[hand].gripper,
                               press->point_S, kMapReach + press->depth, corners);
      imprints.emplace_back(corners, press->point_S, press->direction_S, press->depth);
    }
  }
  return imprints;
}

}  // namespace palpate::render

#include "palpate/render/tool_imprint.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::render {
namespace {

constexpr int kSide = 90;              // cells
constexpr double kCell = 0.4e-3;       // m
constexpr double kHalf = 0.5 * kSide;  // cells
constexpr double kFadeFrom = 12e-3;    // m from the contact's axis: full effect
constexpr double kFadeTo = 17e-3;      // m: none
constexpr double kSlope = 2.5;         // of the skirt, depth over distance
constexpr double kNoTool = -1.0;       // m: far above any surface
constexpr int kBlurRounds = 6;         // of 3 x 3 cells: evens out 0.8 mm
constexpr double kOnset = 0.5e-3;      // m: a vertex this high above the imprint is lowered by half of it
constexpr double kFacing = 0.3;        // cosine between surface and direction from which the effect is full

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

double& ToolImprint::cell(int i, int j) noexcept { return map_[place_of(i, j)]; }
double ToolImprint::cell(int i, int j) const noexcept { return map_[place_of(i, j)]; }

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
      cell(i, j) = std::max(cell(i, j), std::min(depth, depth_));
    }
  }
}

void ToolImprint::skirt() {
  // Two sweeps, each taking from the neighbours already seen: a chamfer distance map with knight's moves,
  // whose distances are at most 3 % too long.
  struct Step {
    int i, j;
  };
  constexpr std::array<Step, 8> kBehind = {
      {{-1, 0}, {0, -1}, {-1, -1}, {-1, 1}, {-2, -1}, {-2, 1}, {-1, -2}, {-1, 2}}};
  const auto sweep = [this, &kBehind](int sign) {
    for (int n = 0; n < kSide * kSide; ++n) {
      const int at = sign > 0 ? n : kSide * kSide - 1 - n;
      const int i = at / kSide;
      const int j = at % kSide;
      for (const Step& step : kBehind) {
        const int from_i = i + sign * step.i;
        const int from_j = j + sign * step.j;
        if (from_i < 0 || from_j < 0 || from_i >= kSide || from_j >= kSide) continue;
        const double fall = kSlope * kCell * std::hypot(step.i, step.j);
        cell(i, j) = std::max(cell(i, j), cell(from_i, from_j) - fall);
      }
    }
  };
  sweep(1);
  sweep(-1);
  for (int round = 0; round < kBlurRounds; ++round) blur();
}

void ToolImprint::blur() {
  const std::vector<double> before = map_;
  for (int i = 1; i < kSide - 1; ++i) {
    for (int j = 1; j < kSide - 1; ++j) {
      double sum = 0.0;
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj) sum += before[place_of(i + di, j + dj)];
      cell(i, j) = sum / 9.0;
    }
  }
}

double ToolImprint::lowering(const Vec3& now, const Vec3& rest, const Vec3& rest_normal) const {
  const Vec3 place = in_map(now);
  const double x = place.x();
  const double y = place.y();
  if (!(x >= 0.0 && y >= 0.0 && x < kSide - 1 && y < kSide - 1)) return 0.0;
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const double s = x - i;
  const double t = y - j;
  const double imprint = (1.0 - s) * ((1.0 - t) * cell(i, j) + t * cell(i, j + 1)) +
                         s * ((1.0 - t) * cell(i + 1, j) + t * cell(i + 1, j + 1));
  const double room = depth_ - (now - rest).dot(direction_);  // never moved by more than D in all
  const double wanted = std::min(imprint - place.z(), room);
  if (wanted <= 0.0) return 0.0;
  const double off_axis = kCell * std::hypot(x - kHalf, y - kHalf);
  return wanted * wanted / (wanted + kOnset) * ramp((kFadeTo - off_axis) / (kFadeTo - kFadeFrom)) *
         ramp(-rest_normal.dot(direction_) / kFacing);
}

std::vector<ToolImprint> imprints_of(const haptics::Snapshot& snapshot,
                                     std::span<const geometry::Tool> tools) {
  std::vector<ToolImprint> imprints;
  const std::size_t hands =
      std::min({tools.size(), static_cast<std::size_t>(snapshot.hands), haptics::Snapshot::kMaxHands});
  const Pose organ_from_world = snapshot.organ_W.inverse();
  for (std::size_t hand = 0; hand < hands; ++hand) {
    const contact::ToolResult& result = snapshot.results[hand];
    if (result.view_count == 0) continue;
    std::vector<Vec3> triangles;
    for (const geometry::ToolPart& part : tools[hand].parts) {
      const Pose part_S = organ_from_world * snapshot.tools[hand].pose_W *
                          geometry::part_pose(part, snapshot.tools[hand].gripper);
      for (const geometry::Triangle& t : part.mesh.triangles)
        for (const std::int32_t v : t)
          triangles.push_back(part_S * part.mesh.vertices[static_cast<std::size_t>(v)]);
    }
    for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
      const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
      if (view.depth > 0.0 && !view.pull)
        imprints.emplace_back(triangles, view.point_S, view.direction_S, view.depth);
    }
  }
  return imprints;
}

}  // namespace palpate::render

// The line through a contact of which the report shows the deformation, as figure 7 of the paper does.
#include "view/report/surface_line.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/deform/triangle_search.h"
#include "io/system/csv_table.h"
#include "palpate/error.h"
#include "palpate/surface.h"
#include "palpate/units.h"
#include "view/render/organ_picture.h"
#include "view/render/tool_imprint.h"

namespace palpate::report {
namespace {

constexpr double kEndShare = 0.02;   // of the depth: the line ends where u(r) falls below it
constexpr double kLongest = 100e-3;  // m, of either side

enum ProfileColumn : std::size_t { kDistanceColumn, kDisplacementColumn, kDepthColumn };
constexpr double kLargestNumber = 1e6;  // mm

/// One side of a section: places from the contact outwards, and whether the section came back to its start.
struct Side {
  std::vector<LinePlace> places;
  bool closed = false;
};

/// Walks along the section of a plane with a surface, from triangle to triangle.
class SectionWalk final {
 public:
  SectionWalk(const geometry::TriangleMesh& rest, const std::vector<Vec3>& moved, Vec3 point_S,
              Vec3 direction_S, const Vec3& across_S)
      : rest_(rest),
        moved_(moved),
        neighbours_(geometry::edge_neighbours(rest)),
        point_S_(std::move(point_S)),
        direction_S_(std::move(direction_S)),
        plane_(direction_S_.cross(across_S).normalized()),
        across_S_(across_S) {}

  /// The edge of a triangle that the plane crosses on that side of the point; -1: none.
  [[nodiscard]] int first_edge(std::size_t triangle, double side) const {
    int best = -1;
    double farthest = -std::numeric_limits<double>::infinity();
    for (int e = 0; e < 3; ++e) {
      if (!crossed(triangle, e)) continue;
      const double along = side * (crossing(triangle, e).first - point_S_).dot(across_S_);
      if (along > farthest) {
        farthest = along;
        best = e;
      }
    }
    return best;
  }

  [[nodiscard]] Side walk(std::size_t start, double side, double limit) const {
    Side result;
    std::size_t triangle = start;
    int edge = first_edge(start, side);
    Vec3 last = point_S_;
    double distance = 0.0;
    while (edge >= 0 && distance < limit) {
      const auto [place, displacement] = crossing(triangle, edge);
      distance += (place - last).norm();
      last = place;
      result.places.push_back({side * distance, displacement});
      const std::int32_t next = neighbours_[triangle][static_cast<std::size_t>(edge)];
      if (next < 0) return result;
      edge = exit_of(static_cast<std::size_t>(next), static_cast<std::int32_t>(triangle));
      triangle = static_cast<std::size_t>(next);
      if (triangle == start) {
        result.closed = true;
        return result;
      }
    }
    return result;
  }

 private:
  [[nodiscard]] std::size_t corner(std::size_t triangle, int i) const {
    return static_cast<std::size_t>(rest_.triangles[triangle][static_cast<std::size_t>(i % 3)]);
  }
  [[nodiscard]] double height(std::size_t vertex) const {
    return (rest_.vertices[vertex] - point_S_).dot(plane_);
  }
  [[nodiscard]] bool crossed(std::size_t triangle, int edge) const {
    return (height(corner(triangle, edge)) < 0.0) != (height(corner(triangle, edge + 1)) < 0.0);
  }
  /// Point at rest, and displacement there, where the plane crosses an edge.
  [[nodiscard]] std::pair<Vec3, double> crossing(std::size_t triangle, int edge) const {
    const std::size_t a = corner(triangle, edge);
    const std::size_t b = corner(triangle, edge + 1);
    const double t = height(a) / (height(a) - height(b));
    const auto at = [t](const Vec3& from, const Vec3& to) { return Vec3(from + t * (to - from)); };
    const Vec3 place = at(rest_.vertices[a], rest_.vertices[b]);
    return {place, (at(moved_[a], moved_[b]) - place).dot(direction_S_)};
  }
  /// The crossed edge of a triangle that does not lead back to `from`; -1: none.
  [[nodiscard]] int exit_of(std::size_t triangle, std::int32_t from) const {
    for (int e = 0; e < 3; ++e) {
      if (neighbours_[triangle][static_cast<std::size_t>(e)] != from && crossed(triangle, e)) return e;
    }
    return -1;
  }

  const geometry::TriangleMesh& rest_;
  const std::vector<Vec3>& moved_;
  std::vector<std::array<std::int32_t, 3>> neighbours_;
  Vec3 point_S_;
  Vec3 direction_S_;
  Vec3 plane_;
  Vec3 across_S_;
};

const contact::ContactView* deepest_view(const contact::ToolResult& result) {
  const contact::ContactView* deepest = nullptr;
  for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
    const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
    if (view.depth > 0.0 && (deepest == nullptr || view.depth > deepest->depth)) deepest = &view;
  }
  return deepest;
}

/// Distance [m] at which u(r) falls to kEndShare of the depth.
double end_of_profile(const deform::DisplacementProfile& profile, double depth) {
  double low = 0.0;
  double high = std::min(profile.outer_radius(), kLongest);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (profile.at(middle) > kEndShare * depth ? low : high) = middle;
  }
  return high;
}

}  // namespace

ReferenceProfile read_measured_profile(const std::filesystem::path& file) {
  CsvTable table(file, {{"r_mm"}, {"u_mm"}, {"depth_mm", false}}, kLargestNumber);
  ReferenceProfile profile{"measured", file.filename().string(), 0.0, {}, {}};
  double largest = 0.0;  // m, displacement
  while (table.next_row()) {
    const double depth = table.number(kDepthColumn) * kMillimetre;
    if (table.has(kDepthColumn) && !(depth > 0.0)) table.fail(kDepthColumn, "must be > 0");
    if (depth < profile.depth) continue;
    if (depth > profile.depth) profile.places.clear();
    profile.depth = depth;
    profile.places.push_back(
        {table.number(kDistanceColumn) * kMillimetre, table.number(kDisplacementColumn) * kMillimetre});
    largest = std::max(largest, profile.places.back().displacement);
  }
  if (profile.places.size() < kFewestPlaces) {
    throw InputError(fmt::format("{}: has {} of one depth, must have at least {}", file.string(),
                                 counted(profile.places.size(), "row", "rows"), kFewestPlaces));
  }
  if (!table.has(kDepthColumn)) profile.depth = largest;
  if (!(profile.depth > 0.0)) {
    throw InputError(file.string() +
                     ": no u_mm is positive; displacement in the direction of the tool is positive");
  }
  std::stable_sort(profile.places.begin(), profile.places.end(),
                   [](const LinePlace& a, const LinePlace& b) { return a.distance < b.distance; });
  return profile;
}

std::size_t row_of_profile(const HandAnalysis& hand, model::Direction direction,
                           const ReferenceProfile* measured) {
  if (measured == nullptr) return hand.key_ticks.deepest;
  for (std::size_t i = 0; i < hand.rows.size(); ++i) {
    if (in_contact(hand.rows[i], direction) && hand.rows[i].depth >= measured->depth) return i;
  }
  return hand.key_ticks.deepest;
}

std::vector<LinePlace> follow_section(const geometry::TriangleMesh& rest, const std::vector<Vec3>& moved,
                                      std::size_t start, const Vec3& point_S, const Vec3& direction_S,
                                      const Vec3& across_S, double limit) {
  const geometry::Triangle& t = rest.triangles.at(start);
  Vec3 middle = Vec3::Zero();
  for (const std::int32_t v : t) middle += rest.vertices[static_cast<std::size_t>(v)] / 3.0;
  // A point on an edge or a corner would leave open which triangle the plane crosses.
  constexpr double kInwards = 1e-3;
  const SectionWalk walk(rest, moved, point_S + kInwards * (middle - point_S), direction_S, across_S);
  Side left = walk.walk(start, -1.0, limit);
  Side right = walk.walk(start, 1.0, limit);
  if (left.closed && right.closed) {  // both have gone round: each keeps its half
    const double half = 0.5 * right.places.back().distance;
    std::erase_if(left.places, [half](const LinePlace& place) { return place.distance < -half; });
    std::erase_if(right.places, [half](const LinePlace& place) { return place.distance > half; });
  }
  std::reverse(left.places.begin(), left.places.end());
  left.places.insert(left.places.end(), right.places.begin(), right.places.end());
  return left.places;
}

SurfaceLine surface_line(const scene::Scene& scene, const haptics::Snapshot& snapshot, std::size_t hand,
                         const Vec3& across_S) {
  SurfaceLine line;
  const contact::ContactView* view = deepest_view(snapshot.results.at(hand));
  if (view == nullptr) return line;
  const std::vector<deform::Indentation> all = deform::indentations_of(snapshot.hand_results());
  const std::vector<deform::Indentation> own = deform::indentations_of({&snapshot.results.at(hand), 1});
  const auto deepest = std::max_element(own.begin(), own.end(),
                                        [](const auto& a, const auto& b) { return a.depth < b.depth; });
  line.depth = deepest->depth;
  line.tip_radius = deepest->tip_radius;
  line.contacts = static_cast<int>(own.size());
  line.contacts_of_others = static_cast<int>(all.size() - own.size());

  std::vector<render::ToolShape> shapes;
  for (const geometry::Tool& tool : scene.tools) shapes.emplace_back(tool);
  render::OrganPicture organ(scene.organ, snapshot.reach, render::Detail::kStill, scene.support, scene.store);
  organ.update(all, render::imprints_of(snapshot, shapes));
  std::vector<Vec3> moved;
  for (const deform::SurfaceVertex& vertex : organ.vertices())
    moved.emplace_back(vertex.position.cast<double>());

  const contact::SurfacePoint start = deform::TriangleSearch(organ.rest()).nearest(view->point_S);
  const Vec3 level = across_S - across_S.dot(view->direction_S) * view->direction_S;
  if (start.triangle < 0 || !(level.norm() > 0.0)) return line;
  const deform::DisplacementProfile profile(snapshot.reach, line.depth, line.tip_radius);
  line.places = follow_section(organ.rest(), moved, static_cast<std::size_t>(start.triangle), start.point,
                               view->direction_S, level.normalized(), end_of_profile(profile, line.depth));
  return line;
}

double displacement_at(const std::vector<LinePlace>& places, double distance) noexcept {
  const auto above = std::lower_bound(places.begin(), places.end(), distance,
                                      [](const LinePlace& place, double r) { return place.distance < r; });
  if (above == places.end() || (above == places.begin() && above->distance > distance))
    return std::numeric_limits<double>::quiet_NaN();
  if (above == places.begin() || above->distance == distance) return above->displacement;
  const LinePlace& below = *(above - 1);
  const double t = (distance - below.distance) / (above->distance - below.distance);
  return below.displacement + t * (above->displacement - below.displacement);
}

}  // namespace palpate::report

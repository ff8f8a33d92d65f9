#include "run/palpation/felt_map.h"

#include <algorithm>
#include <cmath>

#include "core/contact/state.h"
#include "core/contact/tool_tissue.h"
#include "palpate/tool_contact.h"

namespace palpate::palpation {
namespace {

constexpr double kLeastDepth = 1e-3;     // m: the factor of shallower presses is inexact
constexpr double kLeastTicks = 20.0;     // weighted, of a vertex whose factor is known
constexpr double kLeastReach = 3e-3;     // m
constexpr double kLargestReach = 10e-3;  // m; also the width of the grid's cells

/// Area-weighted unit normals. (The prepared surface's normals have one side each at sharp edges.)
std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const geometry::Triangle& triangle : mesh.triangles) {
    const Vec3 area = geometry::area_vector_doubled(mesh, triangle);
    for (const std::int32_t v : triangle) normals[static_cast<std::size_t>(v)] += area;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

}  // namespace

double normal_force(const haptics::TickRow& row) noexcept {
  return std::sqrt(std::max(0.0, row.tissue_force * row.tissue_force - row.friction * row.friction));
}

FeltMap::FeltMap(const contact::World& world)
    : world_(world),
      normals_(vertex_normals(surface())),
      sums_(surface().vertices.size()),
      last_(world.tool_count()) {
  for (std::size_t v = 0; v < sums_.size(); ++v) {
    cells_[geometry::cell_at(surface().vertices[v], kLargestReach)].push_back(static_cast<std::int32_t>(v));
  }
}

double FeltMap::reach(std::size_t hand) const noexcept {
  return std::clamp(world_.tip_radius(hand), kLeastReach, kLargestReach);
}

double FeltMap::depth_rate(const haptics::TickRow& row) {
  Last& last = last_[row.hand];
  const bool follows = last.depth > 0.0 && row.time > last.time && row.time - last.time < 0.1;
  const double rate =
      follows ? (row.depth - last.depth) / (row.time - last.time) : std::numeric_limits<double>::quiet_NaN();
  last = {row.time, row.depth};
  return rate;
}

void FeltMap::add(const haptics::TickRow& row, const Pose& organ_W) {
  const double rate = depth_rate(row);
  if (static_cast<contact::Phase>(row.phase) != contact::Phase::kPress || !(row.depth > 0.0)) return;
  const Pose to_organ = organ_W.inverse();
  const Vec3 contact_S = to_organ * Vec3(row.contact[0], row.contact[1], row.contact[2]);
  const Vec3 normal_S = to_organ.rotation * Vec3(row.normal[0], row.normal[1], row.normal[2]);
  const double normal = normal_force(row);
  const double force = normal - world_.tissue().contact.damping * rate;
  const bool tells =
      std::isfinite(rate) && row.depth >= kLeastDepth && (row.status & contact::kStartedInside) == 0;
  const double size = world_.data().laws.size_factor(world_.tip_radius(row.hand));
  const double uniform = tells ? size * world_.press_law().force_at(row.depth).force : 0.0;
  const double reach_squared = reach(row.hand) * reach(row.hand);
  const auto add_to = [&](Sums& sums, double weight) {
    if (tells) {
      sums.ticks += weight;
      sums.force += weight * force;
      sums.uniform += weight * uniform;
    }
    sums.deepest = std::max(sums.deepest, static_cast<float>(row.depth));
    sums.largest = std::max(sums.largest, static_cast<float>(normal));
  };
  uniform_ += uniform;
  depth_ += uniform * row.depth;
  const geometry::Cell middle = geometry::cell_at(contact_S, kLargestReach);
  for (int k = 0; k < 27; ++k) {
    const auto found = cells_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
    if (found == cells_.end()) continue;
    for (const std::int32_t vertex : found->second) {
      const auto v = static_cast<std::size_t>(vertex);
      const double squared = (surface().vertices[v] - contact_S).squaredNorm();
      // The far side of a thin organ looks the other way.
      if (squared >= reach_squared || !(normals_[v].dot(normal_S) > 0.0)) continue;
      const double share = 1.0 - squared / reach_squared;
      add_to(sums_[v], share * share);
    }
  }
}

FeltPlace FeltMap::at(std::size_t vertex) const {
  const Sums& sums = sums_[vertex];
  FeltPlace place;
  if (sums.ticks >= kLeastTicks) place.factor = sums.force / sums.uniform;
  place.depth = sums.deepest;
  place.force = sums.largest;
  return place;
}

double FeltMap::true_factor(std::size_t vertex) const {
  constexpr double kUsualDepth = 5e-3;  // m
  const double depth = uniform_ > 0.0 ? depth_ / uniform_ : kUsualDepth;
  const contact::World::Data& data = world_.data();
  const contact::ToolTissue tissue{data.laws, data.inclusions.now(), data.map, world_.tip_radius(0)};
  const geometry::NearestPoint place = data.surface.nearest(surface().vertices[vertex], -1);
  const contact::TissueAt at(tissue, {place.point, place.triangle});
  return at.force_at(data.laws.press, depth).normal /
         (tissue.size_factor * data.laws.press.force_at(depth).force);
}

}  // namespace palpate::palpation

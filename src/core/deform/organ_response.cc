#include "core/deform/organ_response.h"

#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/base/text.h"
#include "core/deform/surface_parts.h"
#include "core/deform/triangle_search.h"
#include "palpate/surface.h"
#include "palpate/units.h"

namespace palpate::deform {

using Eigen::Index;

OrganResponse::OrganResponse(const geometry::TriangleMesh& organ, const geometry::Support& support,
                             const contact::OrganStore* store)
    : body_(body_compliance(organ, support, store)) {
  gather_surface(organ);
}

void OrganResponse::gather_surface(const geometry::TriangleMesh& organ) {
  // Parts of about the same place and direction become one, so that their number does not depend on the
  // mesh's fineness.
  using Key = std::pair<std::size_t, std::array<int, 4>>;  // cell; part of the cell, octant of the normal
  struct Sum {
    Vec3 moment = Vec3::Zero();  // of the places, by area
    Vec3 area = Vec3::Zero();
    double size = 0.0;
  };
  std::map<Key, Sum> gathered;
  for_each_part(organ, body_.grid.edge() / kPartsOfCell, [&](const Vec3& point, const Vec3& area) {
    const CellGrid::Place place = body_.grid.place_of(point);
    Key key{body_.grid.number_of(place.cell), {}};
    for (std::size_t axis = 0; axis < 3; ++axis)
      key.second[axis] = static_cast<int>(place.within[axis] * kPartsOfCell);
    for (Index axis = 0; axis < 3; ++axis) key.second[3] = 2 * key.second[3] + (area[axis] < 0.0 ? 1 : 0);
    Sum& sum = gathered[key];
    sum.moment += area.norm() * point;
    sum.area += area;
    sum.size += area.norm();
  });
  first_part_.assign(static_cast<std::size_t>(body_.grid.cells()[0]) *
                             static_cast<std::size_t>(body_.grid.cells()[1]) *
                             static_cast<std::size_t>(body_.grid.cells()[2]) +
                         1,
                     0);
  for (const auto& [key, sum] : gathered) {
    ++first_part_[key.first + 1];
    parts_.push_back({sum.moment / sum.size, sum.area});
  }
  std::partial_sum(first_part_.begin(), first_part_.end(), first_part_.begin());
}

OrganResponse::Load OrganResponse::load_at(const Vec3& point, const Vec3& normal, double radius) const {
  const CellGrid::Place low = body_.grid.place_of(point - Vec3::Constant(radius));
  const CellGrid::Place high = body_.grid.place_of(point + Vec3::Constant(radius));
  std::map<std::int32_t, double> shares;
  Load load;
  double total = 0.0;
  const auto take = [&](const SurfacePart& part, double weight) {
    total += weight;
    load.normal += weight * part.area.normalized();
    const CellGrid::Place place = body_.grid.place_of(part.point);
    const auto nodes = body_.grid.nodes_of(place.cell);
    const auto weights = CellGrid::weights(place);
    for (std::size_t n = 0; n < nodes.size(); ++n) shares[body_.unknown_of[nodes[n]]] += weight * weights[n];
  };
  std::array<int, 3> cell{};
  for (cell[0] = low.cell[0]; cell[0] <= high.cell[0]; ++cell[0]) {
    for (cell[1] = low.cell[1]; cell[1] <= high.cell[1]; ++cell[1]) {
      for (cell[2] = low.cell[2]; cell[2] <= high.cell[2]; ++cell[2]) {
        const std::size_t number = body_.grid.number_of(cell);
        for (std::int32_t p = first_part_[number]; p < first_part_[number + 1]; ++p) {
          const SurfacePart& part = parts_[palpate::at(p)];
          const double inside = 1.0 - (part.point - point).squaredNorm() / (radius * radius);
          const double facing = part.area.dot(normal);
          if (inside > 0.0 && facing > 0.0) take(part, facing * std::sqrt(inside));
        }
      }
    }
  }
  if (!(total > 0.0)) {  // on a sharp tip
    take({point, normal}, 1.0);
  }
  load.normal.normalize();
  for (const auto& [node, share] : shares) load.shares.emplace_back(node, static_cast<float>(share / total));
  return load;
}

OrganResponse::Displacements OrganResponse::none() const {
  return Displacements(body_.grid.nodes(), Eigen::Vector4f::Zero());
}

std::array<OrganResponse::Displacements, 3> OrganResponse::under(const Load& load) const {
  const BlockInverse::ByAxis sums = body_.compliance.columns(load.shares);
  std::array<Displacements, 3> under;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    under[axis] = none();
    for (std::size_t n = 0; n < body_.nodes.size(); ++n)
      under[axis][palpate::at(body_.nodes[n])].head<3>() =
          Eigen::Vector3f(sums[axis][3 * n], sums[axis][3 * n + 1], sums[axis][3 * n + 2]);
  }
  return under;
}

double OrganResponse::work(const Load& load, const Eigen::Vector3f& force, const Displacements& field) const {
  double work = 0.0;
  for (const auto& [node, share] : load.shares)
    work +=
        static_cast<double>(share * field[palpate::at(body_.nodes[palpate::at(node)])].head<3>().dot(force));
  return work;
}

Vec3 OrganResponse::at(const Displacements& field, const Vec3& point) const noexcept {
  const CellGrid::Place place = body_.grid.place_of(point);
  const auto nodes = body_.grid.nodes_of(place.cell);
  const auto weights = CellGrid::weights(place);
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 0; n < nodes.size(); ++n) sum += weights[n] * field[nodes[n]].head<3>().cast<double>();
  return sum;
}

ResponseCells response_cells(const geometry::TriangleMesh& organ) {
  ResponseCells cells{finest_grid(organ).edge(), 0.0};
  const TriangleSearch search(organ);
  double thin = 0.0;
  double whole = 0.0;
  for (const geometry::Triangle& t : organ.triangles) {
    const Vec3& a = organ.vertices[palpate::at(t[0])];
    const Vec3& b = organ.vertices[palpate::at(t[1])];
    const Vec3& c = organ.vertices[palpate::at(t[2])];
    const Vec3 normal = (b - a).cross(c - a);
    const double size = normal.norm();
    if (!(size > 0.0)) continue;
    whole += size;
    if (search.far_side((a + b + c) / 3.0, -normal / size, cells.edge) < kInfinity) thin += size;
  }
  cells.thin_share = thin / whole;
  return cells;
}

std::string describe(const ResponseCells& cells) {
  return brief(cells.edge / kMillimetre, 3) + " mm; " + percent(cells.thin_share, 1) +
         " of the surface is on thinner parts, where the deformation shown is not reliable";
}

std::shared_ptr<const OrganResponse> prepare_response(const geometry::TriangleMesh& organ,
                                                      const geometry::Support& support,
                                                      const contact::OrganStore* store) {
  return std::make_shared<const OrganResponse>(organ, support, store);
}

}  // namespace palpate::deform

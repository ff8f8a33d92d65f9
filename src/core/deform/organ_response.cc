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
  // Piece; part of the cell, octant of the normal. Pieces come by the number of their cells.
  using Key = std::pair<std::size_t, std::array<int, 4>>;
  const CutCells& cells = pieces().cells();
  struct Sum {
    Vec3 moment = Vec3::Zero();  // of the places, by area
    Vec3 area = Vec3::Zero();
    double size = 0.0;
  };
  std::map<Key, Sum> gathered;
  auto last = gathered.end();  // often the next one's as well
  for_each_part(organ, cells.eighths().edge() / kPartsOfCell, [&](const Vec3& point, const Vec3& area) {
    const CellPieces::Place place = pieces().place_of(point, area.normalized());
    Key key{place.piece, {}};
    for (std::size_t axis = 0; axis < 3; ++axis)
      key.second[axis] = static_cast<int>(place.within[axis] * kPartsOfCell);
    for (Index axis = 0; axis < 3; ++axis) key.second[3] = 2 * key.second[3] + (area[axis] < 0.0 ? 1 : 0);
    if (last == gathered.end() || last->first != key) last = gathered.try_emplace(key).first;
    Sum& sum = last->second;
    sum.moment += area.norm() * point;
    sum.area += area;
    sum.size += area.norm();
  });
  first_part_.assign(cells.count() + 1, 0);
  for (const auto& [key, sum] : gathered) {
    const std::size_t cell = pieces().pieces()[key.first].cell;
    const Vec3 point = sum.moment / sum.size;
    ++first_part_[cell + 1];
    parts_.push_back({point, sum.area, {key.first, cells.within(cell, point)}});
  }
  std::partial_sum(first_part_.begin(), first_part_.end(), first_part_.begin());
}

OrganResponse::Load OrganResponse::load_at(const Vec3& point, const Vec3& normal, double radius) const {
  std::map<std::int32_t, double> shares;
  Load load;
  double total = 0.0;
  const auto take = [&](const SurfacePart& part, double weight) {
    total += weight;
    load.normal += weight * part.area.normalized();
    const auto& splines = pieces().pieces()[part.place.piece].splines;
    const auto weights = CellGrid::weights(part.place.within);
    for (std::size_t n = 0; n < splines.size(); ++n)
      pieces().for_each_term(splines[n], [&](std::int32_t node, float term) {
        shares[node] += weight * weights[n] * static_cast<double>(term);
      });
  };
  const auto take_all = [&](std::size_t cell) {
    for (std::int32_t p = first_part_[cell]; p < first_part_[cell + 1]; ++p) {
      const SurfacePart& part = parts_[palpate::at(p)];
      const double inside = 1.0 - (part.point - point).squaredNorm() / (radius * radius);
      const double facing = part.area.dot(normal);
      if (inside > 0.0 && facing > 0.0) take(part, facing * std::sqrt(inside));
    }
  };
  const CutCells& cells = pieces().cells();
  for (const CellGrid* grid : {&cells.whole(), &cells.eighths()}) {
    const std::array<int, 3> low = grid->place_of(point - Vec3::Constant(radius)).cell;
    const std::array<int, 3> high = grid->place_of(point + Vec3::Constant(radius)).cell;
    std::array<int, 3> cell{};
    for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2])
          take_all(grid == &cells.whole() ? grid->number_of(cell) : cells.eighth(cell));
  }
  if (!(total > 0.0)) {  // on a sharp tip
    take({point, normal, pieces().place_of(point, normal)}, 1.0);
  }
  load.normal.normalize();
  for (const auto& [node, share] : shares) load.shares.emplace_back(node, static_cast<float>(share / total));
  return load;
}

OrganResponse::Displacements OrganResponse::none() const {
  return Displacements(pieces().splines(), Eigen::Vector4f::Zero());
}

std::array<OrganResponse::Displacements, 3> OrganResponse::under(const Load& load) const {
  const BlockInverse::ByAxis sums = body_.compliance.columns(load.shares);
  std::array<Displacements, 3> under;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    under[axis] = none();
    for (std::size_t n = 0; n < pieces().nodes(); ++n)
      under[axis][n].head<3>() =
          Eigen::Vector3f(sums[axis][3 * n], sums[axis][3 * n + 1], sums[axis][3 * n + 2]);
    for (std::size_t n = pieces().nodes(); n < under[axis].size(); ++n)
      for (const auto& [node, weight] : pieces().terms_of(static_cast<std::int32_t>(n)))
        under[axis][n] += weight * under[axis][palpate::at(node)];
  }
  return under;
}

double OrganResponse::work(const Load& load, const Eigen::Vector3f& force, const Displacements& field) const {
  double work = 0.0;
  for (const auto& [node, share] : load.shares)
    work += static_cast<double>(share * field[palpate::at(node)].head<3>().dot(force));
  return work;
}

Vec3 OrganResponse::at(const Displacements& field, const CellPieces::Place& place) const noexcept {
  const auto& nodes = pieces().pieces()[place.piece].splines;
  const auto weights = CellGrid::weights(place.within);
  Vec3 sum = Vec3::Zero();
  for (std::size_t n = 0; n < nodes.size(); ++n)
    sum += weights[n] * field[palpate::at(nodes[n])].head<3>().cast<double>();
  return sum;
}

ResponseCells response_cells(const geometry::TriangleMesh& organ) {
  const CellPieces pieces = finest_pieces(organ);
  ResponseCells cells{pieces.cells().whole().edge(), 0.0};
  const TriangleSearch search(organ);
  double thin = 0.0;
  double whole = 0.0;
  for (const geometry::Triangle& t : organ.triangles) {
    const Vec3& a = organ.vertices[palpate::at(t[0])];
    const Vec3& b = organ.vertices[palpate::at(t[1])];
    const Vec3& c = organ.vertices[palpate::at(t[2])];
    const Vec3 area = (b - a).cross(c - a);
    const double size = area.norm();
    if (!(size > 0.0)) continue;
    whole += size;
    const Vec3 middle = (a + b + c) / 3.0;
    const Vec3 normal = area / size;
    const double edge = pieces.edge_of(pieces.place_of(middle, normal).piece);
    if (search.far_side(middle, -normal, edge) < kInfinity) thin += size;
  }
  cells.thin_share = thin / whole;
  return cells;
}

std::string describe(const ResponseCells& cells) {
  return brief(cells.edge / kMillimetre, 3) + " mm, half as large where the organ is thin; " +
         percent(cells.thin_share, 1) +
         " of the surface is on parts thinner than their cells, where the deformation shown is not reliable";
}

std::shared_ptr<const OrganResponse> prepare_response(const geometry::TriangleMesh& organ,
                                                      const geometry::Support& support,
                                                      const contact::OrganStore* store) {
  return std::make_shared<const OrganResponse>(organ, support, store);
}

}  // namespace palpate::deform

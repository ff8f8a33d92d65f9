#include "core/deform/triangle_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/geometry/signed_distance.h"

namespace palpate::deform {
namespace {

constexpr double kEdgesACell = 2.0;
constexpr double kMaxCells = 4e6;
constexpr double kOwnFace = 1e-6;  // m; a nearer hit is the start's own triangle

double mean_edge(const geometry::TriangleMesh& mesh) {
  double sum = 0.0;
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t e = 0; e < 3; ++e)
      sum += (mesh.vertices[at(t[e])] - mesh.vertices[at(t[(e + 1) % 3])]).norm();
  return mesh.triangles.empty() ? 0.0 : sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

geometry::Bounds box_of(const geometry::TriangleMesh& mesh, const geometry::Triangle& t) {
  geometry::Bounds box{mesh.vertices[at(t[0])], mesh.vertices[at(t[0])]};
  for (const std::int32_t v : t) {
    box.low = box.low.cwiseMin(mesh.vertices[at(v)]);
    box.high = box.high.cwiseMax(mesh.vertices[at(v)]);
  }
  return box;
}

// Distance [m] from a point along a unit direction to a triangle that faces in that direction; infinity when
// it misses.
double distance_to_far_side(const geometry::TriangleMesh& mesh, const geometry::Triangle& triangle,
                            const Vec3& start, const Vec3& direction) {
  // Moeller and Trumbore 1997; the determinant is minus `facing`.
  const Vec3& a = mesh.vertices[at(triangle[0])];
  const Vec3 ab = mesh.vertices[at(triangle[1])] - a;
  const Vec3 ac = mesh.vertices[at(triangle[2])] - a;
  const double facing = ab.cross(ac).dot(direction);
  if (!(facing > 0.0)) return kInfinity;
  const Vec3 p = direction.cross(ac);
  const Vec3 s = start - a;
  const double u = -s.dot(p) / facing;
  const Vec3 q = s.cross(ab);
  const double v = -direction.dot(q) / facing;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return kInfinity;
  const double distance = -ac.dot(q) / facing;
  return distance > kOwnFace ? distance : kInfinity;
}

}  // namespace

TriangleGrid::TriangleGrid(const geometry::TriangleMesh& mesh) : mesh_(mesh) {
  const geometry::Bounds box = geometry::bounds(mesh);
  low_ = box.low;
  const double volume = std::max(1e-18, box.size().prod());
  width_ = std::max(
      {kEdgesACell * mean_edge(mesh), std::cbrt(volume / kMaxCells), box.size().maxCoeff() / 1000.0, 1e-9});
  for (int k = 0; k < 3; ++k)
    count_[static_cast<std::size_t>(k)] = 1 + static_cast<int>(box.size()[k] / width_);
  start_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                        static_cast<std::size_t>(count_[2]) +
                    1,
                0);
  const auto for_each_cell = [this](const auto& use) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const geometry::Bounds around = box_of(mesh_, mesh_.triangles[t]);
      const Cell first = cell_of(around.low);
      const Cell last = cell_of(around.high);
      for (int i = first[0]; i <= last[0]; ++i)
        for (int j = first[1]; j <= last[1]; ++j)
          for (int k = first[2]; k <= last[2]; ++k) use(place({i, j, k}), static_cast<std::int32_t>(t));
    }
  };
  for_each_cell([this](std::size_t cell, std::int32_t) { ++start_[cell + 1]; });
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  inside_.resize(at(start_.back()));
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for_each_cell([this, &next](std::size_t cell, std::int32_t t) { inside_[at(next[cell]++)] = t; });
}

TriangleGrid::Cell TriangleGrid::cell_of(const Vec3& p) const noexcept {
  Cell c{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    const double x = (p[axis] - low_[axis]) / width_;
    c[k] = static_cast<int>(std::clamp(x, 0.0, static_cast<double>(count_[k] - 1)));
  }
  return c;
}

std::size_t TriangleGrid::place(const Cell& c) const noexcept {
  return (static_cast<std::size_t>(c[0]) * static_cast<std::size_t>(count_[1]) +
          static_cast<std::size_t>(c[1])) *
             static_cast<std::size_t>(count_[2]) +
         static_cast<std::size_t>(c[2]);
}

void TriangleGrid::nearest_in(const Cell& c, const Vec3& p, contact::SurfacePoint& best,
                              double& best_squared) const {
  const std::size_t cell = place(c);
  for (std::int32_t i = start_[cell]; i < start_[cell + 1]; ++i) {
    const std::int32_t t = inside_[at(i)];
    const auto [ia, ib, ic] = mesh_.triangles[at(t)];
    const Vec3 q = geometry::nearest_on_triangle(p, mesh_.vertices[at(ia)], mesh_.vertices[at(ib)],
                                                 mesh_.vertices[at(ic)]);
    const double squared = (q - p).squaredNorm();
    if (squared < best_squared || (squared == best_squared && t < best.triangle)) {
      best_squared = squared;
      best.triangle = t;
      best.point = q;
    }
  }
}

contact::SurfacePoint TriangleGrid::nearest(const Vec3& p) const {
  contact::SurfacePoint best;
  double best_squared = kInfinity;
  const Cell middle = cell_of(p);
  const int most = std::max({count_[0], count_[1], count_[2]});
  // Searches shells of cells around p's cell (or the nearest cell when p is outside the grid), until no
  // farther cell can hold anything nearer.
  Vec3 held = p;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    held[axis] = std::clamp(p[axis], low_[axis], low_[axis] + width_ * count_[k]);
  }
  for (int shell = 0; shell <= most; ++shell) {
    if (shell > 0) {
      const double least = (shell - 1) * width_;
      if (best_squared < kInfinity && least > 0.0 && least * least > best_squared - (p - held).squaredNorm())
        break;
    }
    for (int i = -shell; i <= shell; ++i) {
      for (int j = -shell; j <= shell; ++j) {
        const bool face = std::abs(i) == shell || std::abs(j) == shell;
        for (int k = -shell; k <= shell; k += face || shell == 0 ? 1 : 2 * shell) {
          const Cell c = {middle[0] + i, middle[1] + j, middle[2] + k};
          bool inside = true;
          for (std::size_t axis = 0; axis < 3; ++axis)
            inside = inside && c[axis] >= 0 && c[axis] < count_[axis];
          if (inside) nearest_in(c, p, best, best_squared);
        }
      }
    }
  }
  return best;
}

double TriangleGrid::far_side(const Vec3& start, const Vec3& direction, double limit) const {
  double nearest = kInfinity;
  // In steps of half a cell, with the neighbouring cells, so that no cell on the ray is missed.
  std::size_t last = static_cast<std::size_t>(-1);
  for (int step = 0; 0.5 * width_ * step <= limit + width_; ++step) {
    const double way = 0.5 * width_ * step;
    if (way > nearest + 2.0 * width_) break;
    const Cell middle = cell_of(start + way * direction);
    if (place(middle) == last) continue;
    last = place(middle);
    for (int i = std::max(0, middle[0] - 1); i <= std::min(count_[0] - 1, middle[0] + 1); ++i) {
      for (int j = std::max(0, middle[1] - 1); j <= std::min(count_[1] - 1, middle[1] + 1); ++j) {
        for (int k = std::max(0, middle[2] - 1); k <= std::min(count_[2] - 1, middle[2] + 1); ++k) {
          const std::size_t cell = place({i, j, k});
          for (std::int32_t n = start_[cell]; n < start_[cell + 1]; ++n)
            nearest = std::min(
                nearest, distance_to_far_side(mesh_, mesh_.triangles[at(inside_[at(n)])], start, direction));
        }
      }
    }
  }
  return nearest <= limit ? nearest : kInfinity;
}

}  // namespace palpate::deform

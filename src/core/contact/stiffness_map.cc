#include "core/contact/stiffness_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <Eigen/SparseCholesky>

#include "core/base/index.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::contact {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kStiffness = 10e-3;  // m, of the interpolation: nearer points are joined as by a thin plate,
                                      // farther ones as by a membrane
// Raise this whenever the values of any map change, so that older cache files are not used.
constexpr std::uint64_t kValuesVersion = 1;
constexpr double kHeld = 1e4;  // weight of a point, in units of the membrane's

double cotangent(const Vec3& a, const Vec3& b) noexcept {
  const double sine = a.cross(b).norm();
  return sine > 0.0 ? a.dot(b) / sine : 0.0;
}

/// The cotangent Laplacian [Pinkall, Polthier 1993], and a third of the triangles' areas around each vertex
/// [m^2].
std::pair<Sparse, Eigen::VectorXd> laplacian_of(const geometry::TriangleMesh& mesh) {
  const auto count = static_cast<Eigen::Index>(mesh.vertices.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd area = Eigen::VectorXd::Zero(count);
  for (const geometry::Triangle& triangle : mesh.triangles) {
    const double third = geometry::area_vector_doubled(mesh, triangle).norm() / 6.0;
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t a = triangle[e];
      const std::int32_t b = triangle[(e + 1) % 3];
      const Vec3& opposite = mesh.vertices[at(triangle[(e + 2) % 3])];
      const double weight = 0.5 * cotangent(mesh.vertices[at(a)] - opposite, mesh.vertices[at(b)] - opposite);
      entries.emplace_back(a, b, -weight);
      entries.emplace_back(b, a, -weight);
      entries.emplace_back(a, a, weight);
      entries.emplace_back(b, b, weight);
      area[a] += third;
    }
  }
  Sparse laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return {std::move(laplacian), std::move(area)};
}

struct Triangular {
  std::array<double, 3> weight;  // barycentric coordinates
  std::array<Vec3, 3> slope;     // their gradients [1/m]
};

Triangular triangular(const geometry::TriangleMesh& mesh, const geometry::Triangle& corners,
                      const Vec3& point) noexcept {
  const Vec3& a = mesh.vertices[at(corners[0])];
  const Vec3 ab = mesh.vertices[at(corners[1])] - a;
  const Vec3 ac = mesh.vertices[at(corners[2])] - a;
  const Vec3 doubled = ab.cross(ac);
  const double squared = doubled.squaredNorm();
  Triangular made{{1.0, 0.0, 0.0}, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  if (!(squared > 0.0)) return made;
  made.slope[1] = ac.cross(doubled) / squared;
  made.slope[2] = doubled.cross(ab) / squared;
  made.slope[0] = -made.slope[1] - made.slope[2];
  made.weight[1] = made.slope[1].dot(point - a);
  made.weight[2] = made.slope[2].dot(point - a);
  made.weight[0] = 1.0 - made.weight[1] - made.weight[2];
  return made;
}

/// A point of a map on the surface.
struct Held {
  geometry::Triangle corners{};
  std::array<double, 3> weight{};  // barycentric coordinates
  double logarithm = 0.0;          // of the factor
};

std::vector<Held> held_on(const OrganSurface& surface, std::span<const model::StiffnessPoint> points) {
  std::vector<Held> held;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const model::StiffnessPoint& one = points[i];
    const std::string name = "point " + std::to_string(i + 1) + " of the stiffness map";
    model::validate(one, "factor of " + name);
    const geometry::NearestPoint nearest = surface.nearest(one.point_S, -1);
    if (!(std::abs(nearest.distance) <= model::kFarthestStiffnessPoint)) {
      throw InputError(name + " is " + brief(std::abs(nearest.distance) / kMillimetre, 3) +
                       " mm from the organ's surface: must be at most " +
                       brief(model::kFarthestStiffnessPoint / kMillimetre, 3) + " mm");
    }
    const geometry::Triangle& corners = surface.mesh().triangles[at(nearest.triangle)];
    held.push_back(
        {corners, triangular(surface.mesh(), corners, nearest.point).weight, portable::log(one.factor)});
  }
  return held;
}

/// The values at the vertices of the smoothest function through the points.
std::vector<double> interpolated(const geometry::TriangleMesh& mesh, std::span<const Held> points) {
  const auto count = static_cast<Eigen::Index>(mesh.vertices.size());
  const auto [laplacian, area] = laplacian_of(mesh);
  const Eigen::VectorXd inverse = area.unaryExpr([](double a) { return a > 0.0 ? 1.0 / a : 0.0; });
  std::vector<Eigen::Triplet<double>> held;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (const Held& one : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      right[one.corners[a]] += kHeld * one.weight[a] * one.logarithm;
      for (std::size_t b = 0; b < 3; ++b) {
        held.emplace_back(one.corners[a], one.corners[b], kHeld * one.weight[a] * one.weight[b]);
      }
    }
  }
  Sparse pull(count, count);
  pull.setFromTriplets(held.begin(), held.end());
  const Sparse plate = laplacian.transpose() * inverse.asDiagonal() * laplacian;
  // The last term keeps the matrix regular on a part of the surface without points.
  Sparse unit(count, count);
  unit.setIdentity();
  const Sparse matrix = laplacian + kStiffness * kStiffness * plate + pull + 1e-9 * unit;
  const Eigen::SimplicialLDLT<Sparse> solver(matrix);
  if (solver.info() != Eigen::Success)
    throw InputError("stiffness map: cannot be interpolated on this organ");
  const Eigen::VectorXd logarithm = solver.solve(right);
  std::vector<double> values;
  values.reserve(mesh.vertices.size());
  for (Eigen::Index v = 0; v < count; ++v) values.push_back(portable::exp(logarithm[v]));
  return values;
}

/// Whether stored values can be those of a map.
bool are_factors(const std::vector<double>& values, std::size_t count) {
  return values.size() == count && std::all_of(values.begin(), values.end(), [](double value) {
           return value > 0.0 && std::isfinite(value);
         });
}

}  // namespace

ContentHash StiffnessMap::key(const geometry::TriangleMesh& refined,
                              std::span<const model::StiffnessPoint> points) {
  ContentHasher hasher;
  hasher.add(kValuesVersion).add(std::span<const Vec3>(refined.vertices));
  hasher.add(std::span<const geometry::Triangle>(refined.triangles));
  for (const model::StiffnessPoint& one : points) hasher.add(one.point_S).add(one.factor);
  return hasher.hash();
}

StiffnessMap::StiffnessMap(const OrganSurface& surface, std::span<const model::StiffnessPoint> points,
                           const OrganStore* store)
    : surface_(&surface) {
  const geometry::TriangleMesh& mesh = surface.mesh();
  const std::vector<Held> held = held_on(surface, points);
  const ContentHash name = store != nullptr ? key(mesh, points) : ContentHash{};
  if (store != nullptr) values_ = store->load_factors(name);
  if (!are_factors(values_, mesh.vertices.size())) {
    values_ = interpolated(mesh, held);
    if (store != nullptr) store->store_factors(name, values_);
  }
  set_gradients();
}

void StiffnessMap::set_gradients() {
  const geometry::TriangleMesh& mesh = surface_->mesh();
  gradients_.assign(mesh.vertices.size(), Vec3::Zero());
  std::vector<double> total(mesh.vertices.size(), 0.0);
  for (const geometry::Triangle& corners : mesh.triangles) {
    const Triangular here = triangular(mesh, corners, mesh.vertices[at(corners[0])]);
    const double weight = geometry::area_vector_doubled(mesh, corners).norm();
    Vec3 gradient = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) gradient += values_[at(corners[c])] * here.slope[c];
    for (const std::int32_t corner : corners) {
      gradients_[at(corner)] += weight * gradient;
      total[at(corner)] += weight;
    }
  }
  for (std::size_t v = 0; v < gradients_.size(); ++v) {
    if (total[v] > 0.0) gradients_[v] /= total[v];
  }
}

StiffnessMap::Factor StiffnessMap::factor_at(const SurfacePoint& place) const noexcept {
  if (empty()) return {};
  const geometry::TriangleMesh& mesh = surface_->mesh();
  const geometry::Triangle& corners = mesh.triangles[at(place.triangle)];
  const Triangular here = triangular(mesh, corners, place.point);
  Factor factor{0.0, Vec3::Zero()};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t v = at(corners[c]);
    const double linear = values_[v] + gradients_[v].dot(place.point - mesh.vertices[v]);
    factor.value += here.weight[c] * linear;
    factor.gradient_S += linear * here.slope[c] + here.weight[c] * gradients_[v];
  }
  return factor;
}

StiffnessMap::Steepness StiffnessMap::steepness_of(std::int32_t triangle) const noexcept {
  if (empty()) return {};
  const geometry::TriangleMesh& mesh = surface_->mesh();
  const geometry::Triangle& corners = mesh.triangles[at(triangle)];
  Steepness largest{0.0, 0.0, 0.0};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t v = at(corners[c]);
    const std::size_t w = at(corners[(c + 1) % 3]);
    const double distance = (mesh.vertices[v] - mesh.vertices[w]).norm();
    largest.value = std::max(largest.value, values_[v]);
    largest.slope = std::max(largest.slope, gradients_[v].norm());
    if (distance > 0.0) {
      largest.curvature = std::max(largest.curvature, (gradients_[v] - gradients_[w]).norm() / distance);
    }
  }
  return largest;
}

}  // namespace palpate::contact

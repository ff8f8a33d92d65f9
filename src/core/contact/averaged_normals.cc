#include "core/contact/averaged_normals.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "core/base/index.h"
#include "core/base/parallel.h"
#include "core/contact/facets.h"
#include "core/contact/normal_samples.h"
#include "core/geometry/cell.h"

namespace palpate::contact {
namespace {

constexpr double kPi = 3.14159265358979323846;
// triangle visits; up to here the normals take a few tenths of a second at every side
constexpr double kQuick = 1e7;
constexpr double kSpacingsInRadius = 4.0;  // spacing of samples = radius / kSpacingsInRadius

// On fine meshes faces are turned from the mean within this share of the radius: R_ref/5, the edge of coarser
// ones.
constexpr double kReferenceShare = 0.4;

// On fine meshes triangles are joined to facets up to this share of the radius.
constexpr double kFacetShare = 0.05;

/// Weighted sum of face normals [m^2] and its derivatives.
struct NormalSum {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  // with respect to the centre [m]
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();   // with respect to the reference [m^2]
};

/// Sums the face normals around one point by a flood over neighbouring facets. One object per thread.
class Flood final {
 public:
  Flood(const SurfaceView& surface, const Facets& facets)
      : surface_(surface), facets_(facets), seen_by_(facets.size(), -1) {}

  /// The normal of a side by the plain rule. @param first_corner the side's first corner
  NormalAndSlope average(std::int32_t first_corner, double radius) {
    fan_.collect(surface_, first_corner);
    by_moments_ = false;
    return average(first_corner, radius, {fan_.reference(), Eigen::Matrix3d::Zero()});
  }

  /// The normal of a side by the rule for fine meshes: turned from the mean within `smaller`.
  NormalAndSlope average_finely(std::int32_t first_corner, double radius, double smaller) {
    fan_.collect(surface_, first_corner);
    by_moments_ = true;
    return average(first_corner, radius,
                   average(first_corner, smaller, {fan_.reference(), Eigen::Matrix3d::Zero()}));
  }

 private:
  /// @param reference the normal from which faces are turned, and its slope
  NormalAndSlope average(std::int32_t first_corner, double radius, const NormalAndSlope& reference) {
    centre_ = corner(first_corner / 3, at(first_corner % 3));
    radius_ = radius;
    reference_ = reference.normal;
    sum_ = {};
    queue_.clear();
    ++flood_;
    for (const std::int32_t face : fan_.triangles()) reach(facets_.facet_of(face));
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      if (!add(queue_[i])) continue;
      for (const std::int32_t next : facets_.neighbours(queue_[i])) reach(next);
    }
    return NormalAndSlope::of(sum_.sum, sum_.slope + sum_.turn * reference.slope, reference_);
  }

  void reach(std::int32_t facet) {
    if (std::exchange(seen_by_[at(facet)], flood_) != flood_) queue_.push_back(facet);
  }

  [[nodiscard]] const Vec3& corner(std::int32_t face, std::size_t c) const {
    return surface_.mesh.vertices[at(surface_.mesh.triangles[at(face)][c])];
  }

  /// Adds a facet. @return whether a corner is within the radius; of a joined facet, whether its centre is
  bool add(std::int32_t number) {
    if (!by_moments_) return add_by_midpoints(number);
    const Facet& facet = facets_[number];
    const Vec3 u = centre_ - facet.centre;
    const double squared = u.squaredNorm();
    if (facet.triangle >= 0) {
      const double outer = radius_ + facet.reach;
      if (squared >= outer * outer) return false;
      const double inner = radius_ - facet.reach;
      if (inner <= 0.0 || squared >= inner * inner) return add_by_midpoints(facet.triangle);
    }
    if (squared >= radius_ * radius_) return false;
    const double inverse = 1.0 / (radius_ * radius_);
    const double weight = std::max(0.0, 3.0 - inverse * (3.0 * squared + facet.squares));
    const double cosine = reference_.dot(facet.area) / facet.area.norm();
    if (!(cosine > kSharpCosine)) return true;  // NaN: a triangle without area
    if (cosine < kFullCosine) {
      constexpr double kPerCosine = 1.0 / (kFullCosine - kSharpCosine);
      sum_.turn += (weight * kPerCosine / facet.area.norm()) * facet.area * facet.area.transpose();
    }
    const Vec3 area = counted(cosine) * facet.area;
    sum_.sum += weight * area;
    sum_.slope -= area * (6.0 * inverse * u).transpose();
    return true;
  }

  /// The share with which a face counts. @param cosine of the angle between its normal and the side's
  [[nodiscard]] static double counted(double cosine) {
    return std::clamp((cosine - kSharpCosine) / (kFullCosine - kSharpCosine), 0.0, 1.0);
  }

  bool add_by_midpoints(std::int32_t face) {
    const Vec3& a = corner(face, 0);
    const Vec3& b = corner(face, 1);
    const Vec3& c = corner(face, 2);
    const double radius_squared = radius_ * radius_;
    if (std::min({(a - centre_).squaredNorm(), (b - centre_).squaredNorm(), (c - centre_).squaredNorm()}) >=
        radius_squared) {
      return false;
    }
    // The three-midpoint rule integrates a quadratic weight over a triangle exactly.
    double weight = 0.0;
    Vec3 rise = Vec3::Zero();  // gradient of the weight with respect to the centre
    for (const Vec3& middle :
         {Vec3(0.5 * (a + b) - centre_), Vec3(0.5 * (b + c) - centre_), Vec3(0.5 * (c + a) - centre_)}) {
      const double share = 1.0 - middle.squaredNorm() / radius_squared;
      if (share <= 0.0) continue;
      weight += share;
      rise += (2.0 / radius_squared) * middle;
    }
    const double turned = counted(reference_.dot(surface_.face_normals[at(face)]));
    const Vec3 area = (b - a).cross(c - a);
    sum_.sum += weight * turned * area;
    sum_.slope += turned * area * rise.transpose();
    return true;
  }

  const SurfaceView& surface_;
  const Facets& facets_;
  SideFan fan_;
  bool by_moments_ = false;
  double radius_ = 0.0;
  Vec3 centre_ = Vec3::Zero();
  Vec3 reference_ = Vec3::Zero();
  NormalSum sum_;
  std::int32_t flood_ = 0;
  std::vector<std::int32_t> seen_by_;  // per facet: the last flood that visited it
  std::vector<std::int32_t> queue_;
};

/// Estimated number of triangle visits, averaging at every side.
double work_of(const SurfaceView& surface, const Sides& sides, double radius) {
  double area = 0.0;
  for (const geometry::Triangle& triangle : surface.mesh.triangles) {
    area += 0.5 * geometry::area_vector_doubled(surface.mesh, triangle).norm();
  }
  const double in_reach = kPi * radius * radius * static_cast<double>(surface.mesh.triangles.size());
  return area > 0.0 ? static_cast<double>(sides.first_corner.size()) * in_reach / area : 0.0;
}

/// Indices of corners, those in one cell of the size `radius` together: floods in turn then share memory.
std::vector<std::size_t> by_place(const SurfaceView& surface, const std::vector<std::int32_t>& corners,
                                  double radius) {
  std::vector<std::pair<geometry::Cell, std::size_t>> cells;
  for (const std::int32_t corner : corners) {
    const std::int32_t vertex = surface.mesh.triangles[at(corner / 3)][at(corner % 3)];
    cells.emplace_back(geometry::cell_at(surface.mesh.vertices[at(vertex)], radius), cells.size());
  }
  std::sort(cells.begin(), cells.end());
  std::vector<std::size_t> order;
  for (const auto& [cell, index] : cells) order.push_back(index);
  return order;
}

}  // namespace

NormalAndSlope NormalAndSlope::of(const Vec3& sum, const Eigen::Matrix3d& slope, const Vec3& otherwise) {
  const double length = sum.norm();
  if (!(length > 0.0)) return {otherwise, Eigen::Matrix3d::Zero()};
  const Vec3 normal = sum / length;
  return {normal, (slope - normal * (normal.transpose() * slope)) / length};
}

Sides find_sides(const SurfaceView& surface) {
  const std::vector<geometry::Triangle>& triangles = surface.mesh.triangles;
  Sides sides;
  sides.first_corner.assign(surface.mesh.vertices.size(), -1);
  sides.of_corner.assign(3 * triangles.size(), -1);
  sides.mean_normal.assign(surface.mesh.vertices.size(), Vec3::Zero());
  SideFan fan;
  for (std::size_t corner = 0; corner < sides.of_corner.size(); ++corner) {
    if (sides.of_corner[corner] >= 0) continue;
    const std::int32_t vertex = triangles[corner / 3][corner % 3];
    const auto first = static_cast<std::int32_t>(corner);
    std::int32_t side = vertex;
    if (sides.first_corner[at(vertex)] < 0) {
      sides.first_corner[at(vertex)] = first;
    } else {
      side = static_cast<std::int32_t>(sides.first_corner.size());
      sides.first_corner.push_back(first);
      sides.mean_normal.emplace_back();
    }
    fan.collect(surface, first);
    sides.mean_normal[at(side)] = fan.reference();
    for (const std::int32_t face : fan.triangles()) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (triangles[at(face)][c] == vertex) sides.of_corner[3 * at(face) + c] = side;
      }
    }
  }
  return sides;
}

void SideFan::collect(const SurfaceView& surface, std::int32_t first_corner) {
  const geometry::TriangleMesh& mesh = surface.mesh;
  const std::int32_t vertex = mesh.triangles[at(first_corner / 3)][at(first_corner % 3)];
  seen_by_.resize(mesh.triangles.size(), -1);
  ++collection_;
  triangles_.assign(1, first_corner / 3);
  seen_by_[at(first_corner / 3)] = collection_;
  reference_ = Vec3::Zero();
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const std::int32_t face = triangles_[i];
    const geometry::Triangle& triangle = mesh.triangles[at(face)];
    reference_ += geometry::area_vector_doubled(mesh, triangle);
    for (std::size_t e = 0; e < 3; ++e) {
      if (triangle[e] != vertex && triangle[(e + 1) % 3] != vertex) continue;
      const std::int32_t other = surface.neighbours[at(face)][e];
      if (other < 0 || seen_by_[at(other)] == collection_) continue;
      if (surface.face_normals[at(face)].dot(surface.face_normals[at(other)]) < kSharpCosine) continue;
      seen_by_[at(other)] = collection_;
      triangles_.push_back(other);
    }
  }
  reference_.normalize();
}

double sample_spacing_for(const SurfaceView& surface, const Sides& sides, double radius) {
  return work_of(surface, sides, radius) <= kQuick ? 0.0 : radius / kSpacingsInRadius;
}

std::vector<NormalAndSlope> averaged_normals(const SurfaceView& surface, const Sides& sides, double radius,
                                             double spacing, const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 256;  // samples between two progress reports
  constexpr std::size_t kGrain = 16;
  NormalSamples samples(surface, sides, spacing);
  const std::vector<std::int32_t>& corners = samples.first_corners();
  std::optional<Facets> facets(std::in_place, surface, spacing > 0.0 ? kFacetShare * radius : 0.0);
  std::vector<NormalAndSlope> averaged(corners.size());
  const std::vector<std::size_t> order = by_place(surface, corners, radius);
  std::mutex mutex;
  std::vector<std::unique_ptr<Flood>> idle;
  for (std::size_t from = 0; from < corners.size(); from += kBatch) {
    if (progress) progress(static_cast<double>(from) / static_cast<double>(corners.size()));
    for_ranges(std::min(kBatch, corners.size() - from), kGrain, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<Flood> flood;
      {
        const std::lock_guard lock(mutex);
        if (!idle.empty()) {
          flood = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!flood) flood = std::make_unique<Flood>(surface, *facets);
      for (std::size_t k = from + begin; k < from + end; ++k) {
        const std::size_t i = order[k];
        averaged[i] = spacing > 0.0 ? flood->average_finely(corners[i], radius, kReferenceShare * radius)
                                    : flood->average(corners[i], radius);
      }
      const std::lock_guard lock(mutex);
      idle.push_back(std::move(flood));
    });
  }
  idle.clear();
  facets.reset();
  return samples.blended(averaged);
}

}  // namespace palpate::contact

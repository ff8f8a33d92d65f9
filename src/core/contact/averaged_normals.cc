#include "core/contact/averaged_normals.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <utility>

#include "core/base/index.h"
#include "core/base/parallel.h"
#include "core/contact/triangle_groups.h"

namespace palpate::contact {
namespace {

constexpr double kPi = 3.14159265358979323846;
// triangle visits; up to here the normals take a few tenths of a second without groups
constexpr double kQuick = 1e7;
constexpr double kGroupsInRadius = 4.0;  // group size = radius / kGroupsInRadius

/// Sums the face normals around one point by a flood over neighbouring groups. One object per thread.
class Flood final {
 public:
  Flood(const SurfaceView& surface, const TriangleGroups& groups, double radius)
      : surface_(surface), groups_(groups), radius_(radius), seen_by_(groups.size(), -1) {}

  /// The normal of a side. @param first_corner the side's first corner
  NormalAndSlope average(std::int32_t first_corner) {
    fan_.collect(surface_, first_corner);
    centre_ = corner(first_corner / 3, at(first_corner % 3));
    sum_ = {};
    queue_.clear();
    for (const std::int32_t face : fan_.triangles()) reach(groups_.group_of(face), first_corner);
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      if (!add(queue_[i])) continue;
      for (const std::int32_t next : groups_.neighbours(queue_[i])) reach(next, first_corner);
    }
    return NormalAndSlope::of(sum_.sum, sum_.slope, fan_.reference());
  }

 private:
  void reach(std::int32_t group, std::int32_t first_corner) {
    if (std::exchange(seen_by_[at(group)], first_corner) != first_corner) queue_.push_back(group);
  }

  [[nodiscard]] const Vec3& corner(std::int32_t face, std::size_t c) const {
    return surface_.mesh.vertices[at(surface_.mesh.triangles[at(face)][c])];
  }

  /// Adds a group's triangles. @return whether any of them is within the radius
  bool add(std::int32_t group) {
    if (!groups_.are_larger()) return add_triangle(group);
    const std::vector<GroupMoments>& nodes = groups_.nodes(group);
    bool any = false;
    for (std::size_t i = 0; i < nodes.size();) {
      const Coverage met = add_whole(nodes[i], any);
      any = any || met == Coverage::kInReach;
      if (met == Coverage::kPartly && nodes[i].after == i + 1) {  // a leaf
        for (const TriangleMoments& piece : groups_.pieces(nodes[i])) any = add_piece(piece, any) || any;
      }
      i = met == Coverage::kPartly ? i + 1 : nodes[i].after;
    }
    return any;
  }

  enum class Coverage { kOut, kInReach, kPartly };

  /// Adds all triangles of a node by their moments, if all of them are within the radius and count in full.
  /// @param any true when another triangle of the group is already known to be within the radius
  Coverage add_whole(const GroupMoments& moments, bool any) {
    const Vec3 u = centre_ - moments.centre;
    const double squared = u.squaredNorm();
    const double outer = radius_ + moments.reach;
    const double inner = radius_ - moments.reach;
    if (squared >= outer * outer) return Coverage::kOut;
    const bool in_reach = inner > 0.0 && squared < inner * inner;
    if (!in_reach && !any) return Coverage::kPartly;
    const double cosine = fan_.reference().dot(moments.axis);
    if (cosine + moments.spread <= kSharpCosine) return Coverage::kInReach;  // turned too far: weight 0
    if (!in_reach || cosine - moments.spread < kFullCosine) return Coverage::kPartly;
    moments.add_to(sum_, u, radius_);
    return Coverage::kInReach;
  }

  /// @param any as in add_whole
  /// @return whether a corner is within the radius
  bool add_piece(const TriangleMoments& piece, bool any) {
    const Vec3 u = centre_ - piece.centre;
    const double squared = u.squaredNorm();
    const double outer = radius_ + (any ? 1.0 : 2.0) * piece.middles;
    const double inner = radius_ - piece.middles;
    if (squared >= outer * outer) return false;
    const double turned = turn_of(piece.normal);
    if (any && turned <= 0.0) return true;
    const std::array<Vec3, 3>& m = piece.middle;
    // If all midpoints are within the radius, a corner is too, because a corner is at most twice as far from
    // `centre` as the midpoint of the opposite edge.
    if (squared >= inner * inner || 3.0 * piece.middles >= radius_) {
      return weigh({-2.0 * m[0] - u, -2.0 * m[1] - u, -2.0 * m[2] - u}, {m[0] - u, m[1] - u, m[2] - u},
                   turned, piece.area);
    }
    const double inverse = 1.0 / (radius_ * radius_);
    const Vec3 area = turned * piece.area;
    sum_.sum += (3.0 - inverse * (3.0 * squared + piece.squares)) * area;
    sum_.slope -= area * (6.0 * inverse * u).transpose();
    return true;
  }

  [[nodiscard]] double turn_of(const Vec3& normal) const {
    const double cosine = fan_.reference().dot(normal);
    return std::clamp((cosine - kSharpCosine) / (kFullCosine - kSharpCosine), 0.0, 1.0);
  }

  /// @return whether a corner is within the radius
  bool add_triangle(std::int32_t face) {
    const Vec3& a = corner(face, 0);
    const Vec3& b = corner(face, 1);
    const Vec3& c = corner(face, 2);
    return weigh({a - centre_, b - centre_, c - centre_},
                 {0.5 * (a + b) - centre_, 0.5 * (b + c) - centre_, 0.5 * (c + a) - centre_},
                 turn_of(surface_.face_normals[at(face)]),
                 geometry::area_vector_doubled(surface_.mesh, surface_.mesh.triangles[at(face)]));
  }

  /// Adds a triangle. @param corners, middles its corners and edge midpoints, relative to the centre
  bool weigh(const std::array<Vec3, 3>& corners, const std::array<Vec3, 3>& middles, double turned,
             const Vec3& area) {
    const double radius_squared = radius_ * radius_;
    if (std::min({corners[0].squaredNorm(), corners[1].squaredNorm(), corners[2].squaredNorm()}) >=
        radius_squared) {
      return false;
    }
    // The three-midpoint rule integrates a quadratic weight over a triangle exactly.
    double weight = 0.0;
    Vec3 rise = Vec3::Zero();  // gradient of the weight with respect to the centre
    for (const Vec3& middle : middles) {
      const double share = 1.0 - middle.squaredNorm() / radius_squared;
      if (share <= 0.0) continue;
      weight += share;
      rise += (2.0 / radius_squared) * middle;
    }
    sum_.sum += weight * turned * area;
    sum_.slope += turned * area * rise.transpose();
    return true;
  }

  const SurfaceView& surface_;
  const TriangleGroups& groups_;
  double radius_;
  SideFan fan_;
  Vec3 centre_ = Vec3::Zero();
  NormalSum sum_;
  std::vector<std::int32_t> seen_by_;  // per group: first corner of the side whose flood last visited it
  std::vector<std::int32_t> queue_;
};

/// Estimated number of triangle visits without groups.
double work_of(const SurfaceView& surface, const Sides& sides, double radius) {
  double area = 0.0;
  for (const geometry::Triangle& triangle : surface.mesh.triangles) {
    area += 0.5 * geometry::area_vector_doubled(surface.mesh, triangle).norm();
  }
  const double in_reach = kPi * radius * radius * static_cast<double>(surface.mesh.triangles.size());
  return area > 0.0 ? static_cast<double>(sides.first_corner.size()) * in_reach / area : 0.0;
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
    }
    fan.collect(surface, first);
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

double group_size_for(const SurfaceView& surface, const Sides& sides, double radius) {
  return work_of(surface, sides, radius) <= kQuick ? 0.0 : radius / kGroupsInRadius;
}

std::vector<NormalAndSlope> averaged_normals(const SurfaceView& surface, const Sides& sides, double radius,
                                             double group_size, const ProgressCallback& progress) {
  constexpr std::size_t kBatch = 256;  // groups between two progress reports
  constexpr std::size_t kGrain = 16;
  const TriangleGroups groups(surface, group_size);
  std::vector<NormalAndSlope> normals(sides.first_corner.size());
  std::mutex mutex;
  std::vector<std::unique_ptr<Flood>> idle;
  for (std::size_t from = 0; from < groups.size(); from += kBatch) {
    if (progress) progress(static_cast<double>(from) / static_cast<double>(groups.size()));
    for_ranges(std::min(kBatch, groups.size() - from), kGrain, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<Flood> flood;
      {
        const std::lock_guard lock(mutex);
        if (!idle.empty()) {
          flood = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!flood) flood = std::make_unique<Flood>(surface, groups, radius);
      for (std::size_t group = from + begin; group < from + end; ++group) {
        for (const std::int32_t face : groups.triangles(static_cast<std::int32_t>(group))) {
          for (std::int32_t corner = 3 * face; corner < 3 * face + 3; ++corner) {
            const std::int32_t side = sides.of_corner[at(corner)];
            if (sides.first_corner[at(side)] == corner) normals[at(side)] = flood->average(corner);
          }
        }
      }
      const std::lock_guard lock(mutex);
      idle.push_back(std::move(flood));
    });
  }
  return normals;
}

}  // namespace palpate::contact

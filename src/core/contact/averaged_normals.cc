#include "core/contact/averaged_normals.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kQuick = 1e7;  // triangles looked at in all: a few tenths of a second

/// What one thread needs for the rule by triangles.
struct Flood {
  SideFan fan;
  std::vector<std::int32_t> visited_by;
  std::vector<std::int32_t> queue;
};

NormalAndSlope normal_of_side(const SurfaceView& surface, std::int32_t side, std::int32_t first_corner,
                              double radius, Flood& flood) {
  const geometry::TriangleMesh& mesh = surface.mesh;
  flood.fan.collect(surface, first_corner);
  const Vec3& reference = flood.fan.reference();
  const Vec3 centre = mesh.vertices[at(mesh.triangles[at(first_corner / 3)][at(first_corner % 3)])];
  const double radius_squared = radius * radius;
  flood.visited_by.resize(mesh.triangles.size(), -1);
  std::vector<std::int32_t>& queue = flood.queue;
  queue.assign(flood.fan.triangles().begin(), flood.fan.triangles().end());
  for (const std::int32_t face : queue) flood.visited_by[at(face)] = side;
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::int32_t face = queue[i];
    const geometry::Triangle& triangle = mesh.triangles[at(face)];
    const Vec3& a = mesh.vertices[at(triangle[0])];
    const Vec3& b = mesh.vertices[at(triangle[1])];
    const Vec3& c = mesh.vertices[at(triangle[2])];
    // The middles of the edges integrate a quadratic weight exactly.
    double weight = 0.0;
    Vec3 rise = Vec3::Zero();  // of the weight with the centre's place
    for (const Vec3& middle : {Vec3(0.5 * (a + b)), Vec3(0.5 * (b + c)), Vec3(0.5 * (c + a))}) {
      const double share = 1.0 - (middle - centre).squaredNorm() / radius_squared;
      if (share <= 0.0) continue;
      weight += share;
      rise += (2.0 / radius_squared) * (middle - centre);
    }
    const double cosine = reference.dot(surface.face_normals[at(face)]);
    const double turned = std::clamp((cosine - kSharpCosine) / (kFullCosine - kSharpCosine), 0.0, 1.0);
    const Vec3 area = geometry::area_vector_doubled(mesh, triangle);
    sum += weight * turned * area;
    slope += turned * area * rise.transpose();
    for (const std::int32_t other : surface.neighbours[at(face)]) {
      if (other < 0 || flood.visited_by[at(other)] == side) continue;
      const geometry::Triangle& next = mesh.triangles[at(other)];
      const double reach = std::min({(mesh.vertices[at(next[0])] - centre).squaredNorm(),
                                     (mesh.vertices[at(next[1])] - centre).squaredNorm(),
                                     (mesh.vertices[at(next[2])] - centre).squaredNorm()});
      if (reach >= radius_squared) continue;
      flood.visited_by[at(other)] = side;
      queue.push_back(other);
    }
  }
  return NormalAndSlope::of(sum, slope, reference);
}

/// Triangles that the rule by triangles would look at.
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

std::vector<NormalAndSlope> normals_by_triangles(const SurfaceView& surface, const Sides& sides,
                                                 double radius, const Share& share) {
  constexpr std::size_t kBatch = 8192;  // sides between two words on how far it is
  constexpr std::size_t kGrain = 512;
  const std::size_t count = sides.first_corner.size();
  std::vector<NormalAndSlope> normals(count);
  std::mutex mutex;
  std::vector<std::unique_ptr<Flood>> idle;
  for (std::size_t from = 0; from < count; from += kBatch) {
    if (share) share(static_cast<double>(from) / static_cast<double>(count));
    for_ranges(std::min(kBatch, count - from), kGrain, [&](std::size_t begin, std::size_t end) {
      std::unique_ptr<Flood> flood;
      {
        const std::lock_guard lock(mutex);
        if (!idle.empty()) {
          flood = std::move(idle.back());
          idle.pop_back();
        }
      }
      if (!flood) flood = std::make_unique<Flood>();
      for (std::size_t side = from + begin; side < from + end; ++side) {
        if (sides.first_corner[side] < 0) continue;
        normals[side] = normal_of_side(surface, static_cast<std::int32_t>(side), sides.first_corner[side],
                                       radius, *flood);
      }
      const std::lock_guard lock(mutex);
      idle.push_back(std::move(flood));
    });
  }
  return normals;
}

std::vector<NormalAndSlope> averaged_normals(const SurfaceView& surface, const Sides& sides, double radius,
                                             const Share& share) {
  return work_of(surface, sides, radius) <= kQuick ? normals_by_triangles(surface, sides, radius, share)
                                                   : normals_by_clusters(surface, sides, radius, share);
}

}  // namespace palpate::contact

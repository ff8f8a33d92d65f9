#include "core/deform/geodesic_front.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/base/simd.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

// A distance that falls by less than this ratio has changed by rounding only and is not propagated.
constexpr float kWorthwhile = 1.0F - 1e-5F;

// Length of the straight path to c across edge ab, from the distances of a and b; infinity when the straight
// line misses the edge.
float path_across(const Vector3f& a, const Vector3f& b, const Vector3f& c, float distance_a,
                  float distance_b) {
  const Vector3f edge = b - a;
  const float squared = edge.squaredNorm();
  if (!(squared > 0.0F)) return kInfinityF;
  const float length = std::sqrt(squared);
  const float c_x = (c - a).dot(edge) / length;
  const float c_y = std::sqrt(std::max(0.0F, (c - a).squaredNorm() - c_x * c_x));
  const float s_x = (distance_a * distance_a - distance_b * distance_b + squared) / (2.0F * length);
  const float s_y_squared = distance_a * distance_a - s_x * s_x;
  if (s_y_squared < 0.0F) return kInfinityF;
  const float s_y = std::sqrt(s_y_squared);  // the source is below the edge, c above
  const float height = c_y + s_y;
  if (!(height > 0.0F)) return kInfinityF;
  const float crossing = s_x + (c_x - s_x) * s_y / height;
  if (crossing < -1e-5F * length || crossing > (1.0F + 1e-5F) * length) return kInfinityF;
  return std::sqrt((c_x - s_x) * (c_x - s_x) + height * height);
}

}  // namespace

FrontSurface::FrontSurface(const geometry::TriangleMesh& mesh) : start(mesh.vertices.size() + 1, 0) {
  vertices.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) vertices.emplace_back(v.cast<float>());
  for (const geometry::Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) ++start[at(v) + 1];
  for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
  around.resize(mesh.triangles.size() * 3);
  std::vector<std::int32_t> next(start.begin(), start.end() - 1);
  for (const geometry::Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) around[at(next[at(t[k])]++)] = {t[(k + 1) % 3], t[(k + 2) % 3]};
}

GeodesicFront::GeodesicFront(const FrontSurface& surface)
    : surface_(&surface),
      distance_(surface.vertices.size(), kInfinityF),
      excess_((surface.vertices.size() + kLanes - 1) / kLanes * kLanes, kInfinityF) {}

void GeodesicFront::begin(const geometry::Triangle& corners, const Vector3f& point) {
  for (const std::int32_t v : seen_) {
    distance_[at(v)] = kInfinityF;
    excess_[at(v)] = kInfinityF;
  }
  seen_.clear();
  settled_.clear();
  queue_.clear();
  source_ = point;
  for (const std::int32_t v : corners) offer(v, (surface_->vertices[at(v)] - point).norm());
}

void GeodesicFront::offer(std::int32_t vertex, float distance) {
  float& now = distance_[at(vertex)];
  if (!(distance < now * kWorthwhile)) return;
  if (now == kInfinityF) seen_.push_back(vertex);
  now = distance;
  queue_.emplace_back(distance, vertex);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

void GeodesicFront::relax(std::int32_t from, std::int32_t known, std::int32_t to) {
  const float here = distance_[at(from)];
  const Vector3f& a = surface_->vertices[at(from)];
  const Vector3f& c = surface_->vertices[at(to)];
  const float other = distance_[at(known)];
  float distance = here + (c - a).norm();
  if (other < kInfinityF)
    distance = std::min(distance, path_across(a, surface_->vertices[at(known)], c, here, other));
  offer(to, distance);
}

int GeodesicFront::advance(float limit, int most) {
  int steps = 0;
  while (!queue_.empty() && queue_.front().first < limit && steps < most) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [distance, v] = queue_.back();
    queue_.pop_back();
    if (distance > distance_[at(v)]) continue;  // outdated entry
    ++steps;
    settled_.push_back(v);
    excess_[at(v)] = distance - (surface_->vertices[at(v)] - source_).norm();
    for (std::int32_t i = surface_->start[at(v)]; i < surface_->start[at(v) + 1]; ++i) {
      const FrontSurface::Corner& corner = surface_->around[at(i)];
      relax(v, corner.q, corner.p);
      relax(v, corner.p, corner.q);
    }
  }
  return steps;
}

float GeodesicFront::radius() const noexcept { return queue_.empty() ? kInfinityF : queue_.front().first; }

}  // namespace palpate::deform

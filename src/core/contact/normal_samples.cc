#include "core/contact/normal_samples.h"

#include <algorithm>
#include <utility>

#include "core/base/index.h"
#include "core/base/parallel.h"

namespace palpate::contact {
namespace {

// Cosine of the largest angle (18 degrees) between the mean normals at a sample and at a side that it covers:
// where the surface bends more strongly, samples are closer, and none reaches over a sharp edge.
constexpr double kAlike = 0.95;

constexpr double kReach = 1.5;  // of a sample, in spacings

/// What the samples around a side give it, beside the sums of weight (n_i + S_i (x - x_i)/2) and of weight
/// S_i [1/m]; see the head of normal_samples.h.
struct Blend {
  double weight = 0.0;
  Vec3 offset = Vec3::Zero();  // sum of weight (x - x_i) [m]

  void add(double w, const Vec3& from_sample, const NormalAndSlope& sample, NormalAndSlope& sums) {
    weight += w;
    offset += w * from_sample;
    sums.normal += w * (sample.normal + 0.5 * (sample.slope * from_sample));
    sums.slope += w * sample.slope;
  }

  [[nodiscard]] NormalAndSlope value(const NormalAndSlope& sums) const {
    const Eigen::Matrix3d mean = sums.slope / weight;
    const Vec3 sum = (sums.normal + 0.5 * (mean * offset)) / weight;
    return NormalAndSlope::of(sum, mean, sum);
  }
};

}  // namespace

NormalSamples::NormalSamples(const SurfaceView& surface, const Sides& sides, double spacing)
    : surface_(surface), sides_(sides), spacing_(spacing) {
  if (!(spacing > 0.0)) {
    std::copy_if(sides.first_corner.begin(), sides.first_corner.end(), std::back_inserter(first_corners_),
                 [](std::int32_t corner) { return corner >= 0; });
    return;
  }
  triangle_seen_.assign(surface.mesh.triangles.size(), -1);
  side_seen_.assign(sides.first_corner.size(), -1);
  std::vector<bool> covered(sides.first_corner.size(), false);
  for (std::size_t side = 0; side < covered.size(); ++side) {
    const std::int32_t corner = sides.first_corner[side];
    if (corner < 0 || covered[side]) continue;
    first_corners_.push_back(corner);
    each_around(corner, spacing, [&](std::int32_t near, const Vec3&) { covered[at(near)] = true; });
    covered[side] = true;
  }
  std::fill(triangle_seen_.begin(), triangle_seen_.end(), -1);
  std::fill(side_seen_.begin(), side_seen_.end(), -1);
}

template <typename Visit>
void NormalSamples::each_around(std::int32_t first_corner, double reach, Visit visit) {
  const geometry::TriangleMesh& mesh = surface_.mesh;
  const Vec3& normal = sides_.mean_normal[at(sides_.of_corner[at(first_corner)])];
  const Vec3& centre = mesh.vertices[at(mesh.triangles[at(first_corner / 3)][at(first_corner % 3)])];
  queue_.assign(1, first_corner / 3);
  triangle_seen_[at(first_corner / 3)] = first_corner;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::int32_t face = queue_[i];
    bool any = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 offset = mesh.vertices[at(mesh.triangles[at(face)][c])] - centre;
      if (offset.squaredNorm() >= reach * reach) continue;
      any = true;
      const std::int32_t side = sides_.of_corner[3 * at(face) + c];
      if (sides_.mean_normal[at(side)].dot(normal) < kAlike) continue;
      if (std::exchange(side_seen_[at(side)], first_corner) != first_corner) visit(side, offset);
    }
    if (!any) continue;
    for (const std::int32_t next : surface_.neighbours[at(face)]) {
      if (next < 0 || triangle_seen_[at(next)] == first_corner) continue;
      if (surface_.face_normals[at(face)].dot(surface_.face_normals[at(next)]) < kSharpCosine) continue;
      triangle_seen_[at(next)] = first_corner;
      queue_.push_back(next);
    }
  }
}

std::vector<NormalAndSlope> NormalSamples::blended(const std::vector<NormalAndSlope>& averaged) {
  std::vector<NormalAndSlope> normals(sides_.first_corner.size());
  if (spacing_ > 0.0) {
    std::vector<Blend> blends(normals.size());
    const double reach = kReach * spacing_;
    for (std::size_t i = 0; i < averaged.size(); ++i) {
      each_around(first_corners_[i], reach, [&](std::int32_t side, const Vec3& offset) {
        const double r = offset.norm();
        if (!(r > 0.0)) return;
        const double share = (reach - r) / (reach * r);
        blends[at(side)].add(share * share, offset, averaged[i], normals[at(side)]);
      });
    }
    for_ranges(normals.size(), 16384, [&](std::size_t begin, std::size_t end) {
      for (std::size_t side = begin; side < end; ++side) {
        if (blends[side].weight > 0.0) normals[side] = blends[side].value(normals[side]);
      }
    });
  }
  for (std::size_t i = 0; i < averaged.size(); ++i) {
    normals[at(sides_.of_corner[at(first_corners_[i])])] = averaged[i];
  }
  return normals;
}

}  // namespace palpate::contact

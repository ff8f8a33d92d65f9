#pragma once
// Averaged normals of a fine mesh, from samples on its surface. Used in set-up only.
//
// An averaged normal changes over its own radius, however small the triangles are. So on a fine mesh it is
// averaged only at some of the sides, the samples, and blended for the others:
//
// 1. Sides are taken in order. One that no sample covers yet becomes a sample. It covers the sides within the
// spacing s
//    (a quarter of the radius) that are connected with it and whose mean normal is turned by at most 18
//    degrees. So samples are closer where the surface bends strongly, each sharp edge keeps samples of its
//    own on both sides, and a coarse part of the mesh has a sample at every side.
// 2. The normals n_i and slopes S_i of the samples are averaged, in parallel.
// 3. Each other side, at x, blends the samples within 1.5 s, r away, with Franke and Little's weights
//    w_i = ((1.5 s - r)/(1.5 s r))^2, which are infinite at the sample, so that the blend has its value and
//    slope there:
//      S = sum w_i S_i / sum w_i,  n = sum w_i (n_i + (S_i + S)/2 (x - x_i)) / sum w_i, then to length one.
//    The mean of both slopes makes the blend exact where the slope is linear.
//
// The work is the number of samples, about area / s^2, times the facets (facets.h) in reach of one: neither
// grows with the number of triangles. What does is linear in it. Steps 1 and 3 run in order on one processor,
// so that the bits do not depend on the number of processors. How far blended normals are from averaged ones:
// docs/decisions/0033-sampled-normals.md.
#include <cstdint>
#include <vector>

#include "core/contact/averaged_normals.h"

namespace palpate::contact {

/// The samples of a surface, and what they give the sides around them.
class NormalSamples final {
 public:
  /// [setup] Chooses the samples. @param spacing [m]; 0: every side is one
  NormalSamples(const SurfaceView& surface, const Sides& sides, double spacing);

  /// The first corners of the samples' sides, in the order of the sides.
  [[nodiscard]] const std::vector<std::int32_t>& first_corners() const noexcept { return first_corners_; }

  /// [setup] Normals of all sides. @param averaged those of the samples
  [[nodiscard]] std::vector<NormalAndSlope> blended(const std::vector<NormalAndSlope>& averaged);

 private:
  /// Calls visit(side, offset) once for each side within `reach` [m] of the sample.
  template <typename Visit>
  void each_around(std::int32_t first_corner, double reach, Visit visit);

  const SurfaceView& surface_;
  const Sides& sides_;
  double spacing_;
  std::vector<std::int32_t> first_corners_;
  std::vector<std::int32_t> queue_;
  std::vector<std::int32_t> triangle_seen_;  // per triangle: first corner of the last sample that reached it
  std::vector<std::int32_t> side_seen_;      // per side: the same
};

}  // namespace palpate::contact

#include "core/contact/organ_arrays.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/index.h"
#include "core/base/parallel.h"
#include "core/contact/averaged_normals.h"

namespace palpate::contact {
namespace {

// Raise this whenever the arrays of any mesh change, so that older cache files are not used. A test compares
// hashes of the arrays.
constexpr std::uint64_t kArraysVersion = 5;

// Approximate limit of triangles after refinement. It refines organs above 0.15 m^2 (with the default R_ref;
// a large liver has 0.1 m^2) less finely. The normals' error is then up to 0.2 degrees at 450 mm and 1.3
// degrees at 1 m (docs/decisions/0006).
constexpr double kMaxTriangles = 150e3;

double total_area(const geometry::TriangleMesh& mesh) {
  double doubled = 0.0;
  for (const geometry::Triangle& triangle : mesh.triangles) {
    doubled += geometry::area_vector_doubled(mesh, triangle).norm();
  }
  return 0.5 * doubled;
}

/// Stores side numbers only for triangles with a corner that is not on its vertex's first side.
void store_sides(const std::vector<geometry::Triangle>& triangles, const Sides& sides, OrganArrays& arrays) {
  arrays.row_of.assign(triangles.size(), -1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array<std::int32_t, 3> row{sides.of_corner[3 * t], sides.of_corner[3 * t + 1],
                                          sides.of_corner[3 * t + 2]};
    if (row == triangles[t]) continue;
    arrays.row_of[t] = static_cast<std::int32_t>(arrays.side_rows.size());
    arrays.side_rows.push_back(row);
  }
}

/// Stores normals and bends. Beside the linear interpolation between the ends, a quadratic function has half
/// the difference of its slopes along an edge times the edge. Both triangles of an edge get the same bits.
void store_normals(const geometry::TriangleMesh& mesh, const std::vector<NormalAndSlope>& averaged,
                   const Sides& sides, OrganArrays& arrays) {
  arrays.normals.resize(averaged.size());
  for (std::size_t i = 0; i < averaged.size(); ++i) arrays.normals[i] = averaged[i].normal;
  const std::vector<geometry::Triangle>& triangles = mesh.triangles;
  arrays.bends.resize(triangles.size());
  for_ranges(triangles.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t f = (e + 1) % 3;
        const Vec3 edge = mesh.vertices[at(triangles[t][f])] - mesh.vertices[at(triangles[t][e])];
        Vec3 bend = 0.5 * ((averaged[at(sides.of_corner[3 * t + e])].slope -
                            averaged[at(sides.of_corner[3 * t + f])].slope) *
                           edge);
        const double size = bend.norm();
        if (size > kMaxBend) bend *= kMaxBend / size;
        for (std::size_t i = 0; i < 3; ++i) {
          const double units = bend[static_cast<Eigen::Index>(i)] / kBendUnit;
          arrays.bends[t][e][i] = static_cast<std::int16_t>(std::lround(units));
        }
      }
    }
  });
}

}  // namespace

ContentHash organ_key(const geometry::TriangleMesh& organ, double reference_radius) {
  return ContentHasher()
      .add(kArraysVersion)
      .add(reference_radius)
      .add(std::span<const Vec3>(organ.vertices))
      .add(std::span<const geometry::Triangle>(organ.triangles))
      .hash();
}

std::vector<Vec3> face_normals_of(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.triangles.size());
  for_ranges(normals.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      normals[t] = geometry::area_vector_doubled(mesh, mesh.triangles[t]).normalized();
    }
  });
  return normals;
}

geometry::TriangleMesh refined(const geometry::TriangleMesh& organ, double reference_radius) {
  // Longest-edge splitting gives triangles of about longest^2 / 4.
  const double affordable = std::sqrt(4.0 * total_area(organ) / kMaxTriangles);
  return geometry::refine(organ, std::max(reference_radius / 5.0, affordable));
}

OrganArrays organ_arrays(const geometry::TriangleMesh& mesh,
                         const std::vector<std::array<std::int32_t, 3>>& neighbours, double reference_radius,
                         const std::function<void(double, const std::string&)>& share) {
  constexpr double kNormalsFrom = 0.08;  // fraction of the whole time, for a fine mesh
  constexpr double kNormalsTo = 0.95;
  OrganArrays arrays;
  share(0.0, "neighbours");
  const std::vector<Vec3> face_normals = face_normals_of(mesh);
  const SurfaceView view{mesh, neighbours, face_normals};
  {
    const Sides sides = find_sides(view);
    const double radius = reference_radius / 2.0;
    const std::vector<NormalAndSlope> averaged = averaged_normals(
        view, sides, radius, sample_spacing_for(view, sides, radius),
        [&](double done) { share(kNormalsFrom + (kNormalsTo - kNormalsFrom) * done, "normals"); });
    store_normals(mesh, averaged, sides, arrays);
    store_sides(mesh.triangles, sides, arrays);
  }
  share(kNormalsTo, "edges");
  list_sharp_edges(view, arrays);
  return arrays;
}

}  // namespace palpate::contact

#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/offscreen.h"
#include "palpate/support.h"
#include "palpate/surface.h"

namespace palpate::report {

/// How far the shown surface is from a reference under the same press, where the reference moves by more than
/// 2 % of the depth.
struct SurfaceError {
  std::vector<double> at;  // per vertex: length of the vector difference [m]
  double rms = 0.0;        // over the area that moves [m]
  double largest = 0.0;    // [m]
  Vec3 where = Vec3::Zero();
  double compared = 0.0;  // share of the surface that moves
};

/// [setup] Displacements of an organ's vertices [m] from a CSV file with the columns x_mm, y_mm, z_mm,
/// u_x_mm, u_y_mm and u_z_mm, a row a vertex in any order. @throws InputError where a vertex has no row
/// within 0.01 mm
[[nodiscard]] std::vector<Vec3> read_reference(const std::filesystem::path& file,
                                               const geometry::TriangleMesh& organ);

/// [setup] @param reference as of read_reference() @param support empty: the displacement profile
/// @throws InputError when the reference moves nowhere by 2 % of the depth
[[nodiscard]] SurfaceError surface_error(const geometry::TriangleMesh& organ,
                                         const std::vector<Vec3>& reference, const deform::Indentation& press,
                                         const std::optional<geometry::Support>& support);

/// [setup] The organ at rest from above and from below, coloured by the error up to `range` [m], with a
/// legend. @param height of the picture, in pixels @throws as OffscreenRenderer
[[nodiscard]] render::Image draw_error(const geometry::TriangleMesh& organ, const SurfaceError& error,
                                       double range, int height);

}  // namespace palpate::report

// Preparation of an organ's surface: computed on all processors, or loaded from the cache.
#include <optional>
#include <string>
#include <utility>

#include "core/base/parallel.h"
#include "core/contact/organ_surface.h"

namespace palpate::contact {
namespace {

/// Fraction of the whole time at which each stage begins, for a fine mesh.
constexpr double kDistanceFrom = 0.02;
constexpr double kArraysFrom = 0.25;
constexpr double kStoreFrom = 0.98;

/// Frees the mesh and the neighbours, of which the distance has its own.
void drop_mesh(OrganArrays& arrays) {
  arrays.mesh = {};
  arrays.neighbours = {};
}

}  // namespace

OrganSurface::Prepared OrganSurface::prepare(const geometry::TriangleMesh& organ, double reference_radius,
                                             const Preparation& how, const DistanceOf& distance_of) {
  const auto report_progress = [&](double share, const std::string& what) {
    if (how.progress) how.progress(share, what);
  };
  const WorkerThreads workers;
  report_progress(0.0, "cache");
  std::optional<OrganArrays> loaded = how.store ? how.store->load(organ, reference_radius) : std::nullopt;
  if (loaded) {
    report_progress(kDistanceFrom, "distances");
    geometry::SignedDistance distance = distance_of(loaded->mesh);
    drop_mesh(*loaded);
    report_progress(1.0, "done");
    return {std::move(*loaded), std::move(distance)};
  }
  report_progress(0.0, "refinement");
  const auto distance_of_refined = [&] {
    const geometry::TriangleMesh mesh = refined(organ, reference_radius);
    report_progress(kDistanceFrom, "distances");
    return distance_of(mesh);  // throws if the mesh is not closed
  };
  geometry::SignedDistance distance = distance_of_refined();
  OrganArrays arrays = organ_arrays(distance.mesh(), distance.neighbours(), reference_radius,
                                    [&](double share, const std::string& what) {
                                      report_progress(kArraysFrom + (kStoreFrom - kArraysFrom) * share, what);
                                    });
  report_progress(kStoreFrom, "cache");
  if (how.store) {
    arrays.mesh = distance.mesh();
    arrays.neighbours = distance.neighbours();
    how.store->store(organ, reference_radius, arrays);
    drop_mesh(arrays);
  }
  report_progress(1.0, "done");
  return {std::move(arrays), std::move(distance)};
}

}  // namespace palpate::contact

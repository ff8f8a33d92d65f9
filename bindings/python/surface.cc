#include "bindings/python/surface.h"

#include "palpate/error.h"

namespace palpate::python {

void check_surface_edge(double longest_edge) {
  if (longest_edge == 0.0 || (longest_edge >= 1e-4 && longest_edge <= 1.0)) return;
  throw ParameterError("surface_edge", longest_edge, "0, or 1e-4 to 1 (m)");
}

geometry::TriangleMesh visible_surface(const scene::Scene& scene, double longest_edge) {
  check_surface_edge(longest_edge);
  if (longest_edge == 0.0) return scene.organ;
  return geometry::refine(scene.organ, longest_edge);
}

Surface surface_at(const haptics::Snapshot& snapshot, deform::SurfaceDeformer& deformer) {
  Surface surface;
  surface.tick = snapshot.tick;
  surface.organ_W = snapshot.organ_W;
  surface.mesh.triangles = deformer.rest().triangles;
  deformer.deform(snapshot.reach, deform::indentations_of(snapshot.hand_results()), surface.mesh.vertices);
  return surface;
}

}  // namespace palpate::python

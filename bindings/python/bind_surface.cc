// The visible surface and its deformation.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/support_reader.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/surface.h"

#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

using deform::Indentation;

Vec3 vector_of(const Numbers& numbers, const char* name) {
  if (numbers.ndim() != 1 || numbers.size() != 3)
    throw InputError(std::string(name) + ": must be three numbers");
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

Indentation make_indentation(const Numbers& point, const Numbers& direction, double depth, double tip_radius,
                             double half_width) {
  Indentation made;
  made.point = vector_of(point, "point");
  made.direction = vector_of(direction, "direction");
  const double length = made.direction.norm();
  if (!made.point.allFinite()) throw InputError("point: must be finite numbers (m)");
  if (!(length > 0.0) || !std::isfinite(length)) throw InputError("direction: must be finite and not all 0");
  made.direction /= length;
  if (!(depth >= 0.0) || !std::isfinite(depth)) throw ParameterError("depth", depth, ">= 0 (m)");
  if (!(tip_radius > 0.0) || !std::isfinite(tip_radius)) {
    throw ParameterError("tip_radius", tip_radius, "> 0 (m)");
  }
  if (!(half_width >= 0.0)) throw ParameterError("half_width", half_width, ">= 0 (m)");
  made.depth = depth;
  made.tip_radius = tip_radius;
  made.half_width = half_width;
  return made;
}

/// An indentation in another unit or frame lies off the mesh, or is deeper than it is large.
void check_places(const geometry::TriangleMesh& mesh, const std::vector<Indentation>& indentations) {
  constexpr double kOff = 0.1;  // of the mesh's diagonal
  if (mesh.vertices.empty()) return;
  const geometry::Bounds box = geometry::bounds(mesh);
  const double diagonal = box.size().norm();
  for (std::size_t i = 0; i < indentations.size(); ++i) {
    const Indentation& one = indentations[i];
    const double off = (one.point - one.point.cwiseMax(box.low).cwiseMin(box.high)).norm();
    if (off > kOff * diagonal) {
      throw InputError(
          fmt::format("indentations[{}]: its point is {} m off the mesh, must be on its surface: is "
                      "it in metres, in the mesh's frame?",
                      i, brief(off)));
    }
    if (one.depth > diagonal) {
      throw InputError(
          fmt::format("indentations[{}]: depth = {} m, must be at most the mesh's diagonal, {} m: is "
                      "it in metres?",
                      i, brief(one.depth), brief(diagonal)));
    }
  }
}

geometry::TriangleMesh deformed_surface(const geometry::TriangleMesh& mesh,
                                        const std::vector<Indentation>& indentations,
                                        const TissueArgument& tissue,
                                        const std::vector<std::string>& organ_support) {
  const model::TissueParameters parameters = tissue_of(tissue);
  std::shared_ptr<const deform::OrganResponse> response;
  if (auto stated = scene::support_by_flags(organ_support)) {
    scene::read_painted(*stated, LengthUnit::kMillimetre);
    scene::check_support(*stated, mesh);
    response = deform::prepare_response(mesh, stated->support);
  }
  check_places(mesh, indentations);
  deform::SurfaceDeformer deformer(mesh, response);
  geometry::TriangleMesh moved;
  moved.triangles = mesh.triangles;
  deformer.deform(parameters.reach, indentations, moved.vertices);
  return moved;
}

}  // namespace

Surface surface_of(const record::Recording& recording, std::uint64_t tick, double surface_edge, bool cache) {
  const contact::Preparation how = preparation_of(cache);
  deform::SurfaceDeformer deformer(
      visible_surface(recording.scene, surface_edge),
      deform::prepare_response(recording.scene.organ, recording.scene.support, how.store.get()));
  return surface_at(record::snapshots_at(recording, {tick}, how).front(), deformer);
}

void bind_surface(py::module_& module) {
  const py::call_guard<py::gil_scoped_release> others_may_run;
  py::class_<Surface>(module, "Surface", doc("Surface"))
      .def_readonly("tick", &Surface::tick, "Number of the tick.")
      .def_property_readonly(
          "mesh", [](const Surface& surface) { return surface.mesh; }, doc("Surface::mesh"))
      .def_property_readonly(
          "vertices", [](const Surface& surface) { return vertices_of(surface.mesh); },
          "n x 3 coordinates in metres, in the organ frame; a copy.")
      .def_property_readonly(
          "triangles", [](const Surface& surface) { return triangles_of(surface.mesh); },
          "n x 3 vertex indices, the same at every tick; a copy.")
      .def_property_readonly(
          "organ_position", [](const Surface& surface) { return array_of(surface.organ_W.position); },
          "Position of the organ in metres, in the world frame.")
      .def_property_readonly(
          "organ_orientation", [](const Surface& surface) { return array_of(surface.organ_W.rotation); },
          "Orientation of the organ, w x y z, in the world frame.");
  py::class_<Indentation>(module, "Indentation", doc("Indentation"))
      .def(py::init(&make_indentation), py::arg("point"), py::arg("direction"), py::arg("depth"),
           py::arg("tip_radius"), py::arg("half_width") = 0.0)
      .def_property_readonly(
          "point", [](const Indentation& one) { return array_of(one.point); }, doc("Indentation::point"))
      .def_property_readonly(
          "direction", [](const Indentation& one) { return array_of(one.direction); },
          doc("Indentation::direction"))
      .def_readonly("depth", &Indentation::depth, doc("Indentation::depth"))
      .def_readonly("tip_radius", &Indentation::tip_radius, doc("Indentation::tip_radius"))
      .def_readonly("half_width", &Indentation::half_width, doc("Indentation::half_width"));
  module.def(
      "deformed_surface", &deformed_surface, py::arg("mesh"), py::arg("indentations"), py::arg("tissue"),
      py::arg("organ_support") = std::vector<std::string>{}, others_may_run,
      "The mesh deformed by all indentations together: the displacement profile u(r) of docs/model.md with "
      "the falloff ratios of the tissue (a Tissue, a built-in name or a tissue file), r along the surface. "
      "Vertices beyond the profile do not change. With `organ_support` (as the flag --organ-support, a "
      "list), all of a closed mesh gives way. Raises InputError.");
}

}  // namespace palpate::python

// Meshes, built-in organs and instruments.
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/read_mesh.h"
#include "palpate/units.h"

#include "bindings/python/binding.h"
#include "bindings/python/docs.h"

namespace palpate::python {

namespace {

using geometry::MeshFindings;
using geometry::TriangleMesh;

// Without forcecast: fractions are a TypeError, not cut off.
using Indices = Unmasked<std::int64_t, py::array::c_style>;

TriangleMesh mesh_of(const Numbers& vertices, const Indices& triangles) {
  if (vertices.ndim() != 2 || vertices.shape(1) != 3)
    throw InputError("vertices: must be an array of n x 3 numbers (m)");
  if (triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw InputError("triangles: must be an array of n x 3 indices");
  TriangleMesh mesh;
  const auto points = vertices.unchecked<2>();
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    mesh.vertices.emplace_back(points(i, 0), points(i, 1), points(i, 2));
    if (!mesh.vertices.back().allFinite()) {
      throw InputError("vertices[" + std::to_string(i) + "]: must be three finite numbers (m)");
    }
  }
  const auto corners = triangles.unchecked<2>();
  for (py::ssize_t i = 0; i < corners.shape(0); ++i) {
    geometry::Triangle triangle{};
    for (py::ssize_t c = 0; c < 3; ++c) {
      if (corners(i, c) < 0 || corners(i, c) >= points.shape(0)) {
        throw InputError("triangles[" + std::to_string(i) + "] = " + std::to_string(corners(i, c)) +
                         ": must be an index of the " + std::to_string(points.shape(0)) + " vertices");
      }
      triangle[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(corners(i, c));
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// Serializes read_mesh(), because the importer is not reentrant.
mesh_io::LoadedMesh read_alone(const std::filesystem::path& file, const std::optional<std::string>& unit) {
  static std::mutex one_at_a_time;
  std::optional<LengthUnit> length;
  if (unit) length = parse_length_unit(*unit);
  const py::gil_scoped_release others_may_run;
  const std::lock_guard lock(one_at_a_time);
  return mesh_io::read_mesh(file, length);
}

void bind_findings(py::module_& module) {
  py::class_<MeshFindings>(module, "MeshFindings", doc("MeshFindings"))
      .def_readonly("closed", &MeshFindings::closed)
      .def_readonly("manifold", &MeshFindings::manifold)
      .def_readonly("shells", &MeshFindings::shells)
      .def_readonly("volume", &MeshFindings::volume, doc("MeshFindings::volume"))
      .def_readonly("repairs", &MeshFindings::repairs, doc("MeshFindings::repairs"))
      .def_readonly("defects", &MeshFindings::defects, doc("MeshFindings::defects"))
      .def_readonly("remarks", &MeshFindings::remarks, doc("MeshFindings::remarks"));
}

}  // namespace

void bind_geometry(py::module_& module) {
  const py::call_guard<py::gil_scoped_release> others_may_run;
  bind_findings(module);
  py::class_<TriangleMesh>(module, "Mesh", doc("TriangleMesh"))
      .def(py::init(&mesh_of), py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly("vertices", &vertices_of, "n x 3 coordinates in metres; a copy.")
      .def_property_readonly("triangles", &triangles_of,
                             "n x 3 vertex indices, counter-clockwise seen from outside; a copy.")
      .def(
          "findings", [](const TriangleMesh& mesh) { return mesh_io::findings_of(mesh); }, others_may_run,
          doc("findings_of"));
  module.def(
      "read_mesh",
      [](const std::filesystem::path& file, const std::optional<std::string>& unit) {
        mesh_io::LoadedMesh loaded = read_alone(file, unit);
        return std::pair(std::move(loaded.mesh), std::move(loaded.findings));
      },
      py::arg("file"), py::arg("unit"),
      (std::string(doc("read_mesh")) + " In Python, calls from several threads wait for each other.")
          .c_str());
  module.def("make_organ", &geometry::make_organ, py::arg("name"), others_may_run, doc("make_organ"));
  module.def("make_ball", &geometry::make_ball, py::arg("radius"), py::arg("triangles") = 1280,
             others_may_run, doc("make_ball"));
  module.def(
      "make_tool",
      [](const std::string& name) {
        const geometry::Tool tool = geometry::make_tool(name);
        std::vector<std::pair<std::string, TriangleMesh>> parts;
        for (const geometry::ToolPart& part : tool.parts) parts.emplace_back(part.name, part.mesh);
        return parts;
      },
      py::arg("name"), others_may_run, doc("make_tool"));
  module.def("organ_names", &geometry::builtin_organ_names, doc("builtin_organ_names"));
  module.def("tool_names", &geometry::builtin_tool_names, doc("builtin_tool_names"));
}

}  // namespace palpate::python

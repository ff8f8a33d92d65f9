#include "io/mesh_io/formats/surface_builder.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/repair/repair_holes.h"
#include "io/mesh_io/repair/repair_surface.h"

namespace palpate::mesh_io {
namespace {

constexpr std::size_t kMaxVertices = 32'000'000;  // 0.8 GB
constexpr std::size_t kMaxFaces = 20'000'000;     // of solid cells, 0.8 GB
constexpr std::size_t kMaxCorners = 512;          // of a polygon
constexpr std::uint64_t kMaxSteps = 120'000'000;  // to triangulate all polygons, about 4 s

// Numbers and node orders: VTK User's Guide, "VTK File Formats"; Gmsh reference manual, "Node ordering". Both
// list the corners first, and orient faces outwards alike except for the wedge.
constexpr std::array<CellKind, 25> kKinds{{{1, 15, 1, Shape::kLine, "a point"},
                                           {2, 0, 0, Shape::kLine, "points"},
                                           {3, 1, 2, Shape::kLine, "a line"},
                                           {4, 0, 0, Shape::kLine, "a line"},
                                           {21, 8, 3, Shape::kLine, "a curve"},
                                           {5, 2, 3, Shape::kTriangle, "a triangle"},
                                           {22, 9, 6, Shape::kTriangle, "a quadratic triangle"},
                                           {6, 0, 0, Shape::kStrip, "a triangle strip"},
                                           {7, 0, 0, Shape::kPolygon, "a polygon"},
                                           {8, 0, 4, Shape::kPixel, "a pixel"},
                                           {9, 3, 4, Shape::kQuadrilateral, "a quadrilateral"},
                                           {23, 16, 8, Shape::kQuadrilateral, "a quadratic quadrilateral"},
                                           {28, 10, 9, Shape::kQuadrilateral, "a quadratic quadrilateral"},
                                           {10, 4, 4, Shape::kTetrahedron, "a tetrahedron"},
                                           {24, 11, 10, Shape::kTetrahedron, "a quadratic tetrahedron"},
                                           {11, 0, 8, Shape::kVoxel, "a voxel"},
                                           {12, 5, 8, Shape::kHexahedron, "a hexahedron"},
                                           {25, 17, 20, Shape::kHexahedron, "a quadratic hexahedron"},
                                           {29, 12, 27, Shape::kHexahedron, "a quadratic hexahedron"},
                                           {13, 6, 6, Shape::kWedge, "a wedge"},
                                           {26, 18, 15, Shape::kWedge, "a quadratic wedge"},
                                           {32, 13, 18, Shape::kWedge, "a quadratic wedge"},
                                           {14, 7, 5, Shape::kPyramid, "a pyramid"},
                                           {27, 19, 13, Shape::kPyramid, "a quadratic pyramid"},
                                           {0, 14, 14, Shape::kPyramid, "a quadratic pyramid"}}};

using Face = std::array<int, 4>;  // corners counter-clockwise seen from outside; a triangle's last is -1

constexpr std::array<Face, 4> kTetrahedron{{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}};
constexpr std::array<Face, 6> kHexahedron{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<Face, 5> kWedge{
    {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
constexpr std::array<Face, 5> kPyramid{
    {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};

std::span<const Face> faces_of(Shape shape) {
  if (shape == Shape::kTetrahedron) return kTetrahedron;
  if (shape == Shape::kHexahedron) return kHexahedron;
  return shape == Shape::kWedge ? kWedge : kPyramid;
}

std::size_t corners_of(Shape shape, std::size_t nodes) {
  constexpr std::array<std::size_t, 11> kCorners{0, 0, 0, 3, 4, 4, 4, 8, 8, 6, 5};  // as in Shape; 0: all
  const std::size_t corners = kCorners[static_cast<std::size_t>(shape)];
  return corners == 0 ? nodes : corners;
}

const CellKind* kind_of(std::int64_t number, int CellKind::*numbered) {
  const auto* const kind = std::find_if(kKinds.begin(), kKinds.end(),
                                        [&](const CellKind& one) { return one.*numbered == number; });
  return number <= 0 || kind == kKinds.end() ? nullptr : kind;
}

}  // namespace

const CellKind* vtk_kind(std::int64_t number) { return kind_of(number, &CellKind::vtk); }
const CellKind* gmsh_kind(std::int64_t number) { return kind_of(number, &CellKind::gmsh); }

void SurfaceBuilder::expect_vertices(std::size_t count) {
  if (count > kMaxVertices) scan_.refuse(fmt::format("more than {} vertices", kMaxVertices));
  vertices.reserve(count);
}

void SurfaceBuilder::add_vertex(const Vec3& vertex) {
  if (vertices.size() == kMaxVertices) scan_.refuse(fmt::format("more than {} vertices", kMaxVertices));
  vertices.push_back(vertex);
}

void SurfaceBuilder::add_polygon(std::span<const std::int32_t> corners) {
  const std::size_t count = corners.size();
  if (count < 3) {
    ++lines_;
    return;
  }
  if (count > kMaxCorners) {
    scan_.refuse_item(
        fmt::format("a polygon of {} corners: at most {} are cut into triangles", count, kMaxCorners));
  }
  if (count > 3) {
    ++cut_;
    steps_ += static_cast<std::uint64_t>(count) * count * count / 6;
  }
  if (steps_ > kMaxSteps) {
    scan_.refuse_item(fmt::format(
        "too many polygons as large as this one of {} corners: cut them into triangles first", count));
  }
  triangles_ += count - 2;
  if (triangles_ > kMaxTriangles) scan_.refuse_item(fmt::format("more than {} triangles", kMaxTriangles));
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  starts_.push_back(corners_.size());
}

void SurfaceBuilder::add_cell(const CellKind& kind, std::span<const std::int32_t> nodes) {
  std::vector<std::int32_t> corners(
      nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(corners_of(kind.shape, nodes.size())));
  if (kind.shape == Shape::kPixel || kind.shape == Shape::kVoxel) std::swap(corners[2], corners[3]);
  if (kind.shape == Shape::kVoxel) std::swap(corners[6], corners[7]);
  if (corners.size() < nodes.size() && kind.shape != Shape::kLine) ++curved_;
  if (kind.shape == Shape::kLine) {
    ++lines_;
  } else if (kind.shape >= Shape::kTetrahedron) {
    add_solid(kind.shape == Shape::kVoxel ? Shape::kHexahedron : kind.shape, corners);
  } else if (kind.shape != Shape::kStrip || corners.size() < 3) {
    add_polygon(corners);
  } else {
    ++strips_;
    for (std::size_t k = 0; k + 2 < corners.size(); ++k) {  // every second triangle is reversed
      const std::size_t odd = k % 2;
      add_polygon(std::array{corners[k], corners[k + 1 + odd], corners[k + 2 - odd]});
    }
  }
}

/// A cell with reversed node order has a negative volume; its faces are then reversed.
void SurfaceBuilder::add_solid(Shape shape, std::span<const std::int32_t> corners) {
  const std::span<const Face> faces = faces_of(shape);
  ++solids_;
  const auto point = [&](int corner) -> const Vec3& {
    return vertices[static_cast<std::size_t>(corners[static_cast<std::size_t>(corner)])];
  };
  double volume = 0.0;  // times 6
  for (const Face& face : faces) {
    const Vec3 from = point(face[0]) - point(0);
    for (std::size_t k = 1; k + 1 < 4 && face[k + 1] >= 0; ++k)
      volume += from.dot((point(face[k]) - point(0)).cross(point(face[k + 1]) - point(0)));
  }
  for (const Face& face : faces) {
    Quad quad{-1, -1, -1, -1};
    auto end = quad.begin();  // a degenerate cell has faces with fewer corners
    for (const int corner : face) {
      if (corner < 0) break;
      const std::int32_t vertex = corners[static_cast<std::size_t>(corner)];
      if (std::find(quad.begin(), end, vertex) == end) *end++ = vertex;
    }
    if (end - quad.begin() < 3) continue;
    if (volume < 0.0) std::reverse(quad.begin(), end);
    faces_.push_back(quad);
  }
  if (faces_.size() > kMaxFaces)
    scan_.refuse_item(fmt::format("more than {} faces of solid cells", kMaxFaces));
}

/// Replaces the polygons by the faces that belong to only one solid cell, in the order of the file.
void SurfaceBuilder::take_outer_faces() {
  report(starts_.size() - 1, "skipped ", "flat cell", "flat cells", " among solid cells");
  corners_.clear();
  starts_.assign(1, 0);
  cut_ = strips_ = triangles_ = 0;
  steps_ = 0;
  const auto sorted = [&](std::uint32_t face) {
    Quad key = faces_[face];
    std::sort(key.begin(), key.end());
    return key;
  };
  std::vector<std::pair<Quad, std::uint32_t>> keys(faces_.size());
  for (std::uint32_t n = 0; n < faces_.size(); ++n) keys[n] = {sorted(n), n};
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> outer;
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const bool has_twin = (n > 0 && keys[n - 1].first == keys[n].first) ||
                          (n + 1 < keys.size() && keys[n + 1].first == keys[n].first);
    if (!has_twin) outer.push_back(keys[n].second);
  }
  std::sort(outer.begin(), outer.end());
  for (const std::uint32_t face : outer) {
    const Quad& quad = faces_[face];
    add_polygon({quad.data(), quad[3] < 0 ? std::size_t{3} : std::size_t{4}});
  }
  cut_ = 0;
  imported_.repairs.push_back(fmt::format("took the surface of {}: {}",
                                          counted(solids_, "solid cell", "solid cells"),
                                          counted(outer.size(), "face", "faces")));
}

void SurfaceBuilder::report(std::size_t count, std::string_view done, std::string_view one,
                            std::string_view more, std::string_view then) {
  if (count > 0) imported_.repairs.push_back(fmt::format("{}{}{}", done, counted(count, one, more), then));
}

ImportedMesh SurfaceBuilder::take() {
  report(curved_, "used only the corners of ", "curved cell", "curved cells", "");
  if (solids_ > 0) take_outer_faces();
  geometry::TriangleMesh& mesh = imported_.mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles.reserve(triangles_);
  for (std::size_t n = 0; n + 1 < starts_.size(); ++n) {
    const std::int32_t* const corners = corners_.data() + starts_[n];
    const std::size_t count = starts_[n + 1] - starts_[n];
    if (count == 3) {
      mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    } else {
      const std::vector<geometry::Triangle> patch =
          least_area_patch(mesh, {corners, corners + count}, [](std::int32_t, std::int32_t) { return true; });
      mesh.triangles.insert(mesh.triangles.end(), patch.begin(), patch.end());
    }
  }
  if (solids_ > 0) drop_unused_vertices(mesh);  // those inside the solid
  report(strips_, "took ", "triangle strip", "triangle strips", " apart");
  report(cut_, "cut ", "polygon", "polygons", " into triangles");
  report(lines_, "dropped ", "line or point", "lines or points", "");
  return std::move(imported_);
}

}  // namespace palpate::mesh_io

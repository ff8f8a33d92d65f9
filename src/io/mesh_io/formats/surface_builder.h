#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "io/mesh_io/formats/scan.h"
#include "io/mesh_io/mesh_file.h"

namespace palpate::mesh_io {

enum class Shape {
  kLine,  // or points
  kStrip,
  kPolygon,
  kTriangle,
  kPixel,  // a quadrilateral whose last two corners are exchanged
  kQuadrilateral,
  kTetrahedron,
  kVoxel,  // a hexahedron of two pixels
  kHexahedron,
  kWedge,
  kPyramid
};

/// A kind of cell. Its first nodes are the corners; further nodes make it curved and are ignored.
struct CellKind {
  int vtk;            // VTK's number; 0: none
  int gmsh;           // Gmsh's number; 0: none
  std::size_t nodes;  // 0: any number
  Shape shape;
  std::string_view name;
};

/// @return nullptr for a cell that is not supported
[[nodiscard]] const CellKind* vtk_kind(std::int64_t number);
[[nodiscard]] const CellKind* gmsh_kind(std::int64_t number);

/// Makes a triangle surface from the cells of a mesh file. Triangulates polygons. Of solid cells it takes the
/// faces that belong to only one cell, oriented outwards.
class SurfaceBuilder final {
 public:
  explicit SurfaceBuilder(const MeshScan& scan) : scan_(scan) {}

  /// Polygons may be added before their vertices.
  std::vector<Vec3> vertices;

  /// Reserves memory; the caller has checked `count` against the file's size. @throws InputError above 32
  /// million
  void expect_vertices(std::size_t count);
  /// @throws InputError above 32 million
  void add_vertex(const Vec3& vertex);
  /// @throws InputError, at the scan's position, for a polygon that takes too long to triangulate, and above
  /// 20 million triangles
  void add_polygon(std::span<const std::int32_t> corners);
  /// @param nodes indices of vertices that were already added, as many as the kind has
  void add_cell(const CellKind& kind, std::span<const std::int32_t> nodes);
  void add_lines(std::size_t count) { lines_ += count; }

  /// All polygons or, if there are solid cells, their outer faces.
  [[nodiscard]] ImportedMesh take();

 private:
  using Quad = std::array<std::int32_t, 4>;  // a triangle's last is -1

  void add_solid(Shape shape, std::span<const std::int32_t> corners);
  void take_outer_faces();
  void report(std::size_t count, std::string_view done, std::string_view one, std::string_view more,
              std::string_view then);

  const MeshScan& scan_;
  ImportedMesh imported_;
  std::vector<std::int32_t> corners_;   // of all polygons
  std::vector<std::size_t> starts_{0};  // polygon n has the corners from starts_[n] to starts_[n + 1]
  std::vector<Quad> faces_;             // of solid cells
  std::size_t triangles_ = 0;           // of all polygons
  std::uint64_t steps_ = 0;             // to triangulate all polygons
  std::size_t lines_ = 0;
  std::size_t strips_ = 0;
  std::size_t cut_ = 0;
  std::size_t solids_ = 0;
  std::size_t curved_ = 0;
};

}  // namespace palpate::mesh_io

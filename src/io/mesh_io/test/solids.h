#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/mesh.h"

// Solid cells and their expected surfaces, for the tests of the readers.
namespace palpate::mesh_io::test {

struct SolidCell {
  int vtk;
  int gmsh;  // 0: none
  std::vector<std::int32_t> nodes;
};

struct Solid {
  std::string name;
  std::vector<Vec3> points;
  std::vector<SolidCell> cells;
  std::size_t triangles;  // of the surface
  double volume;
};

/// The corners of a 2 x 3 x 4 box in the order of a hexahedron, then the tip of a pyramid on it.
inline std::vector<Vec3> box_points() {
  return {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}, {0, 0, 4}, {2, 0, 4}, {2, 3, 4}, {0, 3, 4}, {1, 1, 6}};
}

inline std::vector<Solid> solids() {
  // Volumes: a tetrahedron has a sixth of the determinant of its edges, here 1/6 and 2/6. A box has 2 x 3 x
  // 4, a wedge half of that. A pyramid has a third of its base times its height.
  const std::vector<Vec3> tetrahedra{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const SolidCell hexahedron{12, 5, {0, 1, 2, 3, 4, 5, 6, 7}};
  std::vector<Vec3> curved{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int n = 0; n < 6; ++n) curved.emplace_back(0.5, 0.5, 0.1 * n);  // midpoints of its edges, anywhere
  return {
      {"two tetrahedra that share a face",
       tetrahedra,
       {{10, 4, {0, 1, 2, 3}}, {10, 4, {1, 2, 3, 4}}},
       6,
       0.5},
      {"two tetrahedra, one listed the other way round",
       tetrahedra,
       {{10, 4, {0, 2, 1, 3}}, {10, 4, {1, 2, 3, 4}}},
       6,
       0.5},
      {"a hexahedron", box_points(), {hexahedron}, 12, 24.0},
      {"a hexahedron upside down", box_points(), {{12, 5, {4, 5, 6, 7, 0, 1, 2, 3}}}, 12, 24.0},
      {"a voxel", box_points(), {{11, 0, {0, 1, 3, 2, 4, 5, 7, 6}}}, 12, 24.0},
      {"a wedge", box_points(), {{13, 6, {0, 1, 3, 4, 5, 7}}}, 8, 12.0},
      {"a hexahedron that is a wedge", box_points(), {{12, 5, {0, 1, 2, 2, 4, 5, 6, 6}}}, 8, 12.0},
      {"a wedge beside a hexahedron that is a wedge",
       box_points(),
       {{12, 5, {0, 1, 2, 2, 4, 5, 6, 6}}, {13, 6, {0, 2, 3, 4, 6, 7}}},
       12,
       24.0},
      {"a pyramid", box_points(), {{14, 7, {4, 5, 6, 7, 8}}}, 6, 4.0},
      {"a hexahedron with a pyramid upon it", box_points(), {hexahedron, {14, 7, {5, 6, 7, 4, 8}}}, 14, 28.0},
      {"a tetrahedron of second order", curved, {{24, 11, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}}}, 4, 1.0 / 6.0}};
}

}  // namespace palpate::mesh_io::test

#pragma once
#include <span>
#include <string>

#include "palpate/mesh.h"

/// The format of the built-in meshes in assets/shapes.bin, written by tools/make_shapes. An archive has
/// entries of:
///
///   a column of u32 (bytes of the packed mesh, bytes of the unpacked mesh), name, 0, the packed mesh
///   (deflate)
///
/// An unpacked mesh is a sequence of columns of numbers. A column has the lowest bytes of all its numbers,
/// then the second bytes, and so on, because that compresses well. All numbers are little-endian; signed
/// numbers are zigzag-coded. The first column is u32 vertices, triangles, grid, divisions.
///
/// Grid 0, an exact mesh: a column of the vertices (the 64 bits of each coordinate [m]) and a column of the
/// triangles' corners (i32, each minus the one before).
///
/// Grid 1 and above: a closed, connected mesh with vertices at integer multiples of 2^-grid m. It grows by
/// one triangle at a time from triangle 0 1 2: the oldest edge with only one triangle gets its second one. A
/// column of vertices (i32 per coordinate): each minus the point that completes the parallelogram over the
/// edge, vertices 0 to 2 minus 0. A column of the third corners (u32) of triangles 1, 2, ...: 0 is a new
/// vertex, k the k-th newest. Finally each triangle is divided into four, `divisions` times.
namespace palpate::geometry {

/// [setup] The archive inside the library.
[[nodiscard]] std::span<const unsigned char> built_in_meshes() noexcept;

/// [setup] Whether an archive has a mesh of that name.
[[nodiscard]] bool has_mesh(std::span<const unsigned char> archive, const std::string& name);

/// [setup] One mesh of an archive [m]. @throws std::runtime_error when no mesh has that name.
[[nodiscard]] TriangleMesh unpack_mesh(std::span<const unsigned char> archive, const std::string& name);

}  // namespace palpate::geometry

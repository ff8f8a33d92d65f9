#pragma once
#include <span>
#include <string>

#include "palpate/mesh.h"

/// The built-in meshes, as tools/make_shapes packs them into assets/shapes.bin: entries of
///
///   a column of u32 (bytes of the packed mesh, bytes of the unpacked mesh), name, 0, the packed mesh
///   (deflate)
///
/// An unpacked mesh consists of columns of numbers. A column holds the lowest bytes of all its numbers, then
/// the second bytes, and so on, because that compresses well. Everything is little-endian; signed numbers are
/// zigzag-coded. The first column is u32 vertices, triangles, grid, divisions.
///
/// Grid 0, an exact mesh: a column of the vertices (the 64 bits of each coordinate [m]) and one of the
/// triangles' corners (i32, each minus the one before it).
///
/// Grid 1 and above: a closed mesh in one piece, its vertices at whole multiples of 2^-grid m. It grows
/// triangle by triangle from triangle 0 1 2: the oldest edge with a triangle on one side only gets one on its
/// other side. A column of vertices (i32 per coordinate): minus the point that completes the parallelogram
/// over the edge, for vertices 0 to 2 minus 0. A column of the third corners (u32) of triangles 1, 2, ...: 0
/// is a new vertex, k the k-th newest. At the end each triangle is divided into four, `divisions` times.
namespace palpate::geometry {

/// [setup] The archive inside the library.
[[nodiscard]] std::span<const unsigned char> built_in_meshes() noexcept;

/// [setup] One mesh of an archive [m].
/// @throws std::runtime_error when there is none of that name.
[[nodiscard]] TriangleMesh unpack_mesh(std::span<const unsigned char> archive, const std::string& name);

}  // namespace palpate::geometry

#pragma once
// What an organ's surface consists of once it is prepared.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/content_hash.h"
#include "palpate/mesh.h"
#include "palpate/preparation.h"

namespace palpate::contact {

/// An edge at which two triangles meet at more than 60 degrees.
struct SharpEdge {
  std::array<std::int32_t, 2> triangle;
  std::array<std::int32_t, 2> edge;  // which edge of each triangle
};

inline constexpr double kBlendWidth = 1e-3;  // m, over which the two sides of a sharp edge blend

/// What the averaged normal in a triangle is beside the mean of its corners' normals: b_e b_f times the bend
/// of the edge between corners e and f, with b the barycentric coordinates.
using NormalBends = std::array<std::array<std::int16_t, 3>, 3>;  // of the edge after each corner [kBendUnit]

inline constexpr double kMostBend = 0.1;  // no surface that is smooth within a triangle bends as much
inline constexpr double kBendUnit = kMostBend / 32767.0;  // below 0.0001 degrees inside a triangle

/// The refined surface and all that contact looks up on it, in the organ's frame, metres.
struct OrganArrays {
  geometry::TriangleMesh mesh;
  std::vector<std::array<std::int32_t, 3>> neighbours;  // geometry::edge_neighbours
  std::vector<Vec3> face_normals;                       // unit
  std::vector<Vec3> normals;       // averaged: of the vertices, then of vertices' further sides
  std::vector<NormalBends> bends;  // of each triangle
  std::vector<std::int32_t>
      row_of;  // of each triangle, in side_rows; -1: its corners have their vertices' normals
  std::vector<std::array<std::int32_t, 3>>
      side_rows;  // the corners' normals, of triangles where that is not so
  std::vector<SharpEdge> sharp_edges;
  std::vector<std::int32_t> sharp_start;  // of each triangle, and the end, in sharp_near
  std::vector<std::int32_t> sharp_near;   // sharp edges within kBlendWidth of the triangle
};

/// [setup] Hash of all that the arrays depend on: the mesh's bits, the radius [m] and this code's version.
[[nodiscard]] ContentHash organ_key(const geometry::TriangleMesh& organ, double reference_radius);

/// [setup] Unit normals of all triangles' planes.
[[nodiscard]] std::vector<Vec3> face_normals_of(const geometry::TriangleMesh& mesh);

/// [setup] Refines `organ` until its edges are at most R_ref/5 (one of over 0.15 m^2 less finely).
[[nodiscard]] geometry::TriangleMesh refined(const geometry::TriangleMesh& organ, double reference_radius);

/// [setup] Works out all arrays for a mesh that is refined already. @param share told how far it is, 0..1
[[nodiscard]] OrganArrays organ_arrays(geometry::TriangleMesh mesh, double reference_radius,
                                       const std::function<void(double, const std::string&)>& share);

/// [setup] Fills sharp_edges, sharp_start and sharp_near from mesh, neighbours and face_normals.
void list_sharp_edges(OrganArrays& arrays);

}  // namespace palpate::contact

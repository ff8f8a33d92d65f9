#pragma once
// The data of a prepared organ surface.
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

struct SurfaceView;  // averaged_normals.h

/// An edge at which two triangles meet at more than 60 degrees.
struct SharpEdge {
  std::array<std::int32_t, 2> triangle;
  std::array<std::int32_t, 2> edge;  // index of the edge in each triangle
};

inline constexpr double kBlendWidth = 1e-3;  // m, distance over which the two sides of a sharp edge blend

/// Deviation of the averaged normal from linear interpolation inside a triangle: the sum over its edges of
/// b_e b_f times the edge's bend, with e and f the edge's ends and b the barycentric coordinates.
using NormalBends = std::array<std::array<std::int16_t, 3>, 3>;  // of the edge after each corner [kBendUnit]

inline constexpr double kMaxBend = 0.1;  // above any bend of a surface that is smooth within a triangle
inline constexpr double kBendUnit = kMaxBend / 32767.0;  // an error below 0.0001 degrees inside a triangle

/// The refined surface with its precomputed data, organ frame, metres.
struct OrganArrays {
  geometry::TriangleMesh mesh;
  std::vector<std::array<std::int32_t, 3>> neighbours;  // geometry::edge_neighbours
  std::vector<Vec3> normals;       // averaged: first sides of all vertices, then further sides
  std::vector<NormalBends> bends;  // per triangle
  std::vector<std::int32_t>
      row_of;  // per triangle: row in side_rows; -1: the corners have their vertices' normals
  std::vector<std::array<std::int32_t, 3>> side_rows;  // sides of the three corners, of triangles with a row
  std::vector<SharpEdge> sharp_edges;
  std::vector<std::int32_t> sharp_start;  // per triangle, and the end: start in sharp_near
  std::vector<std::int32_t> sharp_near;   // sharp edges within kBlendWidth of the triangle
};

/// The mesh of an organ's file as it was read and repaired, and the messages about it.
struct ReadOrgan {
  geometry::TriangleMesh mesh;       // [m]
  std::vector<std::string> repairs;  // that were made
  std::vector<std::string> remarks;  // defects that remain
  std::string space;                 // axes that the file's header declares; empty: none
};

/// What takes longest to compute of a supported organ's response (deform::BodyCompliance).
struct ResponseArrays {
  double cell_edge = 0.0;             // [m]
  std::vector<float> scale;           // deform::BlockInverse
  std::vector<std::int16_t> entries;  // deform::BlockInverse
};

/// Keeps the meshes of organs' files, the arrays of prepared organs, the stiffness maps interpolated on them,
/// and their responses.
class OrganStore {
 public:
  virtual ~OrganStore() = default;
  /// [setup] The stored mesh of a file; empty when it was not read before. @param key of the file's content
  [[nodiscard]] virtual std::optional<ReadOrgan> load_read(const ContentHash& key) const = 0;
  /// [setup] Stores the mesh that was read.
  virtual void store_read(const ContentHash& key, const ReadOrgan& organ) const = 0;
  /// [setup] The stored arrays of this organ; empty when it was not prepared before.
  [[nodiscard]] virtual std::optional<OrganArrays> load(const geometry::TriangleMesh& organ,
                                                        double reference_radius) const = 0;
  /// [setup] Stores the arrays that were computed.
  virtual void store(const geometry::TriangleMesh& organ, double reference_radius,
                     const OrganArrays& arrays) const = 0;
  /// [setup] The stored values of a stiffness map (StiffnessMap::key); empty when it was not interpolated
  /// before.
  [[nodiscard]] virtual std::vector<double> load_factors(const ContentHash& key) const = 0;
  /// [setup] Stores the values that were interpolated.
  virtual void store_factors(const ContentHash& key, const std::vector<double>& factors) const = 0;
  /// [setup] The stored response; empty when it was not computed before. @param key of organ and support
  [[nodiscard]] virtual std::optional<ResponseArrays> load_response(const ContentHash& key) const = 0;
  /// [setup] Stores the response that was computed.
  virtual void store_response(const ContentHash& key, const ResponseArrays& response) const = 0;
};

/// [setup] Hash of everything that the arrays depend on: the mesh's bits, the radius [m] and kArraysVersion.
[[nodiscard]] ContentHash organ_key(const geometry::TriangleMesh& organ, double reference_radius);

/// [setup] Unit normals of all triangles.
[[nodiscard]] std::vector<Vec3> face_normals_of(const geometry::TriangleMesh& mesh);

/// [setup] Refines `organ` until its edges are at most R_ref/5 (less finely above 0.15 m^2).
[[nodiscard]] geometry::TriangleMesh refined(const geometry::TriangleMesh& organ, double reference_radius);

/// [setup] Computes the arrays of a refined mesh, except for `mesh` and `neighbours`.
/// @param neighbours geometry::edge_neighbours() of the mesh @param share receives the progress, 0..1, and
/// the stage
[[nodiscard]] OrganArrays organ_arrays(const geometry::TriangleMesh& mesh,
                                       const std::vector<std::array<std::int32_t, 3>>& neighbours,
                                       double reference_radius,
                                       const std::function<void(double, const std::string&)>& share);

/// [setup] Fills sharp_edges, sharp_start and sharp_near.
void list_sharp_edges(const SurfaceView& surface, OrganArrays& arrays);

}  // namespace palpate::contact

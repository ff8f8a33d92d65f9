#pragma once
// Interface of the shared library libpalpate_peers.so. It is plain C, so that the peers' own settings (Eigen
// alignment, precision) stay inside and none of them is linked into the program. `palpate bench` opens it
// only for a comparison with peers.
#include <stddef.h>  // NOLINT(modernize-deprecated-headers)
#include <stdint.h>  // NOLINT(modernize-deprecated-headers)

extern "C" {

/// A triangle mesh: x y z [m] per vertex, three indices per triangle.
struct PalpatePeerMesh {
  const double* vertices;
  size_t vertex_count;
  const int32_t* triangles;
  size_t triangle_count;
};

/// One library to compare. Everything is in the organ's frame.
struct PalpatePeer {
  const char* name;
  const char* does;
  int one_point;  // queries the first point only, without a tool
  int in_order;   // simulates: needs the path from its start, in even steps
  /// Prepares its data once; null when the library rejects the mesh.
  void* (*open)(const PalpatePeerMesh* organ, const PalpatePeerMesh* parts, size_t part_count);
  /// One tick. `poses`: x y z, then the quaternion w x y z, per part; `point`: x y z of the tool's tip.
  /// @return its distance [m], negative or 0 in contact; NaN when it computes none.
  double (*ask)(void* opened, const double* poses, const double* point);
  void (*close)(void* opened);
};

/// The peers that were found at build time.
const PalpatePeer* palpate_peers(size_t* count);
}

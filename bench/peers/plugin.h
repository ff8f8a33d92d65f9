#pragma once
// What the shared library libpalpate_peers.so offers: plain C, so that the peers' own settings (Eigen with or
// without vectors, floats) stay in it and nothing of them is linked into the program. `palpate bench` opens
// it only when peers are asked.
#include <stddef.h>  // NOLINT(modernize-deprecated-headers)
#include <stdint.h>  // NOLINT(modernize-deprecated-headers)

extern "C" {

/// A triangle surface: x y z [m] a vertex, three indices a triangle.
struct PalpatePeerMesh {
  const double* vertices;
  size_t vertex_count;
  const int32_t* triangles;
  size_t triangle_count;
};

/// One library that can be asked. Everything is in the organ's frame.
struct PalpatePeer {
  const char* name;
  const char* does;
  int one_point;  // asks the first point only, no tool
  int in_order;   // must see the way from its begin, in even steps
  /// What is prepared once; null when the library refuses.
  void* (*open)(const PalpatePeerMesh* organ, const PalpatePeerMesh* parts, size_t part_count);
  /// One tick. `poses`: x y z, then the rotation w x y z, a part; `point`: x y z of the tool's tip.
  /// @return the distance [m] it found, negative or 0 in contact; NaN when it says none.
  double (*ask)(void* opened, const double* poses, const double* point);
  void (*close)(void* opened);
};

/// The peers that were found when this was built.
const PalpatePeer* palpate_peers(size_t* count);
}

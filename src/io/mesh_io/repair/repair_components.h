#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh_io/repair/repair_surface.h"

// Pieces of a closed, evenly turned surface, for repair.cc.
namespace palpate::geometry {

/// What became of the components and of triangles that go through each other.
struct ComponentsDone {
  Done small;                // closed, of hardly any volume, dropped
  double small_share = 0.0;  // of the volume
  Done inner;                // inside another component, dropped
  std::size_t kept = 0;
  std::size_t crossing_pairs = 0;  // left
  double crossing_share = 0.0;     // of the surface that these triangles have
  std::string refusal;             // empty: none
};

/// Drops open components of at most a hundredth of the surface, but never the largest.
Done drop_small_open_components(WorkSurface& surface, const Opposites& opposite);

/// Turns each component outwards, drops components of at most a hundredth of the largest one's volume and
/// those inside another, and looks for triangles that go through each other.
ComponentsDone sort_out_components(WorkSurface& surface);

}  // namespace palpate::geometry

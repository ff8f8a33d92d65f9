#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh_io/repair/repair_surface.h"

// Pieces of a closed, evenly turned surface, for repair.cc.
namespace palpate::geometry {

/// What became of the pieces and of triangles that go through each other.
struct PiecesDone {
  Done scraps;                // closed, of hardly any volume, dropped
  double scraps_share = 0.0;  // of the volume
  Done inner;                 // inside another piece, dropped
  std::size_t kept = 0;
  std::size_t crossing_pairs = 0;  // left
  double crossing_share = 0.0;     // of the surface that these triangles have
  std::string refusal;             // empty: none
};

/// Drops open pieces of at most a hundredth of the surface, but never the largest.
Done drop_open_scraps(WorkSurface& surface, const Mates& mates);

/// Turns each piece outwards, drops pieces of at most a hundredth of the largest one's volume and those
/// inside another, and looks for triangles that go through each other.
PiecesDone sort_out_pieces(WorkSurface& surface);

}  // namespace palpate::geometry

#pragma once
#include <cstddef>
#include <string>

#include "io/mesh_io/repair/repair_surface.h"

// Components of a closed, consistently oriented surface, for repair.cc.
namespace palpate::mesh_io {

/// Result of the repairs of components and of intersecting triangles.
struct ComponentRepairs {
  RepairCount small;         // dropped: closed, with almost no volume
  double small_share = 0.0;  // of the volume, dropped with the small components
  RepairCount inner;         // dropped: inside another component
  std::size_t kept = 0;
  std::size_t crossing_pairs = 0;  // remaining pairs of intersecting triangles
  double crossing_share = 0.0;     // of the surface's area that these triangles have
  std::string refusal;             // empty: none
  std::string remedy;              // what helps, where no repair does
};

/// Drops open components of at most a hundredth of the surface's area, but never the largest.
RepairCount drop_small_open_components(WorkSurface& surface, const Opposites& opposite);

/// Orients each component outwards, drops components of at most a hundredth of the largest one's volume and
/// those inside another, and searches for intersecting triangles. @param is_one the surface is one component
ComponentRepairs clean_components(WorkSurface& surface, bool is_one);

}  // namespace palpate::mesh_io

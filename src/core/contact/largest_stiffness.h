#pragma once
#include <vector>

#include "core/contact/contact.h"
#include "core/contact/tissue_laws.h"
#include "palpate/inclusion.h"

namespace palpate::contact {

/// How deep a tool may press or pull.
struct StiffnessReach {
  model::Direction direction = model::Direction::kPress;
  double max_force = 20.0;   // N, of the gate
  double max_depth = 15e-3;  // m
};

/// [setup] Largest tangent stiffness [N/m] of the uniform tissue within reach. Both laws stiffen with depth,
/// so it is the one at the deepest point.
[[nodiscard]] double largest_tangent(const model::SpringLaw& law, const StiffnessReach& reach);

/// [setup] Largest stiffness [N/m] of the elastic force within reach, anywhere on the organ, for one tool.
///
/// Tissue that is not uniform has the energy U(D, c) of the depth D and the place c (tool_tissue.h). A tool
/// that moves along the normal changes D, one that moves sideways changes c. So the hand feels the Hessian
///
///     | d2U/dD2   d2U/dDdc |
///     | d2U/dDdc  d2U/dc2  |
///
/// and this is its largest absolute eigenvalue. The Hessian is the difference quotient of the force that a
/// tick computes, so coincident inclusions, a stiffness map below them and the cap of their product
/// are in it. It is evaluated at eight depths
///
/// - above each inclusion and between each two of them, on rings as wide as the inclusion is deep, at both
///   ends of its pulse;
/// - on every triangle of the surface for a stiffness map, at the deepest point only: there the quotient of
///   the map's gradients at the triangle's corners replaces d2k/dc2.
///
/// Uniform tissue gives largest_tangent().
/// @throws InputError for an inclusion that is not inside the organ
[[nodiscard]] double largest_stiffness(const World& world, const TissueLaws& laws,
                                       const std::vector<model::Inclusion>& inclusions, std::size_t tool,
                                       const StiffnessReach& reach);

}  // namespace palpate::contact

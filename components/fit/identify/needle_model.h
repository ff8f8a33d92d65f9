#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "palpate/tissue.h"

namespace palpate::identify {

/// A record of one insertion: depth of the tip along its line [m], force against it [N], over time [s]. A row
/// may be the mean of several.
struct NeedleRecord {
  std::string name;
  std::vector<double> time;
  std::vector<double> depth;
  std::vector<double> force;
  std::vector<double> rows;  // of the file, that each row is the mean of

  [[nodiscard]] std::size_t size() const noexcept { return time.size(); }
};

/// Where the needle went through a membrane.
struct Puncture {
  double time = 0.0;    // [s]
  double depth = 0.0;   // of the tip from first contact [m]
  double force = 0.0;   // [N], on the whole needle
  double tip = 0.0;     // [N], on the tip alone: the layer's puncture force
  double length = 0.0;  // [m] of the shaft inside: the depth of the membrane
};

/// The force that the simulation's needle meets on a record's path (core/contact/needle.h).
struct NeedleRun {
  std::vector<double> force;        // [N], one a row
  std::vector<Puncture> punctures;  // of the first insertion
};

/// [setup] Moves a needle along a record's path, straight into a flat tissue.
/// @param contact depth of the record at which it touches [m]
/// @param times [s] at which a membrane is punctured and the next one reached, in turns, whatever the
/// tissue's puncture forces and thicknesses; empty: by these
/// @param longest_step between ticks [s]
/// @throws ParameterError for a tissue without a valid law
[[nodiscard]] NeedleRun run_needle(const NeedleRecord& record, const model::TissueParameters& tissue,
                                   double contact, std::span<const double> times, double longest_step);

}  // namespace palpate::identify

#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "science/identify/fit_many.h"
#include "science/identify/sweep.h"

namespace palpate::identify {

/// One half of a sweep: the values above the best fit's own, or those below it.
struct SweepPiece {
  std::size_t target = 0;  // which specimen; their number: all together
  SweepRequest request;
  bool upwards = true;
};

/// [setup] The values of a request for a target as the solver sees them, natural logarithms of SI, rising.
[[nodiscard]] std::vector<double> sweep_values(const SweepRequest& request, const Estimate& estimate,
                                               const Bounds& bounds);

/// [setup] Computes a piece; as one line of JSON without the line's end, to the bit.
[[nodiscard]] std::string sweep_line(const SweepPiece& piece, const std::string& key,
                                     const std::vector<Specimen>& specimens, const ManyFits& fits,
                                     const Settings& settings);

/// [setup] Adds the points of such a line to a sweep. @throws InputError when the line is not one.
void add_sweep_line(const std::string& line, Sweep& sweep);

}  // namespace palpate::identify

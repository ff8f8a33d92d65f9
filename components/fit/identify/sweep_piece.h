#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "fit/identify/fit_many.h"
#include "fit/identify/sweep.h"

namespace palpate::identify {

/// One half of a sweep: the values above the fit's value, or those below it.
struct SweepPiece {
  std::size_t target = 0;  // index of the specimen; the number of specimens: pooled
  SweepRequest request;
  bool upwards = true;
};

/// [setup] The swept values of a request as natural logarithms of SI values, increasing.
[[nodiscard]] std::vector<double> sweep_values(const SweepRequest& request, const Estimate& estimate,
                                               const Bounds& bounds);

/// [setup] Computes a piece. Returns one line of JSON without line end, bit for bit exact.
[[nodiscard]] std::string sweep_line(const SweepPiece& piece, const std::string& key,
                                     const std::vector<Specimen>& specimens, const ManyFits& fits,
                                     const Settings& settings);

/// [setup] Adds the points of a line of sweep_line() to a sweep. @throws InputError when the line is invalid.
void add_sweep_line(const std::string& line, Sweep& sweep);

}  // namespace palpate::identify

#pragma once
#include <filesystem>
#include <string>

#include "science/study/sweep.h"

namespace palpate::report {

/// [setup] Draws peak tissue force, depth at that peak, loading work and dissipated energy of a sweep with
/// gnuplot to `file` (SVG): over the first axis of several values, a trace a value of the second, at most
/// eight, at the first value of all others. Runs that failed are left out; those that missed the organ are
/// crosses.
/// @return why there is no figure, in words; empty: it is there. @throws InputError when it cannot be written
[[nodiscard]] std::string draw_sweep(const study::SweepResult& sweep, const std::filesystem::path& file);

}  // namespace palpate::report

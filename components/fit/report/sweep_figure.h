#pragma once
#include <filesystem>
#include <string>

#include "fit/sweep/sweep.h"

namespace palpate::report {

/// [setup] Draws the results of a sweep with gnuplot to `file` (SVG): peak tissue force, depth at that peak,
/// loading work and dissipated energy. The x axis is the first swept axis with several values; each value of
/// the second one is a curve (at most eight); all other axes are at their first value. Failed runs are
/// omitted; runs without contact are crosses.
/// @return reason why there is no figure; empty: it exists. @throws InputError when it cannot be written
[[nodiscard]] std::string draw_sweep(const sweep::SweepResult& sweep, const std::filesystem::path& file);

}  // namespace palpate::report

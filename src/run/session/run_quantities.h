#pragma once
#include <array>

#include "palpate/session.h"

namespace palpate::session {

/// A scalar result of a run. `palpate run --json` and the table of a sweep iterate over these.
struct RunQuantity {
  const char* name;   // with its unit
  const char* label;  // in reports, with its unit
  double (*of)(const RunResult&) noexcept;
};

// clang-format off
inline constexpr auto kRunQuantities = std::to_array<RunQuantity>({
  {"peak_force_N", "peak force at the device, N",
   [](const RunResult& run) noexcept { return run.statistics.peak_force; }},
  {"peak_tissue_force_N", "peak tissue force, N",
   [](const RunResult& run) noexcept { return run.statistics.peak_tissue; }},
  {"peak_depth_mm", "peak depth, mm",
   [](const RunResult& run) noexcept { return run.statistics.peak_depth * 1e3; }},
  {"depth_at_peak_mm", "depth at peak tissue force, mm",
   [](const RunResult& run) noexcept { return run.statistics.depth_at_peak * 1e3; }},
  {"fastest_rise_N_per_s", "fastest rise of tissue force, N/s",
   [](const RunResult& run) noexcept { return run.statistics.fastest_rise; }},
  {"loading_work_mJ", "loading work, mJ",
   [](const RunResult& run) noexcept { return run.statistics.loading_work * 1e3; }},
  {"dissipated_energy_mJ", "dissipated energy, mJ",
   [](const RunResult& run) noexcept { return run.statistics.dissipated * 1e3; }},
  {"contact_time_s", "time in contact, s",
   [](const RunResult& run) noexcept { return static_cast<double>(run.statistics.contact_ticks) / run.rate_Hz; }},
});
// clang-format on

}  // namespace palpate::session

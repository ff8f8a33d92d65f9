// Runs the emulated hand over devices, grips, tissues and rates, and writes the result of each case as CSV.
// tools/plot_stability draws docs/pictures/stability.png from it. Takes minutes on one core. Results do not
// depend on machine or clock. Usage: palpate_stability_sweep FILE.csv
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>

#include "core/base/text.h"

#include "bench/measure/stability.h"

namespace {

using palpate::bench::StabilityBlock;
using palpate::bench::StabilityCase;
using palpate::bench::StabilityResult;

constexpr double kMillimetres = 1e3;
constexpr double kMicrojoules = 1e6;

const char* verdict_of(const StabilityResult& result) {
  if (result.faulted) return "fault";
  return result.peak_to_peak <= palpate::bench::kStillHold ? "still" : "trembles";
}

const char* warning_of(const palpate::haptics::StabilityCheck& check) {
  if (check.damping_short && check.friction_short) return "both";
  if (check.damping_short) return "damping";
  return check.friction_short ? "friction" : "none";
}

void write_row(std::ostream& out, const StabilityCase& c, const StabilityResult& r) {
  const auto text = [](double value) { return palpate::brief(value); };
  out << c.tissue.name << ',' << text(r.stiffness) << ',' << text(c.rate_Hz) << ',' << text(c.grip.stiffness)
      << ',' << text(c.grip.damping) << ',' << text(c.device.damping) << ',' << text(c.device.friction) << ','
      << text(c.device.resolution * kMillimetres) << ',' << text(r.depth * kMillimetres) << ','
      << text(r.force) << ',' << text(r.peak_to_peak * kMillimetres) << ','
      << text(r.given_beyond_taken * kMicrojoules) << ',' << text(r.observed_deficit * kMicrojoules) << ','
      << text(palpate::bench::energy_bound(r) * kMicrojoules) << ',' << (r.controlled ? 1 : 0) << ','
      << warning_of(r.check) << ',' << verdict_of(r) << '\n';
}

bool same_block(const StabilityCase& a, const StabilityCase& b) {
  return a.tissue.name == b.tissue.name && a.tissue.k1 == b.tissue.k1 && a.rate_Hz == b.rate_Hz;
}

void sweep(std::ostream& out) {
  out << "tissue,stiffness_N_per_m,rate_Hz,grip_N_per_m,grip_N_s_per_m,damping_N_s_per_m,friction_N,"
         "resolution_mm,depth_mm,force_N,peak_to_peak_mm,given_beyond_taken_uJ,observed_uJ,bound_uJ,"
         "controller_acted,warning,verdict\n";
  std::vector<StabilityCase> cases = palpate::bench::tissue_cases();
  const std::vector<StabilityCase> walls = palpate::bench::wall_cases();
  cases.insert(cases.end(), walls.begin(), walls.end());
  std::optional<StabilityBlock> block;
  std::size_t done = 0;
  for (const StabilityCase& c : cases) {
    if (done == 0 || !same_block(cases[done - 1], c)) {
      std::cerr << "stability_sweep: " << done << " of " << cases.size() << " cases; " << c.tissue.name
                << " at " << c.rate_Hz << " Hz\n";
      block.emplace(c.tissue, c.rate_Hz);
    }
    write_row(out, c, block->run(c));
    ++done;
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: palpate_stability_sweep FILE.csv\n", stderr);
    return 2;
  }
  try {
    std::ofstream out(arguments[1]);
    sweep(out);
    out.flush();
    if (out) return 0;
    std::cerr << "stability_sweep: " << arguments[1] << ": cannot be written\n";
  } catch (const std::exception& error) {
    std::cerr << "stability_sweep: " << error.what() << '\n';
  }
  return 1;
}

// A surface of your own becomes an organ: read, looked at, repaired, pressed with a ball of 5 mm radius.
// Usage: own_organ FILE UNIT [TISSUE]     e.g. own_organ examples/kidney.stl mm kidney
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "palpate/base/error.h"
#include "palpate/devices/devices.h"
#include "palpate/geometry/read_mesh.h"
#include "palpate/haptics/loop.h"
#include "palpate/scene/load.h"
#include "palpate/scene/make_world.h"

namespace {

/// What `palpate inspect` tells of a file before anything is repaired.
void show_findings(const std::string& file, const std::string& unit) {
  const palpate::geometry::LoadedMesh found =
      palpate::geometry::read_mesh(file, palpate::parse_length_unit(unit));
  std::cout << file << ": " << found.mesh.triangles.size() << " triangles, "
            << (found.findings.closed ? "closed" : "not closed") << '\n';
  for (const std::string& defect : found.findings.defects) std::cout << "  defect: " << defect << '\n';
}

/// Keeps the largest tissue force and depth of all rows.
class Deepest final : public palpate::haptics::TickObserver {
 public:
  void on_row(const palpate::haptics::TickRow& row) noexcept override {
    force = std::max(force, row.tissue_force);
    depth = std::max(depth, row.depth);
  }
  double force = 0.0;  // N
  double depth = 0.0;  // m
};

int press(const std::string& file, const std::string& unit, const std::string& tissue) {
  show_findings(file, unit);

  // A request is what a user says on the command line; what it leaves out has defaults.
  palpate::scene::Request request;
  request.organ = file;
  request.organ_unit = unit;
  request.tissue = tissue;
  request.tools = {"sphere:5"};
  const palpate::scene::Setup setup = palpate::scene::load(request);  // repairs, or refuses in one line
  for (const std::string& repair : setup.repairs) std::cout << "  repaired: " << repair << '\n';

  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  const auto device = palpate::devices::open_device(setup, 0);  // scripted: goes to 12 mm of depth and back
  palpate::haptics::Device* const hand = device.get();

  Deepest deepest;
  palpate::haptics::LoopOptions options;
  options.offline = true;
  options.ticks = device->last_tick(setup.rate_Hz);
  const auto report = palpate::haptics::run_loop(world, state, {&hand, 1}, {&deepest}, options);
  std::cout << report.ticks << " ticks, deepest " << 1e3 * deepest.depth << " mm, largest force "
            << deepest.force << " N\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: own_organ FILE UNIT [TISSUE]\n";
    return 2;
  }
  try {
    return press(argv[1], argv[2], argc > 3 ? argv[3] : "liver");
  } catch (const palpate::InputError& error) {
    std::cerr << "own_organ: " << error.what() << '\n';
    return 2;
  }
}

// Makes an organ of your own surface mesh: inspect, repair, and press with a ball of 5 mm radius.
// Usage: own_organ FILE UNIT [TISSUE]     e.g. own_organ examples/kidney.stl mm kidney
#include <iostream>
#include <string>
#include <utility>

#include "palpate/error.h"
#include "palpate/read_mesh.h"
#include "palpate/scene.h"
#include "palpate/session.h"

namespace {

/// Prints the findings of `palpate inspect` before any repair.
void show_findings(const std::string& file, const std::string& unit) {
  const palpate::geometry::LoadedMesh found =
      palpate::geometry::read_mesh(file, palpate::parse_length_unit(unit));
  std::cout << file << ": " << found.mesh.triangles.size() << " triangles, "
            << (found.findings.closed ? "closed" : "not closed") << '\n';
  for (const std::string& defect : found.findings.defects) std::cout << "  defect: " << defect << '\n';
}

int press(const std::string& file, const std::string& unit, const std::string& tissue) {
  show_findings(file, unit);

  // Overrides correspond to the flags of the command line. Everything else has a default.
  palpate::scene::Overrides request;
  request.organ = file;
  request.organ_unit = unit;
  request.tissue = tissue;
  request.tools = {"sphere:5"};
  palpate::scene::Scene scene = palpate::scene::load(request);  // repairs the mesh, or throws an InputError
  for (const std::string& repair : scene.repairs) std::cout << "  repaired: " << repair << '\n';

  // The hand is scripted: it presses 12 mm deep and goes back.
  const auto result = palpate::session::Session::open(std::move(scene)).run({.offline = true});
  std::cout << result.loop.ticks << " ticks, deepest " << 1e3 * result.statistics.peak_depth
            << " mm, largest force " << result.statistics.peak_tissue << " N\n";
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

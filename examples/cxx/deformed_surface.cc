// The organ's surface as it is seen while a tool presses, without any drawing: vertices out, an OBJ file if
// you like. Usage: deformed_surface [SURFACE.obj]
#include <algorithm>
#include <fstream>
#include <iostream>
#include <vector>

#include "palpate/deform/displacement.h"
#include "palpate/deform/indentations.h"
#include "palpate/devices/devices.h"
#include "palpate/geometry/mesh.h"
#include "palpate/haptics/loop.h"
#include "palpate/scene/load.h"
#include "palpate/scene/make_world.h"

namespace {

using palpate::Vec3;

/// Runs the first `ticks` ticks of the scripted hand and gives back what the tools do then.
std::vector<palpate::contact::ToolResult> contacts_after(const palpate::scene::Setup& setup,
                                                         std::uint64_t ticks) {
  const palpate::haptics::SimulationWorld world = palpate::scene::make_world(setup);
  palpate::haptics::SimulationState state(world);
  const auto device = palpate::devices::open_device(setup, 0);
  palpate::haptics::Device* const hand = device.get();
  palpate::haptics::LoopOptions options;
  options.offline = true;
  options.ticks = ticks;
  (void)palpate::haptics::run_loop(world, state, {&hand, 1}, {}, options);
  return state.results;
}

void write_obj(const char* file, const std::vector<Vec3>& vertices,
               const std::vector<palpate::geometry::Triangle>& triangles) {
  std::ofstream obj(file);
  for (const Vec3& v : vertices) obj << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : triangles) obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  const palpate::scene::Setup setup = palpate::scene::load({});
  // Each contact pushes (or pulls) the surface at one place, by its depth, as wide as the tool is there.
  const auto indentations = palpate::deform::indentations_of(contacts_after(setup, 3000));

  // The forces need no fine mesh; a smooth picture does. Edges of 2 mm, the surface stays where it is.
  palpate::deform::SurfaceDeformer deformer(palpate::geometry::refine(setup.organ, 2e-3));
  std::vector<Vec3> vertices;
  deformer.deform(setup.tissue.reach, indentations, vertices);

  const std::vector<Vec3>& rest = deformer.rest().vertices;
  double largest = 0.0;
  std::size_t moved = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double way = (vertices[i] - rest[i]).norm();
    largest = std::max(largest, way);
    if (way > 0.0) ++moved;
  }
  std::cout << indentations.size() << " contacts: " << moved << " of " << rest.size()
            << " vertices have moved, at most " << 1e3 * largest << " mm\n";
  if (argc > 1) write_obj(argv[1], vertices, deformer.rest().triangles);
  return moved > 0 ? 0 : 1;
}

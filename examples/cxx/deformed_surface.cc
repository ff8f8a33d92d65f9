// Computes the deformed surface of an organ during a press, without drawing it, and can write it as an OBJ
// file. Usage: deformed_surface [SURFACE.obj]
#include <algorithm>
#include <fstream>
#include <iostream>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/scene.h"
#include "palpate/session.h"
#include "palpate/surface.h"

namespace {

using palpate::Vec3;

/// Runs the first 3 s of the scripted hand and returns the last snapshot.
palpate::haptics::Snapshot press(const palpate::scene::Scene& scene) {
  palpate::haptics::SnapshotPublisher newest;
  palpate::session::Session(scene, {.duration_s = 3.0}).run({.offline = true}, {&newest});
  newest.cell().refresh();
  return newest.cell().value();
}

void write_obj(const char* file, const std::vector<Vec3>& vertices,
               const std::vector<palpate::geometry::Triangle>& triangles) {
  std::ofstream obj(file);
  for (const Vec3& v : vertices) obj << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : triangles) obj << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  const palpate::scene::Scene scene = palpate::scene::load({});
  // An indentation per contact: point, direction, depth, and width of the tool.
  const palpate::haptics::Snapshot snapshot = press(scene);
  const auto indentations = palpate::deform::indentations_of({snapshot.results.data(), snapshot.hands});

  // Forces need no fine mesh, but a smooth picture does. Refining to edges of 2 mm does not change the shape.
  palpate::deform::SurfaceDeformer deformer(palpate::geometry::refine(scene.organ, 2e-3));
  std::vector<Vec3> vertices;
  deformer.deform(scene.tissue.reach, indentations, vertices);

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

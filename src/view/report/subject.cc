#include "view/report/subject.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/index.h"
#include "palpate/mesh.h"

namespace palpate::report {

render::Subject subject_of(const scene::Scene& scene) {
  return {scene.organ,
          scene.tools,
          scene.tissue.reach,
          scene.tissue.name,
          scene::visible_inclusions(scene.inclusions),
          scene.support,
          scene.organ_name,
          scene.store};
}

SurfacePlaces places_of(const geometry::TriangleMesh& organ) {
  constexpr double kEdge = 1.5e-3;  // m, between places that take a colour
  const geometry::TriangleMesh fine = geometry::refine(organ, kEdge);
  SurfacePlaces places;
  for (const geometry::Triangle& t : fine.triangles) {
    places.points.emplace_back((fine.vertices[at(t[0])] + fine.vertices[at(t[1])] + fine.vertices[at(t[2])]) /
                               3.0);
    places.normals.push_back(geometry::area_vector_doubled(fine, t));
  }
  return places;
}

std::vector<float> held_values(const geometry::TriangleMesh& organ, const SurfacePlaces& places,
                               const geometry::Support& support) {
  const geometry::HeldSurface held(support, organ);
  std::vector<float> values;
  values.reserve(places.points.size());
  for (std::size_t i = 0; i < places.points.size(); ++i) {
    const bool holds = held.holds(places.points[i], places.normals[i]);
    values.push_back(holds ? 1.0F : std::numeric_limits<float>::quiet_NaN());
  }
  return values;
}

render::Image draw_held(const geometry::TriangleMesh& organ, const geometry::Support& support, int height) {
  SurfacePlaces places = places_of(organ);
  render::SurfaceValues values;
  values.values = held_values(organ, places, support);
  values.points_S = std::move(places.points);
  return draw_both_sides(organ, std::move(values), height);
}

render::Image draw_both_sides(const geometry::TriangleMesh& organ, render::SurfaceValues values, int height) {
  const int width = height * 8 / 7;
  render::Subject subject;
  subject.organ = organ;
  render::OffscreenRenderer renderer(subject, width, height);
  renderer.show_values(std::move(values));
  render::Image both{2 * width, height, {}};
  both.rgb.resize(static_cast<std::size_t>(2 * width * height) * 3);
  for (int side = 0; side < 2; ++side) {
    haptics::Snapshot at_rest;
    if (side == 1) at_rest.organ_W.rotation = Quat(0.0, 0.0, 1.0, 0.0);  // half a turn about y
    const render::Camera camera =
        render::frame_from_above(subject, at_rest, static_cast<double>(width) / height);
    const render::Image one = renderer.draw(at_rest, camera);
    for (int row = 0; row < height; ++row) {
      std::copy_n(one.rgb.begin() + std::ptrdiff_t{3} * width * row, 3 * width,
                  both.rgb.begin() + std::ptrdiff_t{3} * width * (2 * row + side));
    }
  }
  return both;
}

}  // namespace palpate::report

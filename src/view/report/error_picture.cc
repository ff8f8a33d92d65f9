// The picture of `palpate inspect --reference`: the error of the shown surface as colours.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/index.h"
#include "view/render/map_legend.h"
#include "view/report/subject.h"
#include "view/report/surface_error.h"

namespace palpate::report {
namespace {

constexpr double kColoured = 1e-3;  // m, between points that take a colour

/// Pieces of a triangle's sides at a distance of its points.
int pieces_of(const std::array<Vec3, 3>& p, double edge) {
  const double longest = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
  return std::max(1, static_cast<int>(std::ceil(std::min(longest / edge, 1e4))));
}

/// The distance [m] between points that take a colour: kColoured, or more where slivers would have too many.
double edge_for(const geometry::TriangleMesh& organ) {
  constexpr double kMostPoints = 4e6;
  for (double edge = kColoured;; edge *= 1.5) {
    double points = 0.0;
    for (const geometry::Triangle& t : organ.triangles) {
      const int n =
          pieces_of({organ.vertices[at(t[0])], organ.vertices[at(t[1])], organ.vertices[at(t[2])]}, edge);
      points += 0.5 * n * (n + 1.0);
    }
    if (points <= std::max(kMostPoints, 2.0 * static_cast<double>(organ.triangles.size()))) return edge;
  }
}

}  // namespace

render::Image draw_error(const geometry::TriangleMesh& organ, const SurfaceError& error, double range,
                         int height) {
  render::SurfaceValues values;
  values.high = range;
  const double edge = edge_for(organ);
  for (const geometry::Triangle& t : organ.triangles) {
    const std::array<Vec3, 3> p = {organ.vertices[at(t[0])], organ.vertices[at(t[1])],
                                   organ.vertices[at(t[2])]};
    const int n = pieces_of(p, edge);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        const double b = (i + 1.0 / 3.0) / n;
        const double c = (j + 1.0 / 3.0) / n;
        values.points_S.emplace_back((1.0 - b - c) * p[0] + b * p[1] + c * p[2]);
        values.values.push_back(static_cast<float>((1.0 - b - c) * error.at[at(t[0])] +
                                                   b * error.at[at(t[1])] + c * error.at[at(t[2])]));
      }
    }
  }
  render::Image picture = draw_both_sides(organ, std::move(values), height);
  render::draw_map_legend(picture, range);
  return picture;
}

}  // namespace palpate::report

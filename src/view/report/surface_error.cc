#include "view/report/surface_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/units.h"
#include "view/render/map_legend.h"
#include "view/report/subject.h"

namespace palpate::report {
namespace {

constexpr double kSamePlace = 0.01e-3;  // m, between a vertex and its row
constexpr double kMoves = 0.02;         // of the depth
constexpr double kColoured = 1e-3;      // m, between points that take a colour

using Cell = std::array<std::int64_t, 3>;  // of kSamePlace

Cell cell_of(const Vec3& p) {
  Cell cell{};
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = static_cast<std::int64_t>(std::floor(p[static_cast<Eigen::Index>(k)] / kSamePlace));
  return cell;
}

struct Row {
  Vec3 place = Vec3::Zero();
  Vec3 moved = Vec3::Zero();
};

// The row nearest to a vertex, within kSamePlace; null: none.
const Row* row_at(const std::multimap<Cell, Row>& rows, const Vec3& vertex) {
  const Row* nearest = nullptr;
  double least = kSamePlace;
  const Cell middle = cell_of(vertex);
  for (int n = 0; n < 27; ++n) {
    const Cell cell = {middle[0] + n / 9 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n % 3 - 1};
    const auto [from, to] = rows.equal_range(cell);
    for (auto row = from; row != to; ++row) {
      const double away = (row->second.place - vertex).norm();
      if (away > least) continue;
      least = away;
      nearest = &row->second;
    }
  }
  return nearest;
}

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

std::vector<Vec3> read_reference(const std::filesystem::path& file, const geometry::TriangleMesh& organ) {
  CsvTable table(file, {{"x_mm"}, {"y_mm"}, {"z_mm"}, {"u_x_mm"}, {"u_y_mm"}, {"u_z_mm"}}, 1e6);
  std::multimap<Cell, Row> rows;
  while (table.next_row()) {
    const Row row{Vec3(table.number(0), table.number(1), table.number(2)) * kMillimetre,
                  Vec3(table.number(3), table.number(4), table.number(5)) * kMillimetre};
    rows.emplace(cell_of(row.place), row);
  }
  std::vector<Vec3> reference;
  reference.reserve(organ.vertices.size());
  for (const Vec3& vertex : organ.vertices) {
    const Row* const row = row_at(rows, vertex);
    if (row == nullptr) {
      const auto mm = [](double metres) { return brief(metres / kMillimetre, 6); };
      throw InputError(fmt::format(
          "{}: has no row for the organ's vertex at ({}, {}, {}) mm, must have one within 0.01 mm",
          to_text(file), mm(vertex.x()), mm(vertex.y()), mm(vertex.z())));
    }
    reference.push_back(row->moved);
  }
  return reference;
}

SurfaceError surface_error(const geometry::TriangleMesh& organ, const std::vector<Vec3>& reference,
                           const deform::Indentation& press,
                           const std::optional<geometry::Support>& support) {
  deform::SurfaceDeformer deformer(organ, deform::prepare_response(organ, support));
  std::vector<Vec3> shown;
  deformer.deform(model::FalloffRatios{}, {&press, 1}, shown);
  std::vector<double> area(organ.vertices.size(), 0.0);
  for (const geometry::Triangle& t : organ.triangles)
    for (const std::int32_t v : t) area[at(v)] += geometry::area_vector_doubled(organ, t).norm() / 6.0;
  SurfaceError error;
  double all = 0.0;
  double moves = 0.0;
  double squares = 0.0;
  for (std::size_t v = 0; v < organ.vertices.size(); ++v) {
    const double apart = (shown[v] - organ.vertices[v] - reference[v]).norm();
    error.at.push_back(apart);
    all += area[v];
    if (reference[v].norm() <= kMoves * press.depth) continue;
    moves += area[v];
    squares += area[v] * apart * apart;
    if (apart <= error.largest) continue;
    error.largest = apart;
    error.where = organ.vertices[v];
  }
  if (!(moves > 0.0))
    throw InputError("the reference: moves nowhere by more than 2 % of the press's depth, must move");
  error.rms = std::sqrt(squares / moves);
  error.compared = moves / all;
  return error;
}

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

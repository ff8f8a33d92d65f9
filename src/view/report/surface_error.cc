#include "view/report/surface_error.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/text.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::report {
namespace {

constexpr double kSamePlace = 0.01e-3;  // m, between a vertex and its row
constexpr double kMoves = 0.02;         // of the depth

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

}  // namespace palpate::report

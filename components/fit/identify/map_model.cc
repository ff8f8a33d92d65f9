#include "fit/identify/map_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/Eigenvalues>

#include "io/system/csv_table.h"
#include "palpate/units.h"

#include "fit/identify/map_fit.h"
#include "fit/identify/plausible_specimen.h"

namespace palpate::identify {

MapFrame::MapFrame(std::span<const MapRow> rows) {
  Vec3 mean_normal = Vec3::Zero();
  for (const MapRow& row : rows) {
    middle += row.point / static_cast<double>(rows.size());
    mean_normal += row.normal;
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const MapRow& row : rows) spread += (row.point - middle) * (row.point - middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);  // ascending
  normal = mean_normal.norm() > 1e-9 ? Vec3(mean_normal.normalized()) : Vec3(axes.eigenvectors().col(0));
  if (mean_normal.norm() <= 1e-9 && normal.z() < 0.0) normal = -normal;
  along = axes.eigenvectors().col(2) - axes.eigenvectors().col(2).dot(normal) * normal;
  along.normalize();
  across = normal.cross(along);
  for (const MapRow& row : rows) {
    const Vec3 at = local(row.point);
    extent = std::max({extent, std::abs(at.x()), std::abs(at.y())});
  }
}

MapModel::MapModel(std::span<const MapRow> fitted, double tip_radius, std::size_t map_terms)
    : frame_(fitted), tip_radius_(tip_radius), map_terms_(map_terms) {
  std::set<int> known;
  for (const MapRow& row : fitted) {
    if (!known.insert(row.probe).second) continue;
    points_.push_back(frame_.local(row.point));
    const Vec3 normal = row.normal.norm() > 1e-9 ? Vec3(row.normal.normalized()) : frame_.normal;
    normals_.emplace_back(normal.dot(frame_.along), normal.dot(frame_.across), normal.dot(frame_.normal));
  }
}

/// The surface above (x, y) in the map's frame: the mean of the tangent planes of the probes, with weights
/// that fall with the fourth power of the distance.
MapModel::Foot MapModel::foot(double x, double y) const {
  constexpr double kSoft = 0.5e-6;  // m^2
  double total = 0.0;
  double height = 0.0;
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double dx = x - points_[i].x();
    const double dy = y - points_[i].y();
    const double squared = dx * dx + dy * dy + kSoft;
    const double weight = 1.0 / (squared * squared);
    total += weight;
    normal += weight * normals_[i];
    height += weight * (points_[i].z() - (normals_[i].x() * dx + normals_[i].y() * dy) / normals_[i].z());
  }
  return {{x, y, height / total}, normal.normalized()};
}

double MapModel::background(std::span<const double> values, const MapRow& row) const {
  const Vec3 at = frame_.local(row.point) / frame_.extent;
  const std::array<double, 5> powers{at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y()};
  double logarithm = values[0];
  for (std::size_t i = 0; i + 1 < map_terms_; ++i) logarithm += values[kMapTissue + i] * powers[i];
  return std::exp(logarithm) * std::pow(row.depth / kMillimetre + values[2], values[1]);
}

LumpFactor factor_of(std::span<const PlacedLump> lumps, const model::PressedTip& tip, const Vec3& at) {
  LumpFactor made;
  for (const PlacedLump& one : lumps) {
    const double square = std::max(0.0, (at - one.centre).squaredNorm() - one.depth_squared);
    const model::InclusionLaw::Extra extra = one.law.at(tip, square);
    made.value *= 1.0 + extra.energy;
    made.by_depth += extra.by_depth / (1.0 + extra.energy);
  }
  if (made.value > model::kUncappedFactor) {
    const model::CappedFactor capped = model::cap_factor(made.value);
    made.by_depth *= capped.slope * made.value / capped.value;
    made.value = capped.value;
  }
  return made;
}

std::vector<double> MapModel::forces(std::span<const double> values, std::span<const MapRow> rows) const {
  std::vector<PlacedLump> placed;
  for (std::size_t i = first_inclusion(); i + kMapInclusion <= values.size(); i += kMapInclusion) {
    const double h = values[i + 2] * kMillimetre;
    const Foot above = foot(values[i] * kMillimetre, values[i + 1] * kMillimetre);
    placed.push_back({above.point - h * above.normal, h * h,
                      model::InclusionLaw(h * std::exp(values[i + 3]), h, std::exp(values[i + 4]))});
  }
  std::vector<double> forces;
  forces.reserve(rows.size());
  for (const MapRow& row : rows) {
    const double uniform = background(values, row);
    const double depth = row.depth + values[2] * kMillimetre;
    const double energy = uniform * depth / (values[1] + 1.0);  // the integral of D^p
    const model::PressedTip tip(tip_radius_, depth);
    const Vec3 at = frame_.local(row.point);
    const LumpFactor lumps = factor_of(placed, tip, at);
    forces.push_back(lumps.value * (uniform + energy * lumps.by_depth));
  }
  return forces;
}

Vec3 MapModel::outside(const Vec3& local) const {
  return frame_.middle + local.x() * frame_.along + local.y() * frame_.across + local.z() * frame_.normal;
}

double MapModel::depth_below(const Vec3& point) const {
  constexpr int kSteps = 8;  // towards the foot of the perpendicular; each is shorter by the surface's slope
  const Vec3 at = frame_.local(point);
  Foot top = foot(at.x(), at.y());
  double depth = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    depth = (top.point - at).dot(top.normal);
    const Vec3 next = at + depth * top.normal;
    top = foot(next.x(), next.y());
  }
  return depth;
}

Vec3 MapModel::centre(std::span<const double> inclusion) const {
  const Foot top = foot(inclusion[0] * kMillimetre, inclusion[1] * kMillimetre);
  return outside(top.point - inclusion[2] * kMillimetre * top.normal);
}

Vec3 MapModel::above(std::span<const double> inclusion) const {
  return outside(foot(inclusion[0] * kMillimetre, inclusion[1] * kMillimetre).point);
}

std::vector<MapRow> read_map(const std::filesystem::path& file) {
  enum Column : std::size_t { kProbe, kX, kY, kZ, kNx, kNy, kNz, kDepth, kForce };
  CsvTable table(file,
                 {{"probe"},
                  {"x_mm"},
                  {"y_mm"},
                  {"z_mm"},
                  {"nx", false},
                  {"ny", false},
                  {"nz", false},
                  {"depth_mm"},
                  {"force_N"}},
                 1e9);
  std::vector<MapRow> rows;
  while (table.next_row()) {
    const double probe = table.number(kProbe);
    if (probe != std::floor(probe) || !(std::abs(probe) < 1e9)) {
      table.fail(kProbe, "must be a whole number, the same in all rows of a probe");
    }
    if (const double force = std::abs(table.number(kForce)); force > kForceRange.possible.high) {
      table.fail(kForce,
                 limit_text(kForceRange, force) + column_question(kForceRange, force, "force_N", 1.0));
    }
    if (const double depth = table.number(kDepth) * kMillimetre; depth > kDepthRange.possible.high) {
      table.fail(kDepth, limit_text(kDepthRange, depth) +
                             column_question(kDepthRange, depth, "depth_mm", kMillimetre));
    }
    rows.push_back({static_cast<int>(probe),
                    Vec3(table.number(kX), table.number(kY), table.number(kZ)) * kMillimetre,
                    Vec3(table.number(kNx), table.number(kNy), table.number(kNz)),
                    table.number(kDepth) * kMillimetre, table.number(kForce)});
    if (rows.back().depth < -1e-3) table.fail(kDepth, "must be the depth below the surface, not negative");
    rows.back().depth = std::max(0.0, rows.back().depth);
  }
  return rows;
}

}  // namespace palpate::identify

#include "fit/identify/map_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/Eigenvalues>

#include "core/base/parallel.h"
#include "io/system/csv_table.h"
#include "palpate/units.h"

#include "fit/identify/map_fit.h"
#include "fit/identify/map_problem.h"
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

std::array<double, 5> MapModel::powers_at(const MapRow& row) const {
  const Vec3 at = frame_.local(row.point) / frame_.extent;
  return {at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y()};
}

PlacedLump MapModel::placed(std::span<const double> inclusion) const {
  const double h = inclusion[2] * kMillimetre;
  const Foot above = foot(inclusion[0] * kMillimetre, inclusion[1] * kMillimetre);
  return {above.point - h * above.normal, h * h,
          model::InclusionLaw(h * std::exp(inclusion[3]), h, std::exp(inclusion[4]))};
}

double MapModel::background(std::span<const double> values, const MapRow& row) const {
  const std::array<double, 5> powers = powers_at(row);
  double logarithm = values[0];
  for (std::size_t i = 0; i + 1 < map_terms_; ++i) logarithm += values[kMapTissue + i] * powers[i];
  return std::exp(logarithm) * std::pow(row.depth / kMillimetre + values[2], values[1]);
}

namespace {

/// An inclusion, the laws of its depth, radius or ratio a little larger, and how the square of the distance
/// from it changes with its place and depth.
struct MovedLump {
  PlacedLump here;
  std::array<model::InclusionLaw, 3> laws;
  std::array<Vec3, 3> centre_by{};  // d(centre) by x, y and h
  double square_by_depth = 0.0;     // d(h^2) by h
  double length = 0.0;              // mm, by which h is larger in the first of the laws
};

double square_of(const PlacedLump& lump, const Vec3& at) {
  return std::max(0.0, (at - lump.centre).squaredNorm() - lump.depth_squared);
}

model::InclusionLaw::Extra extra_of(const PlacedLump& lump, const model::PressedTip& tip, const Vec3& at) {
  return lump.law.at(tip, square_of(lump, at));
}

/// The factor 1 + e of an inclusion at a point of the surface, its rise d(ln factor)/dD, and how the
/// logarithm of the factor and the rise change with the inclusion's numbers and, to the deeper tip, with D.
struct LumpSlopes {
  double factor = 1.0;
  double rise = 0.0;
  double rise_by_depth = 0.0;
  std::array<double, kMapInclusion> logarithm_by{}, rise_by{};
};

LumpSlopes slopes_of(const MovedLump& lump, const model::PressedTip& tip, const model::PressedTip& deeper,
                     const Vec3& at, double step, double deepening) {
  const double square = square_of(lump.here, at);
  const model::InclusionLaw::Slopes law = lump.here.law.slopes(tip, square, deeper, lump.laws);
  LumpSlopes made;
  made.factor = 1.0 + law.here.energy;
  const double inverse = 1.0 / made.factor;
  made.rise = law.here.by_depth * inverse;
  made.rise_by_depth = law.by_depth_twice / deepening * inverse - made.rise * made.rise;
  const auto add = [&](std::size_t k, double energy, double by_depth) {
    made.logarithm_by.at(k) += energy * inverse;
    made.rise_by.at(k) += (by_depth - made.rise * energy) * inverse;
  };
  if (square > 0.0) {  // else the centre's foot is here, and the square does not change with the place
    for (std::size_t k = 0; k < lump.centre_by.size(); ++k) {
      const double further = -2.0 * (at - lump.here.centre).dot(lump.centre_by.at(k)) -
                             (k == kDepthBelow ? lump.square_by_depth : 0.0);
      add(k, law.here.by_square * further, law.by_depth_and_square * further);
    }
  }
  for (std::size_t k = 0; k < lump.laws.size(); ++k) {
    const double unit = k == 0 ? lump.length : step;
    add(k + kDepthBelow, law.by_law.at(k).energy / unit, law.by_law.at(k).by_depth / unit);
  }
  return made;
}

}  // namespace

LumpFactor factor_of(std::span<const PlacedLump> lumps, const model::PressedTip& tip, const Vec3& at) {
  LumpFactor made;
  for (const PlacedLump& one : lumps) {
    const model::InclusionLaw::Extra extra = extra_of(one, tip, at);
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

constexpr std::size_t kGrain = 512;  // rows

std::vector<double> MapModel::forces(std::span<const double> values, std::span<const MapRow> rows) const {
  std::vector<PlacedLump> lumps_at;
  for (std::size_t i = first_inclusion(); i + kMapInclusion <= values.size(); i += kMapInclusion) {
    lumps_at.push_back(placed(values.subspan(i, kMapInclusion)));
  }
  std::vector<double> forces(rows.size());
  const auto set_force = [&](std::size_t r) {
    const MapRow& row = rows[r];
    const double uniform = background(values, row);
    const double depth = row.depth + values[2] * kMillimetre;
    const double energy = uniform * depth / (values[1] + 1.0);  // the integral of D^p
    const model::PressedTip tip(tip_radius_, depth);
    const Vec3 at = frame_.local(row.point);
    const LumpFactor lumps = factor_of(lumps_at, tip, at);
    forces[r] = lumps.value * (uniform + energy * lumps.by_depth);
  };
  for_ranges(rows.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) set_force(r);
  });
  return forces;
}

std::vector<double> MapModel::slopes(std::span<const double> values, std::span<const MapRow> rows) const {
  constexpr double kPlaceStep = 1e-5;  // mm, of central differences
  constexpr double kStep = 1e-7;       // of logarithms, of the depth and of h^2: forward differences
  constexpr double kRoom = model::kLargestEnergyFactor - model::kUncappedFactor;
  const std::size_t columns = values.size();
  const std::size_t first = first_inclusion();
  std::vector<MovedLump> lumps;
  for (std::size_t i = first; i + kMapInclusion <= columns; i += kMapInclusion) {
    const auto own = values.subspan(i, kMapInclusion);
    const double h = own[2] * kMillimetre;
    const double radius = h * std::exp(own[3]);
    const double ratio = std::exp(own[4]);
    MovedLump& lump = lumps.emplace_back();
    lump.here = placed(own);
    lump.laws = {model::InclusionLaw(radius * (1.0 + kStep), h * (1.0 + kStep), ratio),
                 model::InclusionLaw(radius * (1.0 + kStep), h, ratio),
                 model::InclusionLaw(radius, h, ratio * (1.0 + kStep))};
    for (std::size_t k = 0; k < lump.centre_by.size(); ++k) {
      std::array<double, kMapInclusion> above{};
      std::copy(own.begin(), own.end(), above.begin());
      std::array<double, kMapInclusion> below = above;
      above.at(k) += kPlaceStep;
      below.at(k) -= kPlaceStep;
      lump.centre_by.at(k) = (placed(above).centre - placed(below).centre) / (2.0 * kPlaceStep);
    }
    lump.square_by_depth = 2.0 * h * kMillimetre;
    lump.length = own[2] * kStep;
  }
  std::vector<double> out(rows.size() * columns, 0.0);
  const auto add_row = [&](std::size_t r, std::vector<LumpSlopes>& by) {
    const std::span<double> line(out.data() + r * columns, columns);
    const MapRow& row = rows[r];
    const double depth = row.depth + values[2] * kMillimetre;
    if (!(depth > 0.0)) return;  // no force, whatever the values
    const double uniform = background(values, row);
    const double energy = uniform * depth / (values[1] + 1.0);
    const Vec3 at = frame_.local(row.point);
    const model::PressedTip tip(tip_radius_, depth);
    const model::PressedTip deeper(tip_radius_, depth * (1.0 + kStep));
    // F = V (u + E B) = V u + E S Q P, with P the product of the factors, V(P) the capped one, Q = dV/dP and
    // S = d(ln P)/dD.
    double product = 1.0;
    double rise = 0.0;           // S
    double rise_by_depth = 0.0;  // dS/dD
    for (std::size_t j = 0; j < lumps.size(); ++j) {
      by[j] = slopes_of(lumps[j], tip, deeper, at, kStep, kStep * depth);
      product *= by[j].factor;
      rise += by[j].rise;
      rise_by_depth += by[j].rise_by_depth;
    }
    const model::CappedFactor capped = model::cap_factor(product);
    const double value = capped.value;
    const double bend = product > model::kUncappedFactor  // dQ/dP
                            ? -2.0 * capped.slope * (value - model::kUncappedFactor) / (kRoom * kRoom)
                            : 0.0;
    // by the logarithm of P, and by S
    const double by_product =
        product * (uniform * capped.slope + energy * rise * (capped.slope + product * bend));
    const double by_rise = energy * capped.slope * product;
    const double force = uniform * value + by_rise * rise;
    line[0] = force;
    line[1] = force * std::log(depth / kMillimetre) - by_rise * rise / (values[1] + 1.0);
    line[2] = kMillimetre * (value * uniform * values[1] / depth + uniform * capped.slope * product * rise +
                             by_product * rise + by_rise * rise_by_depth);
    const std::array<double, 5> powers = powers_at(row);
    for (std::size_t i = 0; i + 1 < map_terms_; ++i) line[kMapTissue + i] = force * powers.at(i);
    for (std::size_t j = 0; j < lumps.size(); ++j) {
      for (std::size_t k = 0; k < kMapInclusion; ++k) {
        line[first + j * kMapInclusion + k] =
            by_product * by[j].logarithm_by.at(k) + by_rise * by[j].rise_by.at(k);
      }
    }
  };
  for_ranges(rows.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<LumpSlopes> by(lumps.size());
    for (std::size_t r = begin; r < end; ++r) add_row(r, by);
  });
  return out;
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

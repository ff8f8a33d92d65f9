#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "palpate/inclusion.h"

namespace palpate::identify {

/// One row of a map: a probe at a point of a surface, pressed along the surface's normal.
struct MapRow {
  int probe = 0;
  Vec3 point = Vec3::Zero();   // of the surface at rest [m]
  Vec3 normal = Vec3::Zero();  // outward; zero where the file has none
  double depth = 0.0;          // [m]
  double force = 0.0;          // [N]
};

/// [setup] Reads a map: columns probe, x_mm, y_mm, z_mm, depth_mm, force_N, and optionally nx, ny, nz.
/// @throws InputError that names file, line, column and value
[[nodiscard]] std::vector<MapRow> read_map(const std::filesystem::path& file);

struct MapSettings {
  double tip_radius = 5e-3;        // of the ball [m]
  std::size_t max_inclusions = 6;  // at most model::kMaxInclusions
  bool profiles = true;  // intervals of radius and ratio; without them both are as the fit found them
};

/// An inclusion found in a map.
struct FoundInclusion {
  // Each a value and its 95 % interval, by the covariance of the fit: centre x, y, z and depth h [m].
  std::array<Estimate, 3> centre{};
  Estimate depth{};
  Estimate rise{};    // of the force above it at the largest depth, relative to the background tissue
  Estimate radius{};  // a [m], with its interval by profile likelihood
  Estimate ratio{};   // m, likewise
  // The values that ended at a bound of the search, by their keys in JSON ("place": the edge of the map).
  // Such an inclusion is not determined: all its intervals are infinite.
  std::vector<std::string> at_bounds{};
};

/// The background tissue: F(D, x) = k(x) K (D + D_0)^p, with ln k a polynomial over the surface.
struct MapFit {
  double stiffness = 0.0;     // K [N/m^p] at the middle of the map
  double exponent = 1.0;      // p
  double first_depth = 0.0;   // D_0 [m], the depth at which the measurement began to count
  std::size_t map_terms = 1;  // of the polynomial: 1, 3 or 6
  std::vector<FoundInclusion> inclusions;
  double error = 0.0;          // RMS of the residuals [N]
  double uniform_error = 0.0;  // RMS of the residuals of the background tissue alone [N]
  double range = 0.0;          // of the measured force [N]
  std::size_t rows = 0;
  std::size_t probes = 0;
  std::vector<model::StiffnessPoint> stiffness_map;  // one point a probe: factor of its force
  std::vector<double> values;                        // parameters, for map_force()
};

using MapProgress = std::function<void(double, const std::string&)>;

/// [setup] Fits background tissue and inclusions. An inclusion is kept if it lowers the Bayesian information
/// criterion by more than 10 and rises above the noise. @throws InputError for fewer than 8 probes or 30 rows
[[nodiscard]] MapFit fit_map(const std::vector<MapRow>& rows, const MapSettings& settings,
                             const MapProgress& progress = {});

/// The fewest probes and rows of a map.
inline constexpr std::size_t kFewestProbes = 8;
inline constexpr std::size_t kFewestMapRows = 30;

/// [setup] fit_map() in two steps: the fit with the values of its inclusions, then their intervals.
[[nodiscard]] MapFit search_map(const std::vector<MapRow>& rows, const MapSettings& settings,
                                const MapProgress& progress = {});
void add_intervals(const std::vector<MapRow>& rows, const MapSettings& settings, MapFit& fit,
                   const MapProgress& progress = {});

}  // namespace palpate::identify

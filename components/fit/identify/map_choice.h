#pragma once
#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "palpate/inclusion.h"

#include "fit/identify/map_fit.h"

namespace palpate::identify {

/// What may describe a map, from the simplest: the background tissue, which varies at most as a quadratic;
/// with inclusions; with a factor of the stiffness at each probe, and a smooth function between them; with
/// both.
enum class MapKind : std::size_t { kTissue, kLumps, kStiffness, kLumpsAndStiffness };
inline constexpr std::size_t kMapKinds = 4;

/// [any] "tissue", "lumps", "map" or "lumps and map".
[[nodiscard]] const char* to_string(MapKind kind) noexcept;

/// All that predicts the force of a probe.
struct FittedMap {
  double tip_radius = 0.0;                                   // of the ball [m]
  double first_depth = 0.0;                                  // D_0 [m], added to the depth of a row
  std::function<std::pair<double, double>(double)> uniform;  // force [N] and energy [J] at D + D_0
  std::vector<model::StiffnessPoint> stiffness;              // factor at each probe; empty: 1 everywhere
  std::vector<model::Inclusion> inclusions;
};

/// [setup] Forces [N] at the rows. @param surface rows that give the surface, not empty
[[nodiscard]] std::vector<double> predicted_forces(const FittedMap& map, std::span<const MapRow> rows,
                                                   std::span<const MapRow> surface);

/// A map that is described by what predicts its probes best.
struct DescribedMap {
  MapFit fit;           // of what won; its stiffness_map is the factor of the tissue alone at each probe
  FittedMap predictor;  // of what won
  MapKind won = MapKind::kLumps;
  std::size_t held_out = 0;                    // probes; 0: the map has too few for it
  std::array<double, kMapKinds> held_error{};  // RMS error of each kind at the held-out probes [N]
  std::vector<FoundInclusion> left_out;        // inclusions that predict no better, without intervals
  std::vector<std::string> warnings;           // of check_map(), and where the background ended at a bound
};

/// [setup] Fits tissue, inclusions and stiffness map to every second probe, predicts the others, and fits to
/// all probes what predicts best. Inclusions must predict better than the tissue alone by 5 %, and a
/// stiffness map without them better than they by a fifth. A map of fewer than 16 probes has none held out;
/// its inclusions are then as fit_map() finds them. @throws InputError as fit_map()
[[nodiscard]] DescribedMap describe_map(const std::vector<MapRow>& rows, const MapSettings& settings,
                                        const MapProgress& progress = {});

/// The factor k of a tissue's stiffness over a surface, between points that give it. On a plane ln k is the
/// function with the least
///
///     sum_i (ln k_i - ln k(x_i))^2 / tolerance + integral |grad ln k|^2 + l^2 (Laplacian ln k)^2,   l = 10
///     mm,
///
/// which contact::StiffnessMap computes on an organ's mesh. Its kernel is -(ln(r/l) + K_0(r/l)) / 2 pi.
class FactorField final {
 public:
  /// The factor is 1 everywhere.
  FactorField() = default;
  /// [setup] @param tolerance >= 0, how little the points hold the function; by default as in an organ
  explicit FactorField(std::span<const model::StiffnessPoint> points, double tolerance = kOrganTolerance)
      : FactorField(points, tolerance, kernels_of(points)) {}
  /// [setup] The same. @param kernels kernels_of(points)
  FactorField(std::span<const model::StiffnessPoint> points, double tolerance,
              const Eigen::MatrixXd& kernels);

  /// [setup] The kernels between the points that a field uses.
  [[nodiscard]] static Eigen::MatrixXd kernels_of(std::span<const model::StiffnessPoint> points);

  /// [setup] The factor at a point.
  [[nodiscard]] double at(const Vec3& point) const;
  /// [setup] The factor at point i that the other points alone give.
  [[nodiscard]] double without(std::size_t i) const { return without_[i]; }

  static constexpr double kOrganTolerance = 1e-4;   // the inverse weight of a point in contact::StiffnessMap
  static constexpr std::size_t kMostPoints = 1500;  // of more, as many at even steps are used

 private:
  std::vector<Vec3> points_;
  Eigen::VectorXd weights_;  // of the points' kernels, then the constant
  std::vector<double> own_;  // the factors at the points
  std::vector<double> without_;
};

}  // namespace palpate::identify

#pragma once
#include <array>
#include <span>
#include <vector>

#include "palpate/inclusion.h"

#include "fit/identify/map_fit.h"

namespace palpate::identify {

inline constexpr std::size_t kMapTissue = 3;     // ln K at 1 mm [ln N], p, D_0 [mm]
inline constexpr std::size_t kMapInclusion = 5;  // x, y [mm, in the plane of the map], h [mm], ln(a/h), ln m

/// The frame of a map: its middle, its mean normal and two directions along the surface.
struct MapFrame {
  Vec3 middle = Vec3::Zero();
  Vec3 along = Vec3::UnitX(), across = Vec3::UnitY(), normal = Vec3::UnitZ();
  double extent = 1e-3;  // [m], half the largest width of the map

  /// [setup] @param rows not empty
  explicit MapFrame(std::span<const MapRow> rows);
  [[nodiscard]] Vec3 local(const Vec3& point) const {
    const Vec3 from = point - middle;
    return {from.dot(along), from.dot(across), from.dot(normal)};
  }
};

/// An inclusion in the frame of a map.
struct PlacedLump {
  Vec3 centre = Vec3::Zero();  // [m]
  double depth_squared = 0.0;  // h^2 [m^2]
  model::InclusionLaw law;
};

/// The factor of the tissue's energy that inclusions give, capped, and d(ln factor)/dD [1/m].
struct LumpFactor {
  double value = 1.0;
  double by_depth = 0.0;
};

/// [any] @param at a point of the surface, in the frame of the map [m]
[[nodiscard]] LumpFactor factor_of(std::span<const PlacedLump> lumps, const model::PressedTip& tip,
                                   const Vec3& at);

/// The model of a map: forces of its rows from a vector of parameters, first those of the tissue and of the
/// polynomial ln k, then kMapInclusion per inclusion.
class MapModel final {
 public:
  /// @param fitted the rows that give frame and surface @param map_terms 1, 3 or 6
  MapModel(std::span<const MapRow> fitted, double tip_radius, std::size_t map_terms);

  [[nodiscard]] std::size_t size(std::size_t inclusions) const {
    return kMapTissue + map_terms_ - 1 + kMapInclusion * inclusions;
  }
  [[nodiscard]] std::size_t first_inclusion() const { return size(0); }
  [[nodiscard]] const MapFrame& frame() const { return frame_; }

  /// Force [N] of the background tissue alone at a row.
  [[nodiscard]] double background(std::span<const double> values, const MapRow& row) const;
  /// Forces [N] at the rows, with all inclusions.
  [[nodiscard]] std::vector<double> forces(std::span<const double> values,
                                           std::span<const MapRow> rows) const;
  /// Derivatives of the forces by the values, in row-major order: one line per row. They are exact but for
  /// differences of an inclusion's law alone, of its depth, radius and ratio, of s^2 and of the tip's depth.
  [[nodiscard]] std::vector<double> slopes(std::span<const double> values,
                                           std::span<const MapRow> rows) const;
  /// Depth [m] of a point below the nearest surface.
  [[nodiscard]] double depth_below(const Vec3& point) const;
  /// The centre of an inclusion, and the point of the surface above it [m].
  [[nodiscard]] Vec3 centre(std::span<const double> inclusion) const;
  [[nodiscard]] Vec3 above(std::span<const double> inclusion) const;

 private:
  struct Foot {
    Vec3 point, normal;
  };
  [[nodiscard]] Foot foot(double x, double y) const;
  [[nodiscard]] PlacedLump placed(std::span<const double> inclusion) const;
  /// Powers of a point that the polynomial ln k has beside its constant.
  [[nodiscard]] std::array<double, 5> powers_at(const MapRow& row) const;
  [[nodiscard]] Vec3 outside(const Vec3& local) const;  // from the map's frame

  MapFrame frame_;
  double tip_radius_;
  std::size_t map_terms_;
  std::vector<Vec3> points_;   // of the probes, in the map's frame [m]
  std::vector<Vec3> normals_;  // in the map's frame
};

}  // namespace palpate::identify

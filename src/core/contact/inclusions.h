#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "core/contact/organ_surface.h"
#include "palpate/inclusion.h"

namespace palpate::contact {

/// An inclusion in the organ. Plain data.
struct PlacedInclusion {
  /// The null inclusion: ratio 1.
  PlacedInclusion() = default;
  /// [setup] @throws ParameterError as model::validate(); InputError when the sphere is not inside the organ
  PlacedInclusion(const OrganSurface& surface, const model::Inclusion& inclusion);

  model::Inclusion inclusion{};
  double depth = 0.0;              // h of the centre below the nearest surface point, at rest [m]
  Vec3 outward_S = Vec3::UnitZ();  // from the centre to that point
};

/// An inclusion in this tick.
struct InclusionNow {
  Vec3 centre_S = Vec3::Zero();
  double depth_squared = 0.0;  // h^2 [m^2]
  model::InclusionLaw law;
  double radius = 0.0;  // [m]
  double ratio = 1.0;
};

/// The inclusions of an organ.
class InclusionState final {
 public:
  /// [setup] Call at most model::kMaxInclusions times.
  void add(const PlacedInclusion& placed);
  /// [rt] @param index below size()
  void replace(std::size_t index, const PlacedInclusion& placed) noexcept;
  /// [rt] Moves the inclusions that pulse to their places at a time [s] after tick 0.
  void move_to(double time) noexcept;

  [[nodiscard]] std::span<const InclusionNow> now() const noexcept { return std::span(now_).first(count_); }
  [[nodiscard]] std::span<const PlacedInclusion> at_rest() const noexcept {
    return std::span(placed_).first(count_);
  }

 private:
  void update(std::size_t index, double time) noexcept;

  std::array<PlacedInclusion, model::kMaxInclusions> placed_{};
  std::array<InclusionNow, model::kMaxInclusions> now_{};
  std::size_t count_ = 0;
};

}  // namespace palpate::contact

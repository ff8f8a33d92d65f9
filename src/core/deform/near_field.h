#pragma once
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "core/deform/float4x3.h"
#include "core/deform/half_space.h"
#include "palpate/pose.h"

namespace palpate::deform {

/// A displacement and its derivative by place.
struct PlaceMotion {
  Eigen::Vector3f displacement = Eigen::Vector3f::Zero();  // [m]
  Eigen::Matrix3f gradient = Eigen::Matrix3f::Zero();
};

/// The motions of four places.
struct FourMotions {
  Float4x3 displacement;
  std::array<Float4x3, 3> gradient;  // derivatives along the axes

  /// [any] The motion of the first.
  [[nodiscard]] PlaceMotion first() const noexcept;
};

/// A contact within this of one of the last picture is the same contact [m].
inline constexpr float kSameContact = 8e-3F;

/// What the cells of a whole organ miss near one contact: the half-space's field under a contact of radius a,
/// less its field under the same force spread over the length h of a cell. It falls with the third power of
/// the distance and fades out between 2 h and 3.5 h.
class NearField final {
 public:
  /// A force, divided by 4 pi G.
  struct Force {
    float normal = 0.0F;                             // inwards
    Eigen::Vector3f side = Eigen::Vector3f::Zero();  // along the surface
  };

  /// [any] Places the contact. @param inward unit normal
  void place(const Vec3& point, const Vec3& inward) noexcept;
  /// [any] @param radius of the contact [m] @param spread radius over which the cells spread its force [m]
  /// @param cell edge of a cell [m]
  void set_terms(double radius, double spread, double cell) noexcept;
  /// [any] @param force [N at Young's modulus 1]
  void set_force(const Vec3& force) noexcept { force_ = part_of(force); }
  [[nodiscard]] Force part_of(const Vec3& force) const noexcept;

  [[nodiscard]] const Eigen::Vector3f& point() const noexcept { return point_; }
  /// [any] Distance [m] from which nothing moves.
  [[nodiscard]] float end() const noexcept { return per_metre_ > 0.0F ? kEntries / per_metre_ : 0.0F; }
  /// [any] Adds the motions of four places under the contact's force, or under another one.
  void add(const Float4x3& places, FourMotions& motions) const noexcept { add(places, force_, motions); }
  void add(const Float4x3& places, const Force& force, FourMotions& motions) const noexcept;

 private:
  friend class NearFieldChange;
  static constexpr std::size_t kEntries = 96;
  using Terms = HalfSpaceTerms<float>;

  Eigen::Vector3f point_ = Eigen::Vector3f::Zero();   // [m]
  Eigen::Vector3f inward_ = Eigen::Vector3f::Zero();  // unit
  Force force_;
  float per_metre_ = 0.0F;                   // entries
  std::array<Terms, kEntries + 2> terms_{};  // by the distance from the point; the last two are 0
};

/// Bounds how far the change of a near field between two pictures moves vertices, as a function of their
/// distance from the contact. Each entry is the maximum over all larger distances.
class NearFieldChange final {
 public:
  /// [any] @param before, now of one contact, with cells of the same size; null: there was or is none
  void set(const NearField* before, const NearField* now) noexcept;
  /// [any] Where distances count from.
  [[nodiscard]] const Eigen::Vector3f& point() const noexcept { return point_; }
  /// [any] Bound of the motion [m] of vertices at least this far [m] from point().
  [[nodiscard]] float at(float distance) const noexcept;

 private:
  Eigen::Vector3f point_ = Eigen::Vector3f::Zero();
  float drift_ = 0.0F;  // of the contact [m]
  float per_metre_ = 0.0F;
  std::array<float, NearField::kEntries + 1> bounds_{};
};

}  // namespace palpate::deform

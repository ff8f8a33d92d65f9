#pragma once

#include "palpate/mesh.h"

namespace palpate::geometry {

/// Value and gradient of a scalar field at a point: negative inside a solid, 0 on its surface, approximately
/// the distance [m] near it.
struct FieldValue {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// [setup] Union of two solids, rounded over a width `blend` [m] (0: a sharp crease). The cubic smooth
/// minimum: it differs from the minimum only where the values differ by less than `blend`, by blend / 6 at
/// the seam. The surface's curvature is continuous where the blend begins.
[[nodiscard]] FieldValue unite(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// [setup] Smooth union with a furrow of `depth` [m] along the seam, where the two values differ by less than
/// `width` [m].
[[nodiscard]] FieldValue unite_with_furrow(const FieldValue& a, const FieldValue& b, double width,
                                           double depth) noexcept;

/// [setup] Intersection of two solids, with its edge rounded over `blend` [m].
[[nodiscard]] FieldValue intersect(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// [setup] Difference `a` minus `b`, with its edge rounded over `blend` [m].
[[nodiscard]] FieldValue subtract(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// An ellipsoid with its own axes.
struct Ellipsoid {
  Vec3 middle = Vec3::Zero();     // [m]
  Vec3 half_axes = Vec3::Ones();  // [m]
  Mat3 axes = Mat3::Identity();   // columns: unit directions of the half axes

  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;
};

/// [setup] An ellipsoid whose first half axis is along `first`, the second perpendicular to it towards
/// `second`, the third perpendicular to both.
[[nodiscard]] Ellipsoid ellipsoid(const Vec3& middle, const Vec3& half_axes, const Vec3& first,
                                  const Vec3& second) noexcept;

/// A solid defined by its field; sampled many times, always in the same order.
class ImplicitSolid {
 public:
  virtual ~ImplicitSolid() = default;
  [[nodiscard]] virtual FieldValue at(const Vec3& p) const noexcept = 0;
};

/// [setup] The solid's surface by marching tetrahedra on a grid of `spacing` [m] in `box`: closed, manifold,
/// oriented outwards. Its badly shaped triangles must be remeshed (remesh.h). A solid that reaches the faces
/// of the box is open there.
[[nodiscard]] TriangleMesh polygonise(const ImplicitSolid& solid, const Bounds& box, double spacing);

}  // namespace palpate::geometry

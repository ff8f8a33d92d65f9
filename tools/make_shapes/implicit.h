#pragma once
#include <array>
#include <vector>

#include "palpate/mesh.h"

namespace palpate::geometry {

/// Value of a scalar field at a point and its gradient: negative inside a solid, 0 on its surface, about the
/// distance [m] near it.
struct FieldValue {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// [setup] Union of two solids, rounded where they meet over a width `blend` [m] (0: a sharp crease). The
/// cubic smooth minimum: differs from the plain union only where both values differ by less than `blend`, by
/// blend / 6 on the seam; the surface's curvature has no step where the blend begins.
[[nodiscard]] FieldValue unite(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// [setup] Union with a furrow of `depth` [m] along the seam, over a `width` [m] measured by how much nearer
/// one solid is than the other. Smooth.
[[nodiscard]] FieldValue unite_with_furrow(const FieldValue& a, const FieldValue& b, double width,
                                           double depth) noexcept;

/// [setup] Common part of two solids, its edge rounded over `blend` [m].
[[nodiscard]] FieldValue intersect(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// [setup] What is left of `a` without `b`, its edge rounded over `blend` [m].
[[nodiscard]] FieldValue subtract(const FieldValue& a, const FieldValue& b, double blend) noexcept;

/// An ellipsoid with its own axes.
struct Ellipsoid {
  Vec3 middle = Vec3::Zero();     // [m]
  Vec3 half_axes = Vec3::Ones();  // [m]
  Mat3 axes = Mat3::Identity();   // columns: unit directions of the half axes

  [[nodiscard]] FieldValue at(const Vec3& p) const noexcept;
};

/// [setup] An ellipsoid with half axes along `first`, then across it towards `second`, then across both.
[[nodiscard]] Ellipsoid ellipsoid(const Vec3& middle, const Vec3& half_axes, const Vec3& first,
                                  const Vec3& second) noexcept;

/// A solid given by its field; sampled many times, always in the same order.
class ImplicitSolid {
 public:
  virtual ~ImplicitSolid() = default;
  [[nodiscard]] virtual FieldValue at(const Vec3& p) const noexcept = 0;
};

/// [setup] The solid's surface as triangles, by marching tetrahedra on a grid of `spacing` [m] that fills
/// `box`: closed, manifold, turned outwards; badly shaped triangles, to be remeshed (remesh.h). Solids that
/// reach the box's faces are not closed there.
[[nodiscard]] TriangleMesh polygonise(const ImplicitSolid& solid, const Bounds& box, double spacing);

}  // namespace palpate::geometry

#pragma once
// Facets: the pieces over which averaged normals are summed. Used in set-up only.
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/averaged_normals.h"

namespace palpate::contact {

/// The moments of one triangle or of a few small ones. For a centre at u from `centre`, a triangle's sum of
/// 1 - |m - u|^2/h^2 over its three edge midpoints m is 3 - (3 |u|^2 + squares)/h^2 exactly.
struct alignas(64) Facet {
  Vec3 centre = Vec3::Zero();
  Vec3 area = Vec3::Zero();  // twice the area vector [m^2]
  double squares =
      0.0;  // the midpoints' squared distances from `centre`, summed for a triangle, averaged by area
  float reach = 0.0F;          // at least the largest distance of a corner from `centre` [m]
  std::int32_t triangle = -1;  // the facet's triangle, if it is only one
};

/// A surface divided into facets.
class Facets final {
 public:
  /// [setup] Joins connected triangles with similar normals while their facet reaches at most `size` [m] from
  /// its first triangle's centre; 0: one facet per triangle, with the triangle's number and without moments.
  Facets(const SurfaceView& surface, double size);

  [[nodiscard]] std::size_t size() const noexcept { return start_.size() - 1; }
  [[nodiscard]] const Facet& operator[](std::int32_t facet) const noexcept {
    return facets_[static_cast<std::size_t>(facet)];
  }
  /// The facet's triangles.
  [[nodiscard]] std::span<const std::int32_t> triangles(std::int32_t facet) const noexcept {
    return part(triangles_, start_, facet);
  }
  /// Facets that share an edge with this one.
  [[nodiscard]] std::span<const std::int32_t> neighbours(std::int32_t facet) const noexcept {
    return part(neighbours_, first_neighbour_, facet);
  }
  [[nodiscard]] std::int32_t facet_of(std::int32_t triangle) const noexcept {
    return facet_of_[static_cast<std::size_t>(triangle)];
  }

 private:
  [[nodiscard]] static std::span<const std::int32_t> part(const std::vector<std::int32_t>& list,
                                                          const std::vector<std::int32_t>& start,
                                                          std::int32_t i) noexcept {
    const auto first = static_cast<std::size_t>(start[static_cast<std::size_t>(i)]);
    return std::span(list).subspan(first,
                                   static_cast<std::size_t>(start[static_cast<std::size_t>(i) + 1]) - first);
  }
  void grow(const SurfaceView& surface, double size);
  void link(const SurfaceView& surface);

  std::vector<Facet> facets_;
  std::vector<std::int32_t> triangles_;  // by facet
  std::vector<std::int32_t> start_;      // per facet, and the end: start in triangles_
  std::vector<std::int32_t> facet_of_;   // per triangle
  std::vector<std::int32_t> neighbours_;
  std::vector<std::int32_t> first_neighbour_;  // per facet, and the end: start in neighbours_
};

}  // namespace palpate::contact

#pragma once
// Prepared organs that the tests of a program share.
#include <deque>
#include <optional>

#include "core/contact/organ_arrays.h"
#include "palpate/mesh.h"
#include "palpate/preparation.h"

namespace palpate::contact::test {

/// Prepares an organ once for each reference radius. Not for several threads.
inline Preparation prepared_once() {
  struct Prepared {
    geometry::TriangleMesh organ;
    double reference_radius;
    OrganArrays arrays;
  };
  static std::deque<Prepared> all;
  Preparation how;
  how.load = [](const geometry::TriangleMesh& organ, double radius) -> std::optional<OrganArrays> {
    for (const Prepared& one : all) {
      if (one.reference_radius == radius && one.organ.triangles == organ.triangles &&
          one.organ.vertices == organ.vertices)
        return one.arrays;
    }
    return std::nullopt;
  };
  how.store = [](const geometry::TriangleMesh& organ, double radius, const OrganArrays& arrays) {
    all.push_back({organ, radius, arrays});
  };
  return how;
}

}  // namespace palpate::contact::test

#pragma once
// Prepared organs that the tests of a program share.
#include <deque>
#include <memory>
#include <optional>
#include <vector>

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
  class Store final : public OrganStore {
   public:
    [[nodiscard]] std::optional<OrganArrays> load(const geometry::TriangleMesh& organ,
                                                  double radius) const override {
      for (const Prepared& one : all()) {
        if (one.reference_radius == radius && one.organ.triangles == organ.triangles &&
            one.organ.vertices == organ.vertices)
          return one.arrays;
      }
      return std::nullopt;
    }
    void store(const geometry::TriangleMesh& organ, double radius, const OrganArrays& arrays) const override {
      all().push_back({organ, radius, arrays});
    }
    [[nodiscard]] std::optional<ReadOrgan> load_read(const ContentHash&) const override { return {}; }
    void store_read(const ContentHash&, const ReadOrgan&) const override {}
    [[nodiscard]] std::vector<double> load_factors(const ContentHash&) const override { return {}; }
    void store_factors(const ContentHash&, const std::vector<double>&) const override {}
    [[nodiscard]] std::optional<ResponseArrays> load_response(const ContentHash&) const override {
      return {};
    }
    void store_response(const ContentHash&, const ResponseArrays&) const override {}

   private:
    static std::deque<Prepared>& all() {
      static std::deque<Prepared> organs;
      return organs;
    }
  };
  return {.store = std::make_shared<const Store>()};
}

}  // namespace palpate::contact::test

#pragma once
#include <functional>
#include <optional>
#include <string>

namespace palpate::geometry {
struct TriangleMesh;
}

namespace palpate::contact {

struct OrganArrays;

/// How an organ is prepared: by default computed, in silence.
struct Preparation {
  /// Returns the arrays of an earlier preparation of the same organ; nothing when there are none.
  /// scene::use_organ_cache() keeps them in a folder.
  std::function<std::optional<OrganArrays>(const geometry::TriangleMesh& organ, double reference_radius)>
      load = {};
  /// Keeps the arrays that were computed.
  std::function<void(const geometry::TriangleMesh& organ, double reference_radius, const OrganArrays& arrays)>
      store = {};
  /// Called now and then with what is being done and the share of all of it that is done, 0..1; on the thread
  /// that prepares.
  std::function<void(double share, const std::string& what)> progress = {};
};

}  // namespace palpate::contact

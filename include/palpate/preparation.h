#pragma once
#include <functional>
#include <optional>
#include <string>

namespace palpate::geometry {
class SignedDistance;
struct TriangleMesh;
}  // namespace palpate::geometry

namespace palpate::contact {

struct OrganArrays;

/// Options for the preparation of an organ. By default the arrays are computed, and no progress is reported.
struct Preparation {
  /// Returns the stored arrays of this organ, or std::nullopt when it was not prepared before.
  /// scene::use_organ_cache() stores them in a folder.
  std::function<std::optional<OrganArrays>(const geometry::TriangleMesh& organ, double reference_radius)>
      load = {};
  /// Stores the arrays that were computed.
  std::function<void(const geometry::TriangleMesh& organ, double reference_radius, const OrganArrays& arrays)>
      store = {};
  /// Returns the signed distance of the refined organ. By default it is built.
  std::function<geometry::SignedDistance(const geometry::TriangleMesh& refined)> distance = {};
  /// Called repeatedly with the completed fraction of the preparation, 0..1, and a description of the current
  /// step; on the thread that prepares the organ.
  std::function<void(double share, const std::string& what)> progress = {};
};

}  // namespace palpate::contact

#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/scene/toml_reader.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"

namespace palpate::geometry {
class SignedDistance;
}

namespace palpate::scene {

/// The [search] table of a scene, checked except for the room in the organ. SI units.
struct SearchTable {
  SearchSetup setup;
  bool given = false;                // the scene has the table
  std::optional<std::size_t> lumps;  // hidden at random; empty: see hide_inclusions()
  model::Inclusion lump;             // its centre is not set
  double depth = 0.0;                // of a centre below the surface [m]
  std::string where = "search";      // "FILE:LINE: search", for errors
};

/// [setup] The [search] table; without one the defaults. @throws InputError as the other readers
[[nodiscard]] SearchTable read_search(const std::optional<TomlTable>& table);

/// The triangles of an organ that a search covers: those that a tool from above meets first, tilted by at
/// most 60 degrees.
class SearchArea final {
 public:
  /// [setup] @param distance of `organ`
  SearchArea(const geometry::TriangleMesh& organ, const geometry::SignedDistance& distance,
             const Pose& organ_pose);

  /// [any] Indices of the triangles, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& triangles() const noexcept { return triangles_; }
  /// [any]
  [[nodiscard]] bool contains(std::int32_t triangle) const noexcept {
    return inside_[static_cast<std::size_t>(triangle)];
  }

 private:
  std::vector<std::int32_t> triangles_;
  std::vector<bool> inside_;
};

/// [setup] Adds hidden inclusions at random places under the search area, by the scene's seed: `lumps` of
/// them, or by default as many as have room, at most 3 (task insert: 1), in a scene without hidden
/// inclusions. Marks within the tolerance of one are outside that of another. @throws InputError when the
/// organ has no room for them
void hide_inclusions(const SearchTable& table, Scene& setup);

/// [setup] The default path of task palpate, in the world: the tool points down and presses at the points of
/// a grid over the search area, row by row. Several hands share the grid.
/// @param tip lowest point of the downward tool, relative to its handle
/// @throws InputError when the organ's mesh is not closed or the search area is empty
[[nodiscard]] std::vector<PathRow> search_path(const Scene& setup, std::size_t hand, const Vec3& tip);

}  // namespace palpate::scene

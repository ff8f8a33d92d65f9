#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh_io/formats/scan.h"

// Values at the vertices of a PLY file, such as colours.
namespace palpate::mesh_io {

inline constexpr std::size_t kMaxPlyVertices = 4'000'000;  // with values

/// A property of all vertices.
struct PlyProperty {
  std::string name;
  NumberType type = NumberType::kFloat;
  std::vector<double> values{};
};

struct PlyVertices {
  std::vector<Vec3> points;  // in the file's unit
  std::vector<PlyProperty> properties;

  /// @return nullptr if the file lacks the property
  [[nodiscard]] const PlyProperty* find(std::string_view name) const;
};

/// [setup] The vertices of a PLY file, with those of the wanted properties that it has. Reads no faces behind
/// them. @throws InputError as import_mesh(), and for more than kMaxPlyVertices
[[nodiscard]] PlyVertices read_ply_vertices(const MeshFile& file, std::span<const std::string_view> wanted);

}  // namespace palpate::mesh_io

#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/inclusion.h"
#include "palpate/units.h"

namespace palpate::scene {

/// How a scene reads the PLY file of its stiffness map.
struct StiffnessMapOptions {
  LengthUnit unit = LengthUnit::kMillimetre;  // of the vertices
  std::optional<double> factor_at_black;      // required for a file with colours, and only there
  std::optional<double> factor_at_white;
};

/// The points of a stiffness map file.
struct StiffnessMapFile {
  std::vector<model::StiffnessPoint> points;
  std::size_t count = 0;             // points in the file; above points.size() they were thinned out
  std::string item = "row";          // "row" or "vertex"
  std::vector<std::string> remarks;  // each begins with the file's name

  /// The name of a point in the file: "row 3".
  [[nodiscard]] std::string name_of(std::size_t point) const;
};

/// [setup] Reads a stiffness map. A PLY file has the vertex property `factor` or `quality`; or the colours
/// red, green, blue: ln factor is linear in their mean, from factor_at_black to factor_at_white. Another file
/// is a CSV with the columns x_mm, y_mm, z_mm (organ frame) and factor.
/// @throws InputError that names file, line or vertex, column or property, and value
[[nodiscard]] StiffnessMapFile read_stiffness_map(const std::filesystem::path& file,
                                                  const StiffnessMapOptions& options = {});

}  // namespace palpate::scene

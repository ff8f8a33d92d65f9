#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/scene/toml_reader.h"
#include "palpate/support.h"
#include "palpate/units.h"

namespace palpate::scene {

/// A support with its place in a file or command line, for messages.
struct LocatedSupport {
  geometry::Support support;
  std::string where;
  std::filesystem::path painted;  // a PLY file that read_painted() still has to read; empty: none
};

/// [setup] The table [organ.support]; empty when the organ has none. @param folder of a relative path
/// @throws InputError
[[nodiscard]] std::optional<LocatedSupport> read_support(const TomlTable& organ,
                                                         const std::filesystem::path& folder);

/// [setup] The support of the flags `--organ-support`: bed:X,Y,Z[,SHARE], faces:X,Y,Z, at:X,Y,Z,RADIUS (mm),
/// painted:FILE, which add up, or none. @throws InputError that shows the forms
[[nodiscard]] std::optional<LocatedSupport> support_by_flags(const std::vector<std::string>& flags);

/// [setup] The flags --organ-support that give this support; without its painted places.
[[nodiscard]] std::vector<std::string> support_flags(const geometry::Support& support);
/// [setup] The table [organ.support] of a scene file, mm; without its painted places, of which a comment
/// tells.
[[nodiscard]] std::string support_toml(const geometry::Support& support);

/// [setup] Adds the places that the support's PLY file marks: vertices whose red is at least half of the full
/// value and twice as much as green and blue. Each holds the surface as far as 0.6 of its longest edge, 1.5
/// mm at least. @param unit of the file @throws InputError for a file without faces, colours or red vertices
void read_painted(LocatedSupport& stated, LengthUnit unit);

/// [any] What a support holds, a phrase for each part: "a bed towards (0, 0, -1), 30 % of the extent".
[[nodiscard]] std::vector<std::string> support_phrases(const geometry::Support& support);

/// [setup] Checks a support on the organ that it holds. @throws InputError
void check_support(const LocatedSupport& stated, const geometry::TriangleMesh& organ);

}  // namespace palpate::scene

#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/scene/toml_reader.h"
#include "palpate/support.h"

namespace palpate::scene {

/// A support with its place in a file or command line, for messages.
struct LocatedSupport {
  geometry::Support support;
  std::string where;
};

/// [setup] The table [organ.support]; empty when the organ has none. @throws InputError
[[nodiscard]] std::optional<LocatedSupport> read_support(const TomlTable& organ);

/// [setup] The support of the flags `--organ-support`: bed:X,Y,Z[,SHARE], faces:X,Y,Z, at:X,Y,Z,RADIUS (mm),
/// which add up, or none. @throws InputError that shows the forms
[[nodiscard]] std::optional<LocatedSupport> support_by_flags(const std::vector<std::string>& flags);

/// [any] What a support holds, a phrase for each part: "a bed towards (0, 0, -1), 30 % of the extent".
[[nodiscard]] std::vector<std::string> support_phrases(const geometry::Support& support);

/// [setup] Checks a support on the organ that it holds. @throws InputError
void check_support(const LocatedSupport& stated, const geometry::TriangleMesh& organ);

}  // namespace palpate::scene

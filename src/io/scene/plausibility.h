#pragma once
#include <span>
#include <string>
#include <vector>

#include "io/scene/scene_file.h"
#include "palpate/mesh.h"
#include "palpate/scene.h"
#include "palpate/tool.h"
#include "palpate/tool_path.h"

// Numbers that are probably in another unit than the file says, by the table of io/system/plausible.h.
namespace palpate::scene {

/// [setup] Checks the size of an instrument. @param parts those that were read from files @param where names
/// the file, for the message @return a question; empty for a usual size @throws InputError for a size that no
/// instrument has
[[nodiscard]] std::string tool_size_remark(std::span<const geometry::ToolPart> parts,
                                           const LocatedString& where);

/// [setup] A question when one part of an instrument of usual size has an unusual size; empty otherwise.
[[nodiscard]] std::string part_size_remark(const geometry::ToolPart& part, const LocatedString& where);

/// [setup] Checks how far an instrument's surface is from the origin of its handle. @param, @return, @throws
/// as tool_size_remark()
[[nodiscard]] std::string tool_distance_remark(std::span<const geometry::ToolPart> parts,
                                               const LocatedString& where);

/// [setup] Bounding box of the scene's organ at rest, in the world [m].
[[nodiscard]] geometry::Bounds organ_box(const Scene& scene);

/// [setup] Checks where an organ lies in the world. @param organ_W its organ_box() @return a question; empty
/// for a usual place @throws InputError for an organ so far away that no device reaches it
[[nodiscard]] std::string organ_distance_remark(const geometry::Bounds& organ_W, const std::string& where);

/// [setup] Questions about the numbers of a tissue.
[[nodiscard]] std::vector<std::string> tissue_remarks(const model::TissueParameters& tissue);

/// What load() keeps of a tool path.
struct PathSummary {
  geometry::Bounds positions_D;  // m
  bool is_sampled = false;       // a log of under 200 rows a second, not some rows that a person gave
};

/// [setup]
[[nodiscard]] PathSummary summary_of(const ToolPath& path);

/// [setup] A question when the path of a hand stays far away from the organ; empty otherwise.
[[nodiscard]] std::string far_path_remark(const Scene& scene, const geometry::Bounds& organ_W,
                                          std::size_t hand, const PathSummary& path);

}  // namespace palpate::scene

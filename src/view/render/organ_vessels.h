#pragma once
#include <string_view>
#include <vector>

#include "palpate/mesh.h"
#include "view/render/gl_objects.h"
#include "view/render/tissue_pattern.h"

namespace palpate::render {

/// Vessels of a built-in organ, which its tissue's pattern cannot know: the great vessels and ducts that
/// leave it, and the heart's coronary vessels with the fat around them. Their centre lines are those of the
/// shapes' formulas (tools/make_shapes).
enum class VesselKind { kCoronary, kArtery, kVein, kDuct };

struct VesselKnot {
  float x, y, z, radius;  // mm, frame of the built-in organ
};
struct OrganVessel {
  std::string_view organ;
  VesselKind kind;
  std::vector<VesselKnot> line;
};

/// [any] The vessels of all built-in organs.
[[nodiscard]] const std::vector<OrganVessel>& organ_vessels();

/// [setup] Colours the vessels of a built-in organ at any detail; other organs stay as they are.
/// @param rest displayed surface, whose vertices `pattern` describes
void paint_vessels(std::string_view organ_name, const geometry::TriangleMesh& rest,
                   const TissueAppearance& look, std::vector<StaticVertex>& pattern);

}  // namespace palpate::render

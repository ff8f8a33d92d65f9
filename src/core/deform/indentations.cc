#include <algorithm>

#include "palpate/surface.h"

namespace palpate::deform {

std::vector<Indentation> indentations_of(std::span<const contact::ToolResult> results) {
  std::vector<Indentation> indentations;
  for (const contact::ToolResult& result : results) {
    for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
      const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
      if (!(view.depth > 0.0)) continue;
      indentations.push_back({view.point_S, view.direction_S, view.depth, view.radius(), 0.0});
    }
  }
  return indentations;
}

}  // namespace palpate::deform

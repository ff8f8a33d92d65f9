#include "palpate/render/indentations.h"

#include <algorithm>

namespace palpate::render {

std::vector<deform::Indentation> indentations_of(const haptics::Snapshot& snapshot) {
  std::vector<deform::Indentation> indentations;
  const std::size_t hands = std::min<std::size_t>(snapshot.hands, haptics::Snapshot::kMaxHands);
  for (std::size_t hand = 0; hand < hands; ++hand) {
    const contact::ToolResult& result = snapshot.results[hand];
    for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
      const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
      if (!(view.depth > 0.0)) continue;
      const double radius =
          view.half_width > 0.0 ? std::min(view.tip_radius, view.half_width) : view.tip_radius;
      indentations.push_back({view.point_S, view.direction_S, view.depth, radius, 0.0});
    }
  }
  return indentations;
}

}  // namespace palpate::render

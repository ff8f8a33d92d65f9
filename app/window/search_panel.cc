// The part of the panel "Scene" for a search: marks, coverage, and the score at its end.
#include <cmath>
#include <string>
#include <utility>

#include <fmt/core.h>
#include <imgui.h>

#include "view/render/map_legend.h"

#include "app/window/panels.h"
#include "app/window/rows.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

void score_rows(const palpation::Score& score) {
  const Rows rows("score");
  for (const palpation::Measure& one : palpation::measures(score)) {
    rows.text(one.name, one.value, one.definition.c_str());
  }
}

/// The colours of the map, with the factors at their ends.
void colour_bar(const SearchStatus& search) {
  constexpr int kSteps = 32;
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = 0.6F * ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 colour = render::map_colour((i + 0.5) / kSteps);
    const auto level = [&](int k) { return static_cast<int>(std::lround(255.0 * render::srgb(colour[k]))); };
    const float left = corner.x + width * static_cast<float>(i) / kSteps;
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(left, corner.y),
                                              ImVec2(left + width / kSteps + 1.0F, corner.y + height),
                                              IM_COL32(level(0), level(1), level(2), 255));
  }
  ImGui::Dummy(ImVec2(width, height));
  const std::string high = fmt::format("{:.2f} times as stiff", search.high);
  ImGui::Text("%.2f", search.low);
  ImGui::SameLine(width - ImGui::CalcTextSize(high.c_str()).x);
  ImGui::TextUnformatted(high.c_str());
}

}  // namespace

void search_panel(const PanelModel& shown, Commands& commands) {
  if (!shown.search) return;
  const SearchStatus& search = *shown.search;
  {
    const Rows rows("search");
    rows.text("Hidden lumps", std::to_string(search.lumps));
    rows.text("Marks", std::to_string(search.marks),
              "M, the left mouse button or the device's button marks the place under the tool");
    rows.text("Coverage", fmt::format("{:.0f} %", 100.0 * search.coverage),
              "touched share of the organ's upper side");
    if (search.pointer_gain < 1.0) {
      rows.text("Pointer", fmt::format("{:.0f} % of its speed", 100.0 * search.pointer_gain),
                "pseudo-haptics: over stiff places the mouse moves the tool less");
    }
  }
  bool map = search.shows_map;
  if (ImGui::Checkbox("Map of the felt stiffness", &map)) commands.map = map;
  if (map) colour_bar(search);
  if (search.score) {
    score_rows(*search.score);
    if (ImGui::Button("Other places", ImVec2(-1.0F, 0.0F))) {
      scene::Overrides request = shown.request;
      request.seed = shown.setup.seed + 1;
      commands.request = std::move(request);
    }
  } else if (ImGui::Button("End the search", ImVec2(-1.0F, 0.0F))) {
    commands.end_search = true;
  }
}

}  // namespace palpate::app

#include "app/window/rows.h"

#include <array>
#include <cstdio>

namespace palpate::app {

Rows::Rows(const char* name, float share)
    : drawn_(ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingStretchProp)) {
  if (!drawn_) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, share);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.0F - share);
}

Rows::~Rows() {
  if (drawn_) ImGui::EndTable();
}

void Rows::name(const char* text, const char* explanation) const {
  if (!drawn_) return;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  if (explanation != nullptr && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", explanation);
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0F);
}

void Rows::text(const char* text, const std::string& value, const char* explanation) const {
  if (!drawn_) return;
  name(text, explanation);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

bool Rows::number(const char* text, double& value, double per_unit, double speed, double least, double most,
                  const char* format, const char* explanation) const {
  if (!drawn_) return false;
  name(text, explanation);
  const std::string id = std::string("##") + text;
  double shown = value / per_unit;
  const bool changed = ImGui::DragScalar(id.c_str(), ImGuiDataType_Double, &shown, static_cast<float>(speed),
                                         &least, &most, format, ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = shown * per_unit;
  return changed;
}

std::string formatted(const char* format, double value) {
  std::array<char, 64> text{};
  // The callers' formats are literals.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  (void)std::snprintf(text.data(), text.size(), format, value);
#pragma GCC diagnostic pop
  return text.data();
}

}  // namespace palpate::app

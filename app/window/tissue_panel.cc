// The panels "Tissue" and "Touch noise", which change parameters of the running session.
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <imgui.h>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "palpate/units.h"

#include "app/window/panels.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr double kMilli = 1e-3;

bool law_row(model::TissueParameters& tissue) {
  const Rows rows("law");
  bool changed = false;
  rows.name("Law", "layered: the paper's; smooth: stiffness without jumps");
  int law = tissue.law == model::LawKind::kSmooth ? 1 : 0;
  if (ImGui::Combo("##law", &law, "layered\0smooth\0")) {
    tissue.law = law == 1 ? model::LawKind::kSmooth : model::LawKind::kLayered;
    changed = true;
  }
  return changed;
}

/// Draws the numbers of [tissue] or of one of its tables.
bool numbers(std::string_view section, model::TissueNumbers& tissue) {
  const Rows rows(section.empty() ? "numbers" : section.data());
  bool changed = false;
  for (const model::TissueField& field : model::kTissueFields) {
    if (field.section != section || field.slider.step == 0.0) continue;
    const model::FieldSlider& slider = field.slider;
    const std::string format = "%." + std::to_string(slider.decimals) + "f " + field.unit.text;
    double value = field.in_force(tissue);
    if (!rows.number(field.label, value, field.unit.si, slider.step, slider.low, slider.high, format.c_str(),
                     field.meaning)) {
      continue;
    }
    field.at.set(tissue, value);
    changed = true;
  }
  return changed;
}

bool term_rows(model::RelaxationTerm& term) {
  const Rows rows("term");
  bool changed =
      rows.number("Share", term.g, 1.0, 0.005, 0.001, 0.95, "%.3f", "of the elastic force that goes");
  changed |= rows.number("Time", term.tau, 1.0, 0.02, 0.001, 1000.0, "%.2f s", "constant of its going");
  return changed;
}

bool relaxation_rows(model::TissueParameters& tissue) {
  bool changed = false;
  for (std::size_t i = 0; i < tissue.relaxation.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    changed |= term_rows(tissue.relaxation[i]);
    ImGui::PopID();
  }
  if (tissue.relaxation.size() < model::kMaxRelaxationTerms && ImGui::SmallButton("One more term")) {
    tissue.relaxation.push_back({0.1, 1.0});
    changed = true;
  }
  if (!tissue.relaxation.empty()) {
    if (tissue.relaxation.size() < model::kMaxRelaxationTerms) ImGui::SameLine();
    if (ImGui::SmallButton("One less")) {
      tissue.relaxation.pop_back();
      changed = true;
    }
  }
  return changed;
}

/// The tissue as its preset or, of another name, as the scene has it.
std::optional<model::TissueParameters> preset_of(const PanelModel& shown) {
  const auto& names = model::tissue_preset_names();
  if (std::find(names.begin(), names.end(), shown.tissue.name) != names.end()) {
    return model::tissue_preset(shown.tissue.name);
  }
  if (shown.tissue.name == shown.scene.tissue.name) return shown.scene.tissue;
  return std::nullopt;
}

void undo_buttons(const PanelModel& shown, Commands& commands) {
  const auto button = [](const char* text, bool enabled, const char* keys) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(text);
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", keys);
    return pressed;
  };
  if (button("Undo", shown.can_undo, "Ctrl + Z: the last change of tissue, noise or inclusion"))
    commands.undo = true;
  ImGui::SameLine();
  if (button("Redo", shown.can_redo, "Ctrl + Y")) commands.undo = false;
}

std::string source_text(const model::TissueParameters& tissue) {
  if (!tissue.source || tissue.source->indenter.empty()) {
    return "illustrative: no [tissue.source] names a measurement";
  }
  return "measured: " + tissue.source->indenter + ", radius " + brief(tissue.source->radius / kMillimetre) +
         " mm";
}

}  // namespace

void tissue_panel(const PanelModel& shown, PanelState& state, Commands& commands) {
  model::TissueParameters tissue = shown.tissue;
  bool changed = false;
  {
    const Rows rows("preset");
    rows.name("Preset", "a tissue as it comes with the program, or from a file");
    if (ImGui::BeginCombo("##preset", tissue.name.c_str())) {
      for (const char* name : model::tissue_preset_names()) {
        if (!ImGui::Selectable(name, tissue.name == name)) continue;
        tissue = model::tissue_preset(name);
        changed = true;
      }
      ImGui::Separator();
      if (ImGui::Selectable("a file ..."))
        state.files.open(FileUse::kTissue, std::filesystem::current_path());
      ImGui::EndCombo();
    }
  }
  undo_buttons(shown, commands);
  const std::optional<model::TissueParameters> preset = preset_of(shown);
  ImGui::SameLine();
  ImGui::BeginDisabled(!preset || *preset == shown.tissue);
  if (ImGui::Button("Reset to preset", ImVec2(-1.0F, 0.0F)) && preset) {
    tissue = *preset;
    changed = true;
  }
  ImGui::EndDisabled();
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextColored(colour::kFaint, "%s", source_text(shown.tissue).c_str());
  ImGui::PopTextWrapPos();
  changed |= law_row(tissue);
  changed |= numbers("", tissue);
  for (const model::TissueSection& section : model::kTissueSections) {
    if (!ImGui::TreeNodeEx(section.title, ImGuiTreeNodeFlags_SpanAvailWidth)) continue;
    changed |= numbers(section.key, tissue);
    ImGui::TreePop();
  }
  if (ImGui::TreeNodeEx("Relaxation", ImGuiTreeNodeFlags_SpanAvailWidth)) {
    changed |= relaxation_rows(tissue);
    ImGui::TreePop();
  }
  if (ImGui::Button("Save as a file ...", ImVec2(-1.0F, 0.0F))) {
    state.files.open(FileUse::kSaveTissue, std::filesystem::current_path() / (tissue.name + ".toml"));
  }
  ImGui::Spacing();
  if (changed) commands.tissue = std::move(tissue);
}

void noise_panel(const PanelModel& shown, PanelState& state, Commands& commands) {
  noise::NoiseSettings noise = shown.noise;
  bool changed = ImGui::Checkbox("On  (N)", &noise.enabled);
  const Rows rows("noise");
  changed |= rows.number("K", noise.gain, 1e-6, 0.2, 0.0, 1000.0, "%.2f \u00b5N m",
                         "noise at distance d: \u03c3 = K/(d + d\u2080)");
  changed |= rows.number("d\u2080", noise.threshold, kMillimetre, 0.02, 0.1, 100.0, "%.2f mm",
                         "distance threshold; in contact \u03c3 = K/d\u2080");
  double sigma = noise.gain / noise.threshold;
  if (rows.number("\u03c3 in contact", sigma, kMilli, 0.05, 0.0, 200.0, "%.2f mN", "changes K")) {
    noise.gain = sigma * noise.threshold;
    changed = true;
  }
  bool by_threshold = rows.number("Your threshold", state.user_threshold, kMilli, 0.1, 0.1, 500.0, "%.1f mN",
                                  "the smallest force that you detect");
  by_threshold |= rows.number("Share of it", state.noise_share, 0.01, 0.2, 0.0, 100.0, "%.0f %%",
                              "about 60 % helps the hand most; changes K");
  if (by_threshold) {
    noise.gain = noise::gain_from_threshold(state.user_threshold, state.noise_share, noise.threshold);
    changed = true;
  }
  if (changed) commands.noise = noise;
}

}  // namespace palpate::app

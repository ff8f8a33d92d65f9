// The tissue and the touch noise, changed while they are felt.
#include <algorithm>
#include <cmath>

#include <imgui.h>

#include "palpate/base/units.h"

#include "app/window/look.h"
#include "app/window/panels.h"
#include "app/window/rows.h"

namespace palpate::app {
namespace {

constexpr double kMilli = 1e-3;

bool springs(model::TissueParameters& tissue) {
  const Rows rows("springs");
  bool changed = false;
  rows.name("Law", "layered: the paper's; smooth: stiffness without jumps");
  int law = tissue.law == model::LawKind::kSmooth ? 1 : 0;
  if (ImGui::Combo("##law", &law, "layered\0smooth\0")) {
    tissue.law = law == 1 ? model::LawKind::kSmooth : model::LawKind::kLayered;
    changed = true;
  }
  changed |= rows.number("k\u2081", tissue.k1, 1.0, 0.1, 0.1, 2000.0, "%.2f N/m",
                         "stiffness of the first layer's spring");
  changed |= rows.number("\u03b2", tissue.beta, 1.0, 0.01, 0.2, 20.0, "%.3f",
                         "layer i is exp((i-1)/\u03b2) times as stiff");
  changed |=
      rows.number("q", tissue.q, 1.0, 0.002, 0.1, 1.5, "%.3f", "layer i gives way q^(i-1) times as far");
  changed |= rows.number("Rest length", tissue.rest_length, kMillimetre, 0.05, 0.5, 100.0, "%.2f mm",
                         "of a first-layer spring");
  changed |= rows.number("Longest", tissue.max_length, kMillimetre, 0.05, 0.5, 200.0, "%.2f mm",
                         "less the rest length: the first layer's limit when pulled");
  changed |= rows.number("Shortest", tissue.min_length, kMillimetre, 0.05, 0.0, 100.0, "%.2f mm",
                         "rest length less this: the first layer's limit when pressed");
  changed |= rows.number("t\u2081", tissue.t1, kMicrosecond, 0.05, 0.05, 200.0, "%.2f \u00b5s",
                         "delay of the first layer: bounds the layers");
  return changed;
}

bool contact_rows(model::TissueParameters& tissue) {
  const Rows rows("contact");
  model::ContactParameters& contact = tissue.contact;
  bool changed =
      rows.number("Friction", contact.friction, 1.0, 0.005, 0.0, 2.0, "%.3f", "Coulomb's coefficient");
  double tangential = tissue.tangential_stiffness();
  if (rows.number("Sideways", tangential, 1.0, 1.0, 1.0, 20000.0, "%.0f N/m",
                  "stiffness of the sticking spring")) {
    contact.tangential_stiffness = tangential;
    changed = true;
  }
  changed |= rows.number("Damping", contact.damping, 1.0, 0.01, 0.0, 20.0, "%.2f N s/m", "along the normal");
  changed |= rows.number("Grip limit", contact.grip_limit, 1.0, 0.05, 0.1, 50.0, "%.2f N",
                         "past it the jaws let go");
  return changed;
}

bool relaxation_rows(model::TissueParameters& tissue) {
  bool changed = false;
  for (std::size_t i = 0; i < tissue.relaxation.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const Rows rows("term");
    changed |= rows.number("Share", tissue.relaxation[i].share, 1.0, 0.005, 0.001, 0.95, "%.3f",
                           "of the elastic force that goes");
    changed |= rows.number("Time", tissue.relaxation[i].time, 1.0, 0.02, 0.001, 1000.0, "%.2f s",
                           "constant of its going");
    ImGui::PopID();
  }
  if (tissue.relaxation.size() < model::kMostRelaxationTerms && ImGui::SmallButton("One more term")) {
    tissue.relaxation.push_back({0.1, 1.0});
    changed = true;
  }
  if (!tissue.relaxation.empty()) {
    if (tissue.relaxation.size() < model::kMostRelaxationTerms) ImGui::SameLine();
    if (ImGui::SmallButton("One less")) {
      tissue.relaxation.pop_back();
      changed = true;
    }
  }
  return changed;
}

bool reach_rows(model::TissueParameters& tissue) {
  const Rows rows("reach");
  model::ReachParameters& reach = tissue.reach;
  bool changed = rows.number("c", reach.contact_ratio, 1.0, 0.005, 0.1, 5.0, "%.3f", "R_1 = c R (D/R)^p");
  changed |=
      rows.number("a", reach.first_bar_ratio, 1.0, 0.005, 0.01, 5.0, "%.3f", "first bar to contact radius");
  changed |= rows.number("s", reach.bar_ratio, 1.0, 0.005, 1.01, 5.0, "%.3f", "each bar to the one above");
  changed |= rows.number("g", reach.weight_ratio, 1.0, 0.002, 0.01, 0.99, "%.3f",
                         "weight of each layer to the one above");
  changed |= rows.number("p", reach.depth_exponent, 1.0, 0.002, 0.01, 1.0, "%.3f",
                         "how R_1 grows with the depth; 1/2 as the square root");
  return changed;
}

}  // namespace

void tissue_panel(const Shown& shown, PanelState& state, Wishes& wishes) {
  model::TissueParameters tissue = shown.tissue;
  bool changed = false;
  {
    const Rows rows("preset");
    rows.name("Preset", "a tissue as it comes with the program, or from a file");
    if (ImGui::BeginCombo("##preset", tissue.name.c_str())) {
      for (const char* name : {"gallbladder", "heart", "liver", "kidney"}) {
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
  changed |= springs(tissue);
  if (ImGui::TreeNodeEx("Contact", ImGuiTreeNodeFlags_SpanAvailWidth)) {
    changed |= contact_rows(tissue);
    ImGui::TreePop();
  }
  if (ImGui::TreeNodeEx("Relaxation", ImGuiTreeNodeFlags_SpanAvailWidth)) {
    changed |= relaxation_rows(tissue);
    ImGui::TreePop();
  }
  if (ImGui::TreeNodeEx("Reach of the dent", ImGuiTreeNodeFlags_SpanAvailWidth)) {
    changed |= reach_rows(tissue);
    ImGui::TreePop();
  }
  if (!shown.tissue_note.empty()) {
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextColored(colour::kWarning, "%s", shown.tissue_note.c_str());
    ImGui::PopTextWrapPos();
  }
  if (ImGui::Button("Save as a file ...", ImVec2(-1.0F, 0.0F))) {
    state.files.open(FileUse::kSaveTissue, std::filesystem::current_path() / (tissue.name + ".toml"));
  }
  ImGui::Spacing();
  if (changed) wishes.tissue = std::move(tissue);
}

void noise_panel(const Shown& shown, PanelState& state, Wishes& wishes) {
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
  if (changed) wishes.noise = noise;
}

}  // namespace palpate::app

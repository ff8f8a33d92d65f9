#include "app/window/support_editor.h"

#include <limits>
#include <utility>

#include <fmt/core.h>
#include <imgui.h>

#include "core/base/index.h"
#include "io/scene/support_reader.h"
#include "palpate/error.h"
#include "palpate/surface.h"
#include "palpate/units.h"

#include "app/window/panels.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

std::string response_text(const SupportStatus& status) {
  if (status.support.empty()) return "nothing: the surface around a contact alone gives way";
  if (!status.refusal.empty()) return status.refusal;
  switch (status.response) {
    case render::ResponseState::kPreparing:
      return "computing how the organ moves ...";
    case render::ResponseState::kFailed:
      return "holds too little: the organ would turn away";
    case render::ResponseState::kShown:
      return fmt::format("{:.1f} % of the surface; the whole organ gives way", 1e2 * status.held);
    case render::ResponseState::kNone:
      break;
  }
  return fmt::format("{:.1f} % of the surface", 1e2 * status.held);
}

// A row for each attachment: its radius, and a button that takes it away.
void attachment_rows(const SupportStatus& status, std::optional<SupportChange>& change) {
  geometry::Support support = status.support;
  for (std::size_t i = 0; i < support.attachments.size(); ++i) {
    geometry::Attachment& one = support.attachments[i];
    ImGui::PushID(static_cast<int>(i));
    auto radius = static_cast<float>(one.radius / kMillimetre);
    ImGui::SetNextItemWidth(0.62F * ImGui::GetContentRegionAvail().x);
    const bool moved = ImGui::SliderFloat("##radius", &radius, 1.0F, 60.0F, "attached: %.1f mm",
                                          ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("radius of the attachment at (%.1f, %.1f, %.1f) mm", one.point.x() / kMillimetre,
                        one.point.y() / kMillimetre, one.point.z() / kMillimetre);
    const bool settled = ImGui::IsItemDeactivatedAfterEdit();
    if (moved || settled) {
      one.radius = static_cast<double>(radius) * kMillimetre;
      change = SupportChange{.support = support, .settled = settled};
    }
    ImGui::SameLine();
    if (ImGui::Button("Remove", ImVec2(-1.0F, 0.0F))) {
      support.attachments.erase(support.attachments.begin() + static_cast<std::ptrdiff_t>(i));
      change = SupportChange{.support = support};
      ImGui::PopID();
      return;
    }
    ImGui::PopID();
  }
}

}  // namespace

SupportEditor::SupportEditor(const scene::Scene& scene) : organ_(scene.organ) {
  if (!scene.support) return;
  status_.support = *scene.support;
  measure(*scene.support);
}

void SupportEditor::measure(const geometry::Support& support) {
  status_.held = geometry::held_share(support, organ_);
  if (status_.cells.empty()) status_.cells = deform::describe(deform::response_cells(organ_));
}

std::optional<geometry::Support> SupportEditor::in_force() const {
  if (status_.support.empty() || !status_.refusal.empty()) return std::nullopt;
  return status_.support;
}

void SupportEditor::set(const geometry::Support& support, bool settled, LivePicture& picture) {
  changed_ = true;
  status_.support = support;
  status_.refusal.clear();
  status_.held = 0.0;
  if (!support.empty()) {
    try {
      measure(support);
      geometry::check_support(support, organ_);
    } catch (const InputError& error) {
      status_.refusal = error.what();
    }
  }
  if (settled) picture.set_support(in_force());
  draw_on(picture);
}

void SupportEditor::apply(const SupportChange& change, LivePicture& picture) {
  if (change.radius) status_.radius = *change.radius;
  if (change.choosing) {
    status_.choosing = *change.choosing;
    if (!places_) places_ = report::places_of(organ_);
    draw_on(picture);
  }
  if (change.support) set(*change.support, change.settled, picture);
}

bool SupportEditor::pick(const geometry::Ray& ray_W, const Pose& organ_W, LivePicture& picture) {
  const Quat back = organ_W.rotation.conjugate();
  const geometry::Ray ray_S{back * (ray_W.origin - organ_W.position), back * ray_W.direction};
  const std::optional<Vec3> point = geometry::seen_point(organ_, ray_S);
  if (!point) return false;
  geometry::Support support = status_.support;
  support.attachments.push_back({*point, status_.radius});
  set(support, true, picture);
  return true;
}

void SupportEditor::draw_on(LivePicture& picture) const {
  if (!status_.choosing || !places_) {
    picture.show_values({}, {}, 0.0, 1.0);
    return;
  }
  std::vector<float> values(places_->points.size(), std::numeric_limits<float>::quiet_NaN());
  if (!status_.support.empty()) {
    try {
      values = report::held_values(organ_, *places_, status_.support);
    } catch (const InputError&) {  // stated in the panel
    }
  }
  picture.show_values(places_->points, std::move(values), 0.0, 1.0);
}

SupportStatus SupportEditor::status(const LivePicture& picture) const {
  SupportStatus status = status_;
  status.response = picture.response();
  return status;
}

void support_panel(const PanelModel& shown, Commands& commands) {
  if (!shown.support) return;
  const SupportStatus& status = *shown.support;
  ImGui::Separator();
  bool choosing = status.choosing;
  if (ImGui::Checkbox("Choose what holds the organ  (H)", &choosing))
    commands.support = SupportChange{.choosing = choosing};
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("for the picture: forces do not change, and the recording keeps the scene's support");
  if (!choosing && status.support.empty()) return;
  ImGui::PushTextWrapPos(0.0F);
  for (const std::string& phrase :
       scene::support_phrases({status.support.bed, status.support.faces, {}, status.support.painted}))
    ImGui::TextUnformatted(phrase.c_str());
  const bool wrong = !status.refusal.empty() || status.response == render::ResponseState::kFailed;
  ImGui::TextColored(wrong ? colour::kForce : colour::kFaint, "Held: %s", response_text(status).c_str());
  if (status.response == render::ResponseState::kShown)
    ImGui::TextColored(colour::kFaint, "Computed in cells of %s", status.cells.c_str());
  if (choosing)
    ImGui::TextColored(colour::kFaint, "Click on the organ to attach it there. Right drag turns the view.");
  ImGui::PopTextWrapPos();
  if (!choosing) return;
  auto radius = static_cast<float>(status.radius / kMillimetre);
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::SliderFloat("##next", &radius, 1.0F, 60.0F, "next radius: %.1f mm",
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic))
    commands.support = SupportChange{.radius = static_cast<double>(radius) * kMillimetre};
  attachment_rows(status, commands.support);
  if (status.support.empty()) return;
  if (ImGui::Button("Copy for the scene file", ImVec2(-1.0F, 0.0F)))
    ImGui::SetClipboardText(scene::support_toml(status.support).c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("the lines [organ.support], onto the clipboard");
}

}  // namespace palpate::app

// The panel "Scene": organ, tool, task and recording.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

#include "palpate/builtin.h"
#include "palpate/units.h"

#include "app/window/choices.h"
#include "app/window/panels.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// The file name of a path, or the name itself.
std::string short_name(const std::string& name) {
  const std::string file = fs::path(name).filename().string();
  return file.empty() ? name : file;
}

/// The name of a built-in organ or tool without its detail, or the file's name.
std::string base_now(const std::string& name, const std::vector<std::string>& known) {
  const bool builtin = std::find(known.begin(), known.end(), name) != known.end();
  return builtin ? parts_of(name).base : short_name(name);
}

std::string organ_now(const PanelModel& shown) {
  return base_now(shown.scene.organ_name, geometry::builtin_organ_names());
}

std::string tool_now(const PanelModel& shown) {
  if (shown.scene.tools.empty()) return {};
  return base_now(shown.scene.tools.front().name, geometry::builtin_tool_names());
}

void take_organ(const std::string& name, const PanelModel& shown, Commands& commands) {
  scene::Overrides request = shown.request;
  request.organ = name;
  request.organ_unit.reset();
  request.organ_frame.reset();
  commands.request = std::move(request);
}

void take_tool(const std::string& name, const PanelModel& shown, Commands& commands) {
  scene::Overrides request = shown.request;
  request.tools = {name};
  request.tool_unit.reset();
  commands.request = std::move(request);
  commands.keep = Keep::all();
}

/// Draws the choice of a detail. @param name in the scene @param base the name without it @return the chosen
/// detail, if the user chose one
std::optional<std::string> chosen_detail(const char* id, const std::string& name, const std::string& base,
                                         const char* coarsest) {
  std::optional<std::string> chosen;
  const std::vector<std::string> details = detail_choices(base);
  std::string now = details.empty() ? "of the file" : detail_text(parts_of(name).detail, coarsest);
  if (name.starts_with("sphere:")) now = "of the ball";
  ImGui::BeginDisabled(details.size() < 2);
  if (ImGui::BeginCombo(id, now.c_str())) {
    for (const std::string& detail : details) {
      const std::string text = detail_text(detail, coarsest);
      if (ImGui::Selectable(text.c_str(), text == now)) chosen = detail;
    }
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  return chosen;
}

void choose_detail(const PanelModel& shown, Commands& commands) {
  const std::string organ = organ_now(shown);
  if (const auto detail =
          chosen_detail("##detail", shown.scene.organ_name, organ, "a few thousand triangles")) {
    take_organ(organ + *detail, shown, commands);
    commands.keep = {.tissue = true, .noise = true};
  }
}

void choose_tool_detail(const PanelModel& shown, Commands& commands) {
  const std::string tool = tool_now(shown);
  const std::string name = shown.scene.tools.empty() ? std::string() : shown.scene.tools.front().name;
  if (const auto detail = chosen_detail("##tool-detail", name, tool, "about 1,000 triangles"))
    take_tool(tool + *detail, shown, commands);
}

void choose_organ(const PanelModel& shown, PanelState& state, Commands& commands) {
  const std::string now = organ_now(shown);
  if (!ImGui::BeginCombo("##organ", now.c_str())) return;
  for (const std::string& name : organ_choices()) {
    if (!ImGui::Selectable(name.c_str(), name == now)) continue;
    take_organ(name, shown, commands);
    if (shown.scene.support || !shown.request.organ_support.empty())
      commands.request->organ_support = {"none"};  // that of the old organ
    commands.request->tissue.reset();              // the tissue of the new organ
    commands.keep = {.noise = true};
  }
  ImGui::Separator();
  if (ImGui::Selectable("a file ...")) state.files.open(FileUse::kOrgan, fs::current_path());
  ImGui::EndCombo();
}

void choose_tool(const PanelModel& shown, PanelState& state, Commands& commands) {
  const std::string now = tool_now(shown);
  if (!ImGui::BeginCombo("##tool", now.c_str())) return;
  std::vector<std::string> names = tool_choices();
  for (const char* ball : {"sphere:3", "sphere:5", "sphere:10"}) names.emplace_back(ball);
  for (const std::string& name : names) {
    if (ImGui::Selectable(name.c_str(), name == now)) take_tool(name, shown, commands);
  }
  ImGui::Separator();
  if (ImGui::Selectable("a file ...")) state.files.open(FileUse::kTool, fs::current_path());
  ImGui::EndCombo();
}

void choose_task(const PanelModel& shown, Commands& commands) {
  for (const scene::Task task :
       {scene::Task::kPress, scene::Task::kPull, scene::Task::kPalpate, scene::Task::kInsert}) {
    const bool begins_row = task == scene::Task::kPress || task == scene::Task::kInsert;  // three fit in one
    if (!begins_row) ImGui::SameLine();
    const bool now = shown.scene.task == task;
    if (!ImGui::RadioButton(scene::to_string(task), now) || now) continue;
    commands.request = with_task(shown.scene, shown.request, task);
    commands.keep = {.tissue = true, .noise = true};
  }
}

/// Draws a row for the stiffness ratio of each visible inclusion. A hidden one is not shown, not even its
/// number, because the user may be searching for it.
void inclusion_rows(const PanelModel& shown, Commands& commands) {
  if (scene::visible_inclusions({shown.inclusions.begin(), shown.inclusions.end()}).empty()) return;
  const Rows rows("inclusions");
  for (std::size_t i = 0; i < shown.inclusions.size(); ++i) {
    if (!shown.inclusions[i].visible) continue;
    const model::Inclusion& inclusion = shown.inclusions[i].inclusion;
    const std::string explanation = formatted("a sphere of %.1f mm in the tissue; the number: its stiffness ",
                                              2.0 * inclusion.radius / kMillimetre) +
                                    "divided by that of the tissue";
    double ratio = inclusion.ratio;
    ImGui::PushID(static_cast<int>(i));
    if (rows.number(shown.inclusions[i].name.c_str(), ratio, 1.0, 0.05, model::kSoftestInclusion,
                    model::kStiffestInclusion, "%.1f times as stiff", explanation.c_str())) {
      const Vec3& centre_S = inclusion.centre_S;
      commands.inclusion = haptics::LiveInclusion{
          static_cast<std::uint32_t>(i), {centre_S.x(), centre_S.y(), centre_S.z()}, ratio};
    }
    ImGui::PopID();
  }
}

/// Draws a button of half the panel's width with a tooltip. @return whether it was pressed
bool half_button(const char* text, bool enabled, const std::string& explanation) {
  const float half = 0.5F * (ImGui::GetWindowContentRegionMax().x - ImGui::GetWindowContentRegionMin().x -
                             ImGui::GetStyle().ItemSpacing.x);
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::Button(text, ImVec2(half, 0.0F));
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", explanation.c_str());
  return pressed;
}

void record_button(const PanelModel& shown, Commands& commands) {
  if (shown.records_run) {
    (void)half_button(shown.ended ? "Recorded###record" : "Recording###record", false,
                      "the program records whole runs (--record): a recording ends with its run");
    return;
  }
  const bool recording = !shown.recording.empty();
  const char* text = recording     ? "End recording###record"
                     : shown.ended ? "Save the run###record"
                                   : "Record###record";
  if (half_button(text, true,
                  "Ctrl + R: writes palpate-DATE-TIME.h5 in the working folder; the run goes on.\n"
                  "The recording has all of the run from its start, so that it replays bit for bit.")) {
    commands.record = !recording;
  }
}

void run_buttons(const PanelModel& shown, Commands& commands) {
  if (half_button("Run again", true, "Enter: zero force, then the same from the start"))
    commands.again = true;
  ImGui::SameLine();
  const char* pause = shown.may_pause ? "Ctrl + Space: no time passes in the run, and its devices are stopped"
                                      : "a hand holds the device: its run is never paused; Hold picture is";
  if (half_button(shown.pausing ? "Go on###pause" : "Pause###pause", shown.may_pause && !shown.ended,
                  pause)) {
    commands.pause_run = true;
  }
  record_button(shown, commands);
  ImGui::SameLine();
  const std::string look = shown.looked_at.empty()
                               ? "V: nothing is recorded yet; Record, or palpate run --record FILE"
                               : "V: the viewer opens " + short_name(shown.looked_at) +
                                     "\nin a window of its own, as far as it is written";
  if (half_button("Look at it", !shown.looked_at.empty(), look)) commands.look = true;
  if (half_button(shown.paused ? "Picture on###hold" : "Hold picture###hold", true,
                  "Space: picture and plots stand still; the run goes on")) {
    commands.pause = true;
  }
  ImGui::SameLine();
  if (half_button("Picture", true, "P: saves the window as a PNG in the working folder"))
    commands.screenshot = true;
}

}  // namespace

void scene_panel(const PanelModel& shown, PanelState& state, Commands& commands) {
  {
    const Rows rows("scene", 0.30F);
    rows.name("Scene", "the built-in scenes, or a scene file (.toml); or drop one on the window");
    const std::string scene =
        shown.request.scene ? short_name(shown.request.scene->string()) : shown.scene.name;
    if (ImGui::Button((scene + " ...###scene").c_str(), ImVec2(-1.0F, 0.0F))) state.gallery.open();
    rows.name("Organ", "built in, or a mesh file");
    choose_organ(shown, state, commands);
    rows.name("Detail", "of a built-in organ's surface: more triangles take longer to prepare");
    choose_detail(shown, commands);
    rows.name("Tool", "built in, or a mesh file; several tools stay as the scene has them");
    ImGui::BeginDisabled(shown.scene.tools.size() != 1);
    choose_tool(shown, state, commands);
    rows.name("Detail", "of a built-in tool's surface");
    choose_tool_detail(shown, commands);
    ImGui::EndDisabled();
    rows.name("Task",
              "press: the law's limit when pressed; pull: the jaws grasp; palpate: find hidden lumps; "
              "insert: a needle");
    choose_task(shown, commands);
  }
  run_buttons(shown, commands);
  ImGui::TextColored(shown.recording.empty() ? colour::kFaint : colour::kForce, "%s",
                     shown.recording_note.c_str());
  inclusion_rows(shown, commands);
  support_panel(shown, commands);
  search_panel(shown, commands);
  insertion_panel(shown, commands);
  ImGui::Spacing();
}

}  // namespace palpate::app

// What is touched, with what, and what is kept of it.
#include <algorithm>

#include <imgui.h>

#include "palpate/geometry/builtin.h"

#include "app/window/look.h"
#include "app/window/panels.h"
#include "app/window/rows.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// The last part of a path, or the name itself.
std::string short_name(const std::string& name) {
  const std::string file = fs::path(name).filename().string();
  return file.empty() ? name : file;
}

void choose_organ(const Shown& shown, PanelState& state, Wishes& wishes) {
  if (!ImGui::BeginCombo("##organ", short_name(shown.setup.organ_name).c_str())) return;
  for (const std::string& name : geometry::builtin_organ_names()) {
    if (!ImGui::Selectable(name.c_str(), name == shown.setup.organ_name)) continue;
    scene::Request request = shown.request;
    request.organ = name;
    request.organ_unit.reset();
    request.tissue.reset();  // the organ's own
    wishes.request = std::move(request);
  }
  ImGui::Separator();
  if (ImGui::Selectable("a file ...")) state.files.open(FileUse::kOrgan, fs::current_path());
  ImGui::EndCombo();
}

void choose_tool(const Shown& shown, PanelState& state, Wishes& wishes) {
  const std::string now =
      shown.setup.tools.empty() ? std::string() : short_name(shown.setup.tools.front().name);
  if (!ImGui::BeginCombo("##tool", now.c_str())) return;
  std::vector<std::string> names = geometry::builtin_tool_names();
  for (const char* ball : {"sphere:3", "sphere:5", "sphere:10"}) names.emplace_back(ball);
  for (const std::string& name : names) {
    if (!ImGui::Selectable(name.c_str(), name == now)) continue;
    scene::Request request = shown.request;
    request.tools = {name};
    request.tool_unit.reset();
    wishes.request = std::move(request);
  }
  ImGui::Separator();
  if (ImGui::Selectable("a file ...")) state.files.open(FileUse::kTool, fs::current_path());
  ImGui::EndCombo();
}

void choose_task(const Shown& shown, Wishes& wishes) {
  const bool pull = shown.setup.task == scene::Task::kPull;
  const auto want = [&](const char* task) {
    scene::Request request = shown.request;
    request.task = task;
    if (!request.scene && !request.organ) request.organ = shown.setup.organ_name;
    wishes.request = std::move(request);
  };
  if (ImGui::RadioButton("press", !pull) && pull) want("press");
  ImGui::SameLine();
  if (ImGui::RadioButton("pull", pull) && !pull) want("pull");
}

}  // namespace

void scene_panel(const Shown& shown, PanelState& state, Wishes& wishes) {
  {
    const Rows rows("scene", 0.30F);
    rows.name("Scene", "a scene file (.toml); or drop one on the window");
    const std::string scene = shown.request.scene ? short_name(shown.request.scene->string()) : "built in";
    if (ImGui::Button((scene + " ...##scene").c_str(), ImVec2(-1.0F, 0.0F))) {
      state.files.open(FileUse::kScene, fs::current_path());
    }
    rows.name("Organ", "built in, or a mesh file");
    choose_organ(shown, state, wishes);
    rows.name("Tool", "built in, or a mesh file; several tools stay as the scene has them");
    ImGui::BeginDisabled(shown.setup.tools.size() != 1);
    choose_tool(shown, state, wishes);
    ImGui::EndDisabled();
    rows.name("Task", "press: the law's limit when pressed; pull: the jaws grasp");
    choose_task(shown, wishes);
  }
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (ImGui::Button("Run again", ImVec2(half, 0.0F))) wishes.again = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Enter: zero force, then the same from the start");
  ImGui::SameLine();
  if (ImGui::Button(shown.paused ? "Go on" : "Hold picture", ImVec2(half, 0.0F))) wishes.pause = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Space: picture and plots stand still; the run goes on");
  const bool recording = !shown.recording.empty() && !shown.ended;
  if (ImGui::Button(recording ? "End recording" : "Record", ImVec2(half, 0.0F))) wishes.record = !recording;
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip(
        "Ctrl + R: the session begins anew, so that the recording has it whole\n"
        "and replays bit for bit; ending it begins a session without");
  }
  ImGui::SameLine();
  if (ImGui::Button("Picture", ImVec2(half, 0.0F))) wishes.screenshot = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("P: saves the window as a PNG in the working folder");
  ImGui::BeginDisabled(shown.looked_at.empty());
  if (ImGui::Button("Look at the recording  (V)", ImVec2(-1.0F, 0.0F))) wishes.look = true;
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    ImGui::SetTooltip("%s", shown.looked_at.empty()
                                ? "nothing is recorded yet: Record, or palpate run --record FILE"
                                : ("the viewer opens " + short_name(shown.looked_at) +
                                   " in a window of its own, as far as it is written")
                                      .c_str());
  }
  if (recording) ImGui::TextColored(colour::kForce, "recording to %s", short_name(shown.recording).c_str());
  ImGui::Spacing();
}

}  // namespace palpate::app

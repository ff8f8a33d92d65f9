#include "app/window/file_chooser.h"

#include <algorithm>
#include <sstream>
#include <system_error>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "core/base/text.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"

#include "app/window/theme.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTitle = "Choose a file";

std::string ending_of(const fs::path& file) { return lower_case(to_text(file.extension())); }

bool wants_mesh(FileUse use) {
  return use == FileUse::kOrgan || use == FileUse::kTool || use == FileUse::kFurtherJaw;
}

bool fits(FileUse use, const fs::path& file) {
  if (wants_mesh(use)) return geometry::is_mesh_file(file);
  if (use == FileUse::kRecording) return ending_of(file) == ".h5";
  return ending_of(file) == (use == FileUse::kToolPath ? ".csv" : ".toml");
}

const char* what_for(FileUse use) {
  switch (use) {
    case FileUse::kOrgan:
      return "Organ: a mesh, or a solid mesh of a simulation (VTK, Gmsh)";
    case FileUse::kTool:
      return "Tool: a mesh in the handle's frame";
    case FileUse::kFurtherJaw:
      return "A further jaw of the tool: a mesh in the handle's frame";
    case FileUse::kTissue:
      return "Tissue file (.toml)";
    case FileUse::kScene:
      return "Scene (.toml)";
    case FileUse::kToolPath:
      return "Tool path (.csv)";
    case FileUse::kRecording:
      return "Recording (.h5)";
    case FileUse::kSaveTissue:
      return "Save the tissue as (.toml)";
  }
  return "";
}

}  // namespace

std::optional<FileUse> use_of_file(const fs::path& file) {
  if (geometry::is_mesh_file(file)) return FileUse::kOrgan;
  const std::string ending = ending_of(file);
  if (ending == ".csv") return FileUse::kToolPath;
  if (ending == ".h5") return FileUse::kRecording;
  if (ending != ".toml") return std::nullopt;
  try {
    std::istringstream text(InputFile(file, kTomlInput).read_rest());
    for (std::string line; std::getline(text, line);) {
      if (line.rfind("[tissue]", 0) == 0) return FileUse::kTissue;
      if (line.rfind("[organ]", 0) == 0) return FileUse::kScene;
    }
  } catch (const InputError&) {  // reading it as a scene gives the error message
  }
  return FileUse::kScene;
}

void FileChooser::open(FileUse use, const fs::path& file) {
  std::error_code error;
  use_ = use;
  name_.clear();
  unit_.clear();
  const fs::path absolute = fs::absolute(file, error);
  // Here and below an error counts as absent: a person sees the list and chooses again.
  if (fs::is_directory(absolute, error)) {
    go_to(absolute);
  } else {
    go_to(absolute.parent_path());
    name_ = absolute.filename().string();
  }
  open_ = true;
  just_opened_ = true;
}

void FileChooser::go_to(const fs::path& folder) {
  std::error_code error;
  fs::path there = folder.lexically_normal();
  if (!there.has_filename() && there.has_relative_path()) there = there.parent_path();
  entries_.clear();
  for (const auto& entry :
       fs::directory_iterator(there, fs::directory_options::skip_permission_denied, error)) {
    const std::string name = entry.path().filename().string();
    if (name.empty() || name.front() == '.') continue;
    const bool is_folder = entry.is_directory(error);  // an error counts as absent
    if (!is_folder && !fits(use_, entry.path())) continue;
    Entry found;
    found.name = name;
    found.folder = is_folder;
    entries_.push_back(std::move(found));
  }
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return a.folder != b.folder ? a.folder : a.name < b.name; });
  folder_ = there;
}

void FileChooser::draw_entries(float height) {
  if (ImGui::BeginChild("entries", ImVec2(0.0F, height), true)) {
    fs::path enter;
    if (folder_.has_relative_path() && ImGui::Selectable("..  (the folder above)"))
      enter = folder_.parent_path();
    for (const Entry& entry : entries_) {
      const std::string text = entry.name + (entry.folder ? "/" : "");
      if (!ImGui::Selectable(text.c_str(), !entry.folder && entry.name == name_,
                             ImGuiSelectableFlags_AllowDoubleClick)) {
        continue;
      }
      if (entry.folder) {
        enter = folder_ / entry.name;
      } else {
        name_ = entry.name;
        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) confirmed_ = true;
      }
    }
    if (entries_.empty()) ImGui::TextDisabled("nothing here that fits");
    if (!enter.empty()) go_to(enter);
  }
  ImGui::EndChild();
}

void FileChooser::draw_mesh_choices() {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Use as");
  for (const auto& [use, text] : {std::pair(FileUse::kOrgan, "organ"), std::pair(FileUse::kTool, "tool"),
                                  std::pair(FileUse::kFurtherJaw, "further jaw")}) {
    ImGui::SameLine();
    if (ImGui::RadioButton(text, use_ == use)) use_ = use;
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Its unit");
  for (const char* unit : {"mm", "cm", "m", "in"}) {
    ImGui::SameLine();
    if (ImGui::RadioButton(unit, unit_ == unit)) unit_ = unit;
  }
}

bool FileChooser::ready() const {
  if (name_.empty() || (wants_mesh(use_) && unit_.empty())) return false;
  std::error_code error;  // an error counts as absent
  return use_ == FileUse::kSaveTissue || fs::is_regular_file(folder_ / name_, error);
}

std::optional<ChosenFile> FileChooser::draw() {
  if (!open_) return std::nullopt;
  if (just_opened_) ImGui::OpenPopup(kTitle);
  just_opened_ = false;
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float text = ImGui::GetFontSize();
  ImGui::SetNextWindowSize(
      ImVec2(std::min(36.0F * text, 0.95F * all.x), std::min(30.0F * text, 0.95F * all.y)));
  ImGui::SetNextWindowPos(ImVec2(0.5F * all.x, 0.5F * all.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  std::optional<ChosenFile> chosen;
  if (ImGui::BeginPopupModal(kTitle, &open_, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    confirmed_ = false;
    ImGui::TextUnformatted(what_for(use_));
    ImGui::TextDisabled("%s", folder_.c_str());
    draw_entries(ImGui::GetContentRegionAvail().y - (wants_mesh(use_) ? 9.0F : 5.5F) * text);
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    if (ImGui::InputTextWithHint("##name", "name of the file", &name_,
                                 ImGuiInputTextFlags_EnterReturnsTrue)) {
      confirmed_ = true;
    }
    if (wants_mesh(use_)) draw_mesh_choices();
    const bool can = ready();
    ImGui::BeginDisabled(!can);
    if (ImGui::Button(use_ == FileUse::kSaveTissue ? "Save" : "Open")) confirmed_ = true;
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool leave = ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (!can && wants_mesh(use_) && !name_.empty() && unit_.empty()) {
      ImGui::SameLine();
      ImGui::TextColored(colour::kWarning, "say its unit: it is never guessed");
    }
    if (confirmed_ && can) chosen = ChosenFile{use_, folder_ / name_, unit_};
    if (leave || chosen) {
      ImGui::CloseCurrentPopup();
      open_ = false;
    }
    ImGui::EndPopup();
  }
  return chosen;
}

}  // namespace palpate::app

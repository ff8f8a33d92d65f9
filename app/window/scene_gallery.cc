#include "app/window/scene_gallery.h"

#include <algorithm>
#include <vector>

#include <epoxy/gl.h>
#include <imgui.h>
#include <png.h>

#include "app/window/scene_pictures.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr const char* kScenesTitle = "Scenes";
constexpr float kCardWidth = 13.0F;  // all in font sizes
constexpr float kTextHeight = 5.2F;  // title and up to three lines
constexpr int kColumns = 4;

}  // namespace

std::string device_for_user(const scene::Scene& scene) {
  const scene::DeviceSetup& device = scene.devices.front();
  const bool by_itself = device.kind == "scripted" || device.kind == "replay" || device.kind == "emulated";
  if (by_itself) return "mouse";
  return device.kind + (device.path.empty() ? "" : ":" + device.path);
}

/// The scene's picture as an OpenGL texture; 0: it has none.
unsigned SceneGallery::texture_of(std::string_view name) {
  const auto known = textures_.find(name);
  if (known != textures_.end()) return known->second;
  const std::span<const unsigned char> png = scene_picture(name);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  std::vector<unsigned char> pixels;
  bool read = png_image_begin_read_from_memory(&header, png.data(), png.size()) != 0;
  if (read) {
    header.format = PNG_FORMAT_RGBA;
    pixels.resize(PNG_IMAGE_SIZE(header));
    read = png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr) != 0;
  }
  png_image_free(&header);
  GLuint texture = 0;
  if (read) {
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(header.width),
                 static_cast<GLsizei>(header.height), 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    glBindTexture(GL_TEXTURE_2D, 0);
  }
  textures_.emplace(name, texture);
  return texture;
}

/// Draws a scene as a picture with text. @return whether it was chosen
bool SceneGallery::draw_card(std::string_view name, std::string_view title, std::string_view line) {
  const float text = ImGui::GetFontSize();
  const float width = kCardWidth * text;
  const float picture = width * 2.0F / 3.0F;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const bool chosen =
      ImGui::Selectable(("##" + std::string(name)).c_str(), false, ImGuiSelectableFlags_DontClosePopups,
                        ImVec2(width, picture + kTextHeight * text));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + width, corner.y + picture);
  if (const unsigned texture = texture_of(name); texture != 0) {
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), corner, end);
  } else {
    list.AddRect(corner, end, packed(colour::kFaint));
  }
  const float margin = 0.2F * text;
  list.AddText(ImVec2(corner.x + margin, end.y + margin), packed(colour::kText), title.data(),
               title.data() + title.size());
  list.AddText(nullptr, 0.0F, ImVec2(corner.x + margin, end.y + margin + 1.3F * text), packed(colour::kFaint),
               line.data(), line.data() + line.size(), width - 2.0F * margin);
  return chosen;
}

SceneGallery::Choice SceneGallery::draw() {
  Choice choice;
  if (!open_) return choice;
  const bool opens = just_opened_;
  just_opened_ = false;
  if (opens) ImGui::OpenPopup(kScenesTitle);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float text = ImGui::GetFontSize();
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float margin = 2.0F * ImGui::GetStyle().WindowPadding.x + ImGui::GetStyle().ScrollbarSize;
  const auto fitting = static_cast<int>((0.95F * all.x - margin) / (kCardWidth * text + gap));
  const int columns = std::clamp(fitting, 1, kColumns);
  ImGui::SetNextWindowSize(ImVec2(
      static_cast<float>(columns) * (kCardWidth * text + gap) + margin,
      std::min(0.95F * all.y, 2.0F * (kCardWidth * 2.0F / 3.0F + kTextHeight + 1.0F) * text + 2.5F * text)));
  ImGui::SetNextWindowPos(ImVec2(0.5F * all.x, 0.5F * all.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (!ImGui::BeginPopupModal(kScenesTitle, &open_, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    return choice;
  }
  int column = 0;
  for (const scene::BuiltinScene& one : scene::builtin_scenes()) {
    if (draw_card(one.name, one.title, one.line)) choice.scene = &one;
    if (++column % columns != 0) ImGui::SameLine();
  }
  ImGui::BeginGroup();
  choice.browse = ImGui::Button("Browse for a file ...", ImVec2(kCardWidth * text, 0.0F));
  const bool cancel = ImGui::Button("Cancel", ImVec2(kCardWidth * text, 0.0F));
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + kCardWidth * text);
  ImGui::TextColored(
      colour::kFaint,
      "Your device, or the mouse, holds the tool. You can also drop a scene file on the window.");
  ImGui::PopTextWrapPos();
  ImGui::EndGroup();
  const bool esc = !opens && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  if (choice.scene != nullptr || choice.browse || cancel || esc) {
    ImGui::CloseCurrentPopup();
    open_ = false;
  }
  ImGui::EndPopup();
  return choice;
}

}  // namespace palpate::app

#include "app/window/theme.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

namespace palpate::app {
namespace {

/// Unicode ranges of the panels' text: Latin, Greek and a few symbols.
constexpr ImWchar kLetters[] = {0x0020, 0x00FF, 0x0370, 0x03FF, 0x2010, 0x2026, 0x2070,
                                0x209F, 0x2190, 0x21FF, 0x25A0, 0x25FF, 0};

/// Unicode range of digits and the colon of a clock.
constexpr ImWchar kDigits[] = {0x0030, 0x003A, 0};

/// Fonts with Chinese, Japanese and Korean letters, the first that is there.
constexpr const char* kWideFonts[] = {
    "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",  // fonts-droid-fallback
    "/usr/share/fonts/truetype/wqy/wqy-microhei.ttc",             // fonts-wqy-microhei
    "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc"};    // fonts-noto-cjk

bool exists(const char* file) {
  std::error_code error;  // an error counts as absent: there is another font
  return std::filesystem::exists(file, error);
}

/// Ranges of the letters of a text and of kLetters. The atlas keeps the pointer. Main thread only.
const ImWchar* ranges_of(const std::string& text) {
  static std::map<std::string, ImVector<ImWchar>> known;
  ImVector<ImWchar>& ranges = known[text];
  if (!ranges.empty()) return ranges.Data;
  ImFontGlyphRangesBuilder builder;
  builder.AddRanges(kLetters);
  builder.AddText(text.c_str());
  builder.BuildRanges(&ranges);
  return ranges.Data;
}

bool is_wide(const std::string& text) {
  constexpr unsigned char kThreeBytes = 0xe2;  // UTF-8 from U+3000 on
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) > kThreeBytes; });
}

void add_wide_letters(ImGuiIO& io, float height, const ImWchar* letters) {
  for (const char* file : kWideFonts) {
    if (!exists(file)) continue;
    ImFontConfig merged;
    merged.MergeMode = true;
    if (io.Fonts->AddFontFromFileTTF(file, height, &merged, letters) != nullptr) return;
  }
}

void add_font(ImGuiIO& io, float height, const ImWchar* letters = kLetters) {
  constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // fonts-dejavu-core
  if (exists(kFont) && io.Fonts->AddFontFromFileTTF(kFont, height, nullptr, letters) != nullptr) return;
  ImFontConfig plain;
  plain.SizePixels = height;
  io.Fonts->AddFontDefault(&plain);
}

void set_colours(ImGuiStyle& style) {
  const auto set = [&style](ImGuiCol_ which, float red, float green, float blue, float opacity = 1.0F) {
    style.Colors[which] = ImVec4(red, green, blue, opacity);
  };
  style.Colors[ImGuiCol_Text] = colour::kText;
  style.Colors[ImGuiCol_TextDisabled] = colour::kFaint;
  style.Colors[ImGuiCol_WindowBg] = colour::kBackground;
  set(ImGuiCol_PopupBg, 0.13F, 0.135F, 0.145F, 0.99F);
  set(ImGuiCol_Border, 0.24F, 0.25F, 0.27F);
  set(ImGuiCol_FrameBg, 0.165F, 0.17F, 0.185F);
  set(ImGuiCol_FrameBgHovered, 0.21F, 0.22F, 0.24F);
  set(ImGuiCol_FrameBgActive, 0.25F, 0.26F, 0.29F);
  set(ImGuiCol_TitleBg, 0.13F, 0.135F, 0.145F);
  set(ImGuiCol_TitleBgActive, 0.17F, 0.18F, 0.20F);
  set(ImGuiCol_Header, 0.155F, 0.165F, 0.185F);
  set(ImGuiCol_HeaderHovered, 0.21F, 0.225F, 0.25F);
  set(ImGuiCol_HeaderActive, 0.24F, 0.26F, 0.29F);
  set(ImGuiCol_Button, 0.20F, 0.215F, 0.24F);
  set(ImGuiCol_ButtonHovered, 0.26F, 0.28F, 0.315F);
  set(ImGuiCol_ButtonActive, 0.31F, 0.34F, 0.38F);
  set(ImGuiCol_CheckMark, 0.60F, 0.76F, 0.92F);
  set(ImGuiCol_SliderGrab, 0.42F, 0.47F, 0.54F);
  set(ImGuiCol_SliderGrabActive, 0.52F, 0.58F, 0.67F);
  set(ImGuiCol_Separator, 0.22F, 0.23F, 0.25F);
  set(ImGuiCol_ScrollbarBg, 0.10F, 0.105F, 0.115F, 0.0F);
  set(ImGuiCol_ScrollbarGrab, 0.25F, 0.26F, 0.28F);
  set(ImGuiCol_NavHighlight, 0.60F, 0.76F, 0.92F);
  set(ImGuiCol_TextSelectedBg, 0.26F, 0.36F, 0.48F);
  set(ImGuiCol_ModalWindowDimBg, 0.0F, 0.0F, 0.0F, 0.45F);
}

}  // namespace

ImU32 packed(const ImVec4& colour, float opacity) {
  return ImGui::ColorConvertFloat4ToU32(ImVec4(colour.x, colour.y, colour.z, colour.w * opacity));
}

void set_theme(float scale, float pixels_per_unit, const std::vector<ExtraFont>& extra) {
  ImGuiStyle style;
  style.WindowPadding = ImVec2(10.0F, 8.0F);
  style.FramePadding = ImVec2(7.0F, 3.0F);
  style.ItemSpacing = ImVec2(7.0F, 5.0F);
  style.CellPadding = ImVec2(3.0F, 2.0F);
  style.ScrollbarSize = 11.0F;
  style.WindowRounding = 0.0F;
  style.FrameRounding = 3.0F;
  style.PopupRounding = 4.0F;
  style.GrabRounding = 3.0F;
  style.WindowBorderSize = 0.0F;
  style.PopupBorderSize = 1.0F;
  style.WindowTitleAlign = ImVec2(0.0F, 0.5F);
  set_colours(style);
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  std::string letters;
  for (const ExtraFont& font : extra) letters += font.letters;
  const ImWchar* ranges = letters.empty() ? kLetters : ranges_of(letters);
  const auto add = [&](float height, bool digits) {
    add_font(io, height * scale * pixels_per_unit, digits ? kDigits : ranges);
    if (!digits && is_wide(letters)) add_wide_letters(io, height * scale * pixels_per_unit, ranges);
  };
  add(kFontHeight, false);
  for (const ExtraFont& font : extra) add(font.height, font.digits_only);
  io.FontGlobalScale = 1.0F / pixels_per_unit;
}

std::string letters_without_font(const std::string& text) {
  constexpr int kNamed = 5;
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  if (!atlas.IsBuilt()) atlas.Build();
  const ImFont& font = *atlas.Fonts.front();
  std::string missing;
  int count = 0;
  for (std::size_t at = 0; at < text.size() && count < kNamed;) {
    const auto lead = static_cast<unsigned char>(text[at]);
    const std::size_t bytes = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    const std::string letter = text.substr(at, bytes);
    at += bytes;
    if (lead < 0x80 || missing.find(letter) != std::string::npos) continue;
    unsigned code = lead & (0xffU >> (bytes + 1));
    for (std::size_t i = 1; i < letter.size(); ++i)
      code = code << 6U | (static_cast<unsigned char>(letter[i]) & 0x3fU);
    const bool found =
        code <= IM_UNICODE_CODEPOINT_MAX && font.FindGlyphNoFallback(static_cast<ImWchar>(code)) != nullptr;
    if (found) continue;
    missing += letter;
    ++count;
  }
  return missing;
}

}  // namespace palpate::app

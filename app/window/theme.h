#pragma once
#include <string>
#include <vector>

#include <imgui.h>

namespace palpate::app {

/// Dark colours with little saturation, so that they do not compete with the tissue's colour.
namespace colour {
inline const ImVec4 kBackground{0.100F, 0.105F, 0.115F, 1.0F};
inline const ImVec4 kText{0.88F, 0.89F, 0.90F, 1.0F};
inline const ImVec4 kFaint{0.60F, 0.62F, 0.65F, 1.0F};
inline const ImVec4 kGrid{0.23F, 0.24F, 0.26F, 1.0F};
inline const ImVec4 kForce{0.96F, 0.66F, 0.32F, 1.0F};
inline const ImVec4 kDepth{0.42F, 0.72F, 0.95F, 1.0F};
inline const ImVec4 kNoise{0.58F, 0.80F, 0.56F, 1.0F};
inline const ImVec4 kLaw{0.62F, 0.60F, 0.72F, 1.0F};
inline const ImVec4 kFault{0.70F, 0.14F, 0.13F, 1.0F};
inline const ImVec4 kWarning{0.95F, 0.76F, 0.36F, 1.0F};
inline const ImVec4 kGood{0.52F, 0.80F, 0.56F, 1.0F};
inline const ImVec4 kNotice{0.20F, 0.24F, 0.30F, 1.0F};
}  // namespace colour

/// [setup] Colour as draw lists need it. @param opacity 0 to 1, multiplies the colour's own
[[nodiscard]] ImU32 packed(const ImVec4& colour, float opacity = 1.0F);

/// A font besides the one of the panels.
struct ExtraFont {
  float height = 0.0F;       // window units at scale 1; the panels' font has kFontHeight
  bool digits_only = false;  // saves memory
  std::string letters = {};  // UTF-8: text whose letters the fonts need besides Latin and Greek
};
inline constexpr float kFontHeight = 15.0F;  // window units at scale 1

/// [setup] Sets style and fonts of the current ImGui context. @param scale of text and panels @param
/// pixels_per_unit pixels per window unit @param extra fonts that follow the panels' font in ImGui's list
void set_theme(float scale, float pixels_per_unit, const std::vector<ExtraFont>& extra = {});

/// [setup] The first letters of a text that the panels' font of the current context lacks, for a message:
/// "中文";
/// "" for none.
[[nodiscard]] std::string letters_without_font(const std::string& text);

}  // namespace palpate::app

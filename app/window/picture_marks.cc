#include "app/window/picture_marks.h"

#include <cstddef>
#include <cstdint>

#include <imgui.h>

#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr float kShade = 0.55F;  // opacity of the dark edge of lines, readable on bright and dark organs

ImDrawList& canvas() { return *ImGui::GetBackgroundDrawList(); }

void line(const ImVec2& a, const ImVec2& b, const ImVec4& colour, float width) {
  canvas().AddLine(a, b, packed(ImVec4(0.0F, 0.0F, 0.0F, 1.0F), kShade), width + 2.0F);
  canvas().AddLine(a, b, packed(colour), width);
}

void text(const ImVec2& at, const ImVec4& colour, const std::string& words) {
  canvas().AddText(ImVec2(at.x + 1.0F, at.y + 1.0F), packed(ImVec4(0.0F, 0.0F, 0.0F, 1.0F), kShade),
                   words.c_str());
  canvas().AddText(at, packed(colour), words.c_str());
}

ImVec4 drawn_as(MarkShapes::Colour drawn) {
  switch (drawn) {
    case MarkShapes::Colour::kForce:
      return colour::kForce;
    case MarkShapes::Colour::kX:
      return {0.93F, 0.42F, 0.40F, 1.0F};
    case MarkShapes::Colour::kY:
      return {0.55F, 0.82F, 0.45F, 1.0F};
    case MarkShapes::Colour::kZ:
      return {0.48F, 0.66F, 0.98F, 1.0F};
    case MarkShapes::Colour::kPlate:
      return {0.07F, 0.08F, 0.09F, 0.78F};
    case MarkShapes::Colour::kSteel:
      return {0.93F, 0.95F, 0.97F, 1.0F};
    case MarkShapes::Colour::kText:
      return colour::kText;
    default:
      break;
  }
  const auto layer = static_cast<std::size_t>(drawn) - static_cast<std::size_t>(MarkShapes::Colour::kLayer);
  const std::uint32_t rgb = render::kLayerColours[layer];
  const auto part = [rgb](int shift) { return static_cast<float>((rgb >> shift) & 0xFFU) / 255.0F; };
  return {part(16), part(8), part(0), 1.0F};
}

}  // namespace

void draw_marks(const Rectangle& picture, const OrbitCamera& camera, const haptics::Snapshot& shown,
                const PictureMarks& marks, NeedleMarks* needle) {
  const MarkShapes shapes =
      shapes_of(marks, {picture.width, picture.height, ImGui::GetFontSize()}, camera, shown, needle);
  const auto at = [&picture](const MarkShapes::Point& point) {
    return ImVec2(picture.x + point.x, picture.y + point.y);
  };
  canvas().PushClipRect(at({}), at({picture.width, picture.height}));
  for (const MarkShapes::Line& one : shapes.lines)
    line(at(one.from), at(one.to), drawn_as(one.colour), one.width);
  canvas().Flags &= ~ImDrawListFlags_AntiAliasedFill;  // no seams between neighbours
  for (const MarkShapes::Triangle& one : shapes.triangles) {
    canvas().AddTriangleFilled(at(one.tip), at(one.left), at(one.right), packed(drawn_as(one.colour)));
  }
  canvas().Flags |= ImDrawListFlags_AntiAliasedFill;
  for (const MarkShapes::Words& one : shapes.words) text(at(one.at), drawn_as(one.colour), one.text);
  canvas().PopClipRect();
}

void draw_hint(const Rectangle& picture, const std::string& words) {
  const float unit = ImGui::GetFontSize();
  const ImVec2 size = ImGui::CalcTextSize(words.c_str());
  if (picture.width < size.x + 4.0F * unit || picture.height < 10.0F * unit) return;
  const ImVec2 at(picture.x + 0.5F * (picture.width - size.x), picture.y + picture.height - 5.6F * unit);
  canvas().AddRectFilled(ImVec2(at.x - unit, at.y - 0.45F * unit),
                         ImVec2(at.x + size.x + unit, at.y + size.y + 0.45F * unit),
                         packed(colour::kBackground, 0.75F), 0.6F * unit);
  canvas().AddText(at, packed(colour::kText), words.c_str());
}

}  // namespace palpate::app

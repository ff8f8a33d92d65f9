#include "app/window/picture_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/core.h>
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

std::optional<ImVec2> in_picture(const Rectangle& picture, const render::Camera& camera,
                                 const Vec3& point_W) {
  const std::optional<PicturePlace> place =
      place_of(point_W, camera, static_cast<double>(picture.width) / picture.height);
  if (!place) return std::nullopt;
  return ImVec2(picture.x + static_cast<float>(place->x) * picture.width,
                picture.y + static_cast<float>(place->y) * picture.height);
}

/// Where the tissue of a contact is now, in the dent or at the end of the stretch.
Vec3 moved_W(const haptics::Snapshot& shown, const contact::ContactView& view) {
  return shown.organ_W * Vec3(view.point_S + view.depth * view.direction_S);
}

/// An arrow of the tissue's force on the tool, with its value. It begins at the deepest contact.
void draw_force(const Rectangle& picture, const render::Camera& camera, const haptics::Snapshot& shown,
                const contact::ToolResult& result) {
  constexpr double kLeastForce = 5e-3;  // N
  const double force = result.force_W.norm();
  if (result.view_count == 0 || force < kLeastForce) return;
  const auto* const deepest = std::max_element(
      result.views.begin(), result.views.begin() + result.view_count,
      [](const contact::ContactView& a, const contact::ContactView& b) { return a.depth < b.depth; });
  const Vec3 start_W = moved_W(shown, *deepest);
  const double height = 0.4 * (camera.eye - camera.target).norm();
  const double length = std::min(kArrowLength * force, 0.35 * height);
  const auto from = in_picture(picture, camera, start_W);
  const auto to = in_picture(picture, camera, start_W + length / force * result.force_W);
  if (!from || !to) return;
  const float unit = ImGui::GetFontSize();
  const ImVec2 way(to->x - from->x, to->y - from->y);
  const float far = std::hypot(way.x, way.y);
  line(*from, *to, colour::kForce, 0.16F * unit);
  if (far > 1.0F) {
    const ImVec2 along(way.x / far, way.y / far);
    const float head = 0.55F * unit;
    const ImVec2 tip(to->x + head * along.x, to->y + head * along.y);
    const ImVec2 left(to->x - 0.45F * head * along.y, to->y + 0.45F * head * along.x);
    const ImVec2 right(to->x + 0.45F * head * along.y, to->y - 0.45F * head * along.x);
    canvas().AddTriangleFilled(tip, left, right, packed(colour::kForce));
  }
  text(ImVec2(to->x + 0.7F * unit, to->y - 0.5F * unit), colour::kForce, fmt::format("{:.2f} N", force));
}

void draw_scale(const Rectangle& picture, const OrbitCamera& camera, float lower) {
  constexpr double kLongest = 0.2;  // of the picture's width
  const double per_metre = picture.height / camera.height_at_target();
  const double length = scale_bar_length(kLongest * picture.width / per_metre);
  const float unit = ImGui::GetFontSize();
  const auto wide = static_cast<float>(length * per_metre);
  const ImVec2 left(picture.x + unit, lower);
  const ImVec2 right(left.x + wide, lower);
  line(left, right, colour::kText, 2.0F);
  for (const ImVec2& end : {left, right}) {
    line(ImVec2(end.x, end.y - 0.3F * unit), ImVec2(end.x, end.y + 0.3F * unit), colour::kText, 2.0F);
  }
  text(ImVec2(left.x + 0.3F * unit, lower - 1.35F * unit), colour::kText,
       fmt::format("{:g} mm", 1e3 * length));
}

void draw_axes(const Rectangle& picture, const OrbitCamera& camera, float lower) {
  struct Axis {
    const char* name;
    ImVec4 colour;
    ImVec2 way;
    double depth;
  };
  const float unit = ImGui::GetFontSize();
  const float arm = 1.9F * unit;
  const ImVec2 middle(picture.x + picture.width - 3.2F * unit, lower - 1.6F * unit);
  const Vec3 right = camera.right();
  const Vec3 up = camera.up();
  const auto axis = [&](const char* name, const ImVec4& colour, const Vec3& direction) {
    return Axis{
        name, colour,
        ImVec2(arm * static_cast<float>(direction.dot(right)), -arm * static_cast<float>(direction.dot(up))),
        direction.dot(right.cross(up))};
  };
  std::array all{axis("x", ImVec4(0.93F, 0.42F, 0.40F, 1.0F), Vec3::UnitX()),
                 axis("y", ImVec4(0.55F, 0.82F, 0.45F, 1.0F), Vec3::UnitY()),
                 axis("z", ImVec4(0.48F, 0.66F, 0.98F, 1.0F), Vec3::UnitZ())};
  std::sort(all.begin(), all.end(), [](const Axis& a, const Axis& b) { return a.depth < b.depth; });
  for (const Axis& one : all) {
    const ImVec2 end(middle.x + one.way.x, middle.y + one.way.y);
    line(middle, end, one.colour, 2.0F);
    text(ImVec2(middle.x + 1.3F * one.way.x - 0.25F * unit, middle.y + 1.3F * one.way.y - 0.5F * unit),
         one.colour, one.name);
  }
}

bool inside(const Vec3& point_W, const render::Camera& camera, double aspect) {
  constexpr double kEdge = 0.05;  // of the picture
  const std::optional<PicturePlace> place = place_of(point_W, camera, aspect);
  return place && std::min(place->x, place->y) > kEdge && std::max(place->x, place->y) < 1.0 - kEdge;
}

}  // namespace

double scale_bar_length(double longest) {
  double length = std::pow(10.0, std::floor(std::log10(longest)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * length <= longest) return factor * length;
  }
  return length;
}

void draw_marks(const Rectangle& picture, const OrbitCamera& camera, const haptics::Snapshot& shown,
                const PictureMarks& marks) {
  const float unit = ImGui::GetFontSize();
  if (picture.width < 20.0F * unit || picture.height < 14.0F * unit) return;
  canvas().PushClipRect(ImVec2(picture.x, picture.y),
                        ImVec2(picture.x + picture.width, picture.y + picture.height));
  if (marks.force) {
    for (const contact::ToolResult& result : shown.hand_results())
      draw_force(picture, camera.camera(), shown, result);
  }
  const float lower = picture.y + picture.height - 2.6F * unit;  // above the messages
  if (marks.scale) draw_scale(picture, camera, lower);
  if (marks.axes) draw_axes(picture, camera, lower);
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

bool contacts_in_frame(const haptics::Snapshot& shown, const render::Camera& camera, double aspect) {
  constexpr double kFar = 60e-3;  // m
  for (const contact::ToolResult& result : shown.hand_results()) {
    if (result.distance > kFar) continue;
    const Vec3 tip_W = result.nearest_W + std::max(0.0, result.distance) * result.away_W;
    if (!inside(result.nearest_W, camera, aspect) || !inside(tip_W, camera, aspect)) return false;
    for (int i = 0; i < result.view_count; ++i) {
      const Vec3 moved = moved_W(shown, result.views[static_cast<std::size_t>(i)]);
      if (!inside(moved, camera, aspect)) return false;
    }
  }
  return true;
}

}  // namespace palpate::app

#include "app/window/mark_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

namespace palpate::app {
namespace {

using Colour = MarkShapes::Colour;
using Point = MarkShapes::Point;

std::optional<Point> in_picture(const PictureSize& size, const render::Camera& camera, const Vec3& point_W) {
  const std::optional<PicturePlace> place =
      place_of(point_W, camera, static_cast<double>(size.width) / size.height);
  if (!place) return std::nullopt;
  return Point{static_cast<float>(place->x) * size.width, static_cast<float>(place->y) * size.height};
}

/// Where the tissue of a contact is now, in the dent or at the end of the stretch.
Vec3 moved_W(const haptics::Snapshot& shown, const contact::ContactView& view) {
  return shown.organ_W * Vec3(view.point_S + view.depth * view.direction_S);
}

/// An arrow of the tissue's force on the tool, with its value. It begins at the deepest contact.
void add_force(MarkShapes& shapes, const PictureSize& size, const render::Camera& camera,
               const haptics::Snapshot& shown, const contact::ToolResult& result) {
  constexpr double kLeastForce = 5e-3;  // N
  const double force = result.force_W.norm();
  if (result.view_count == 0 || force < kLeastForce) return;
  const auto* const deepest = std::max_element(
      result.views.begin(), result.views.begin() + result.view_count,
      [](const contact::ContactView& a, const contact::ContactView& b) { return a.depth < b.depth; });
  const Vec3 start_W = moved_W(shown, *deepest);
  const double height = 0.4 * (camera.eye - camera.target).norm();
  const double length = std::min(kArrowLength * force, 0.35 * height);
  const auto from = in_picture(size, camera, start_W);
  const auto to = in_picture(size, camera, start_W + length / force * result.force_W);
  if (!from || !to) return;
  const float unit = size.letters;
  const Point way{to->x - from->x, to->y - from->y};
  const float far = std::hypot(way.x, way.y);
  shapes.lines.push_back({*from, *to, Colour::kForce, 0.16F * unit});
  if (far > 1.0F) {
    const Point along{way.x / far, way.y / far};
    const float head = 0.55F * unit;
    const float half = 0.45F * head;
    shapes.triangles.push_back({{to->x + head * along.x, to->y + head * along.y},
                                {to->x - half * along.y, to->y + half * along.x},
                                {to->x + half * along.y, to->y - half * along.x},
                                Colour::kForce});
  }
  shapes.words.push_back(
      {{to->x + 0.7F * unit, to->y - 0.5F * unit}, Colour::kForce, fmt::format("{:.2f} N", force)});
}

void add_scale(MarkShapes& shapes, const PictureSize& size, const OrbitCamera& camera, float lower) {
  constexpr double kLongest = 0.2;  // of the picture's width
  const double per_metre = size.height / camera.height_at_target();
  const double length = scale_bar_length(kLongest * size.width / per_metre);
  const float unit = size.letters;
  const auto wide = static_cast<float>(length * per_metre);
  const Point left{unit, lower};
  const Point right{left.x + wide, lower};
  shapes.lines.push_back({left, right, Colour::kText, 2.0F});
  for (const Point& end : {left, right}) {
    shapes.lines.push_back({{end.x, end.y - 0.3F * unit}, {end.x, end.y + 0.3F * unit}, Colour::kText, 2.0F});
  }
  shapes.words.push_back(
      {{left.x + 0.3F * unit, lower - 1.35F * unit}, Colour::kText, fmt::format("{:g} mm", 1e3 * length)});
}

void add_axes(MarkShapes& shapes, const PictureSize& size, const OrbitCamera& camera, float lower) {
  struct Axis {
    const char* name;
    Colour colour;
    Point way;
    double depth;
  };
  const float unit = size.letters;
  const float arm = 1.9F * unit;
  const Point middle{size.width - 3.2F * unit, lower - 1.6F * unit};
  const Vec3 right = camera.right();
  const Vec3 up = camera.up();
  const auto axis = [&](const char* name, Colour colour, const Vec3& direction) {
    return Axis{
        name, colour,
        Point{arm * static_cast<float>(direction.dot(right)), -arm * static_cast<float>(direction.dot(up))},
        direction.dot(right.cross(up))};
  };
  std::array all{axis("x", Colour::kX, Vec3::UnitX()), axis("y", Colour::kY, Vec3::UnitY()),
                 axis("z", Colour::kZ, Vec3::UnitZ())};
  std::sort(all.begin(), all.end(), [](const Axis& a, const Axis& b) { return a.depth < b.depth; });
  for (const Axis& one : all) {
    const Point end{middle.x + one.way.x, middle.y + one.way.y};
    shapes.lines.push_back({middle, end, one.colour, 2.0F});
    shapes.words.push_back(
        {{middle.x + 1.3F * one.way.x - 0.25F * unit, middle.y + 1.3F * one.way.y - 0.5F * unit},
         one.colour,
         one.name});
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

MarkShapes shapes_of(const PictureMarks& marks, const PictureSize& size, const OrbitCamera& camera,
                     const haptics::Snapshot& shown, NeedleMarks* needle) {
  MarkShapes shapes;
  const float unit = size.letters;
  if (size.width < 20.0F * unit || size.height < 14.0F * unit) return shapes;
  if (marks.force) {
    for (const contact::ToolResult& result : shown.hand_results())
      add_force(shapes, size, camera.camera(), shown, result);
  }
  const float lower = size.height - 2.6F * unit;  // above the messages
  if (marks.scale) add_scale(shapes, size, camera, lower);
  if (marks.axes) add_axes(shapes, size, camera, lower);
  if (needle != nullptr) needle->add(shapes, marks, size, camera.camera(), shown);
  return shapes;
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

void look_as_at_start(OrbitCamera& camera, const render::Subject& subject, const haptics::Snapshot& shown,
                      bool search, double aspect) {
  const contact::ToolResult& result = shown.results[0];
  camera.look_as(search ? tilted(render::frame_from_above(subject, shown, aspect))
                        : render::frame_contact(subject, shown, result.nearest_W, result.normal_W, false),
                 aspect);
}

}  // namespace palpate::app

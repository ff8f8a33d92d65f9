// The section along a needle, and its shaft in the tissue, as shapes over the picture.
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/base/text.h"

#include "app/window/mark_shapes.h"

namespace palpate::app {
namespace {

using Colour = MarkShapes::Colour;
using Point = MarkShapes::Point;
using render::NeedleSection;
using render::SectionPicture;

constexpr float kWide = 0.2F;        // of the picture's width
constexpr float kHigh = 0.56F;       // of its height
constexpr float kNames = 11.0F;      // letters: width of the names
constexpr float kWithNames = 44.0F;  // letters: least width of a picture that has them
constexpr std::size_t kLongestName = 22;

void add_quad(MarkShapes& shapes, const std::array<Point, 4>& around, Colour colour) {
  shapes.triangles.push_back({around[0], around[1], around[2], colour});
  shapes.triangles.push_back({around[0], around[2], around[3], colour});
}

Colour colour_of(std::size_t layer) {
  return static_cast<Colour>(static_cast<std::size_t>(Colour::kLayer) + layer % model::kMaxTissueLayers);
}

/// Where the section is in the picture.
struct Frame {
  Point corner;  // of the layers, upper left
  float scale;   // pixels per metre
  double depth;

  [[nodiscard]] Point at(const SectionPicture::Point& point) const {
    const double across = std::clamp(point.across, -NeedleSection::kHalfWidth, NeedleSection::kHalfWidth);
    const double along = std::clamp(point.along, -NeedleSection::kAbove, depth);
    return {corner.x + scale * static_cast<float>(across + NeedleSection::kHalfWidth),
            corner.y + scale * static_cast<float>(along + NeedleSection::kAbove)};
  }
};

void add_needle(MarkShapes& shapes, const Frame& frame, const SectionPicture& section) {
  if (section.tip.along < -NeedleSection::kAbove) return;
  constexpr float kThinnest = 2.0F;  // pixels
  const SectionPicture::Point& tip = section.tip;
  const double length = tip.along - section.hub.along;
  const double visible = std::min(1.0, length > 0.0 ? (tip.along + NeedleSection::kAbove) / length : 0.0);
  const Point low = frame.at(tip);
  const Point high = frame.at({tip.across + visible * (section.hub.across - tip.across),
                               tip.along + visible * (section.hub.along - tip.along)});
  const float half = std::max(kThinnest, frame.scale * static_cast<float>(section.diameter)) / 2.0F;
  const float shoulder = std::max(high.y, low.y - 4.0F * half);
  add_quad(shapes,
           {{{high.x - half, high.y},
             {high.x + half, high.y},
             {low.x + half, shoulder},
             {low.x - half, shoulder}}},
           Colour::kSteel);
  shapes.triangles.push_back({low, {low.x - half, shoulder}, {low.x + half, shoulder}, Colour::kSteel});
}

/// Names beside the middle of the outermost piece of each layer, where it is first from the left; without
/// overlap.
void add_names(MarkShapes& shapes, const Frame& frame, const SectionPicture& section,
               const std::vector<model::TissueLayer>& layers, float unit) {
  float lowest = frame.corner.y;
  const float end = frame.at({0.0, frame.depth}).y - unit;
  for (std::size_t i = 0; i < std::min(layers.size(), section.bands.size()); ++i) {
    const SectionPicture::Band& band = section.bands[i];
    std::size_t column = 0;
    const auto thickness = [&] { return frame.at(band.inner[column]).y - frame.at(band.outer[column]).y; };
    while (column + 1 < band.outer.size() && thickness() < 1.0F) ++column;
    if (thickness() < 1.0F) continue;
    const float outer = frame.at(band.outer[column]).y;
    const float inner = frame.at(band.inner[column]).y;
    const float y = std::max(0.5F * (outer + inner - unit), lowest);
    if (y > end) return;
    lowest = y + 1.1F * unit;
    const bool here = section.layer == i;
    shapes.words.push_back({{frame.corner.x - kNames * unit, y},
                            here ? Colour::kForce : Colour::kText,
                            excerpt(layers[i].name, kLongestName)});
  }
}

/// The name of the layer at the tip alone, below a narrow section.
void add_name_at_tip(MarkShapes& shapes, const PictureSize& size, const std::string& name, Point below) {
  constexpr float kLetter = 0.6F;  // its width
  const float right = size.width - size.letters * (0.5F + kLetter * static_cast<float>(name.size()));
  shapes.words.push_back({{std::max(0.0F, std::min(below.x, right)), below.y}, Colour::kForce, name});
}

void add_section(MarkShapes& shapes, const PictureSize& size, const SectionPicture& section, double depth,
                 const std::vector<model::TissueLayer>& layers) {
  const float unit = size.letters;
  const bool named = size.width > kWithNames * unit;
  const auto width = static_cast<float>(2.0 * NeedleSection::kHalfWidth);
  const auto height = static_cast<float>(depth + NeedleSection::kAbove);
  const float names = named ? kNames * unit : 0.0F;
  const float scale = std::min(kWide * size.width / width, kHigh * size.height / height);
  const Frame frame{{size.width - 1.5F * unit - scale * width, 3.0F * unit}, scale, depth};
  const Point low = {size.width - unit, frame.corner.y + scale * height + 0.5F * unit};
  const float left = frame.corner.x - names - 0.5F * unit;
  const float top = frame.corner.y - 0.5F * unit;
  add_quad(shapes, {{{left, top}, {low.x, top}, low, {left, low.y}}}, Colour::kPlate);
  for (const SectionPicture::Band& band : section.bands) {
    for (std::size_t i = 0; i + 1 < band.outer.size(); ++i) {
      add_quad(shapes,
               {{frame.at(band.outer[i]), frame.at(band.outer[i + 1]), frame.at(band.inner[i + 1]),
                 frame.at(band.inner[i])}},
               colour_of(band.layer));
    }
  }
  add_needle(shapes, frame, section);
  if (named) {
    add_names(shapes, frame, section, layers, unit);
  } else if (section.layer) {
    add_name_at_tip(shapes, size, excerpt(layers[*section.layer].name, kLongestName),
                    {left, low.y + 0.3F * unit});
  }
}

/// A dashed line from where the shaft enters the tissue to its tip.
void add_shaft(MarkShapes& shapes, const PictureSize& size, const render::Camera& camera, const Vec3& entry_W,
               const Vec3& tip_W) {
  constexpr int kPieces = 13;
  const double aspect = static_cast<double>(size.width) / size.height;
  std::optional<Point> before;
  for (int i = 0; i <= kPieces; ++i) {
    const auto place = place_of(entry_W + (tip_W - entry_W) * i / kPieces, camera, aspect);
    if (!place) return;
    const Point now{static_cast<float>(place->x) * size.width, static_cast<float>(place->y) * size.height};
    if (before && i % 2 == 1) shapes.lines.push_back({*before, now, Colour::kSteel, 0.16F * size.letters});
    before = now;
  }
}

}  // namespace

std::optional<NeedleMarks> NeedleMarks::of(const scene::Scene& scene, const contact::World& world) {
  if (scene.tissue.layers.empty()) return std::nullopt;
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    if (scene.tools[hand].needle) {
      return NeedleMarks(hand, *scene.tools[hand].needle, scene.tissue, world.rest_distance());
    }
  }
  return std::nullopt;
}

NeedleMarks::NeedleMarks(std::size_t hand, const geometry::Needle& needle,
                         const model::TissueParameters& tissue, const geometry::SignedDistance& rest)
    : hand_(hand),
      needle_(needle),
      layers_(tissue.layers),
      section_(rest, tissue.layers, needle, tissue.reach) {}

void NeedleMarks::add(MarkShapes& shapes, const PictureMarks& marks, const PictureSize& size,
                      const render::Camera& camera, const haptics::Snapshot& shown) {
  if (hand_ >= shown.hands) return;
  const contact::ToolResult& result = shown.results[hand_];
  const std::span views(result.views.data(), static_cast<std::size_t>(result.view_count));
  const Pose& handle_W = shown.tools[hand_].pose_W;
  if (marks.inside && !views.empty()) {
    const contact::ContactView& view = views.front();
    add_shaft(shapes, size, camera, shown.organ_W * Vec3(view.point_S + view.depth * view.direction_S),
              handle_W * needle_.tip);
  }
  if (!marks.section) return;
  if (const auto section = section_.picture(shown.organ_W.inverse() * handle_W, views)) {
    add_section(shapes, size, *section, section_.depth(), layers_);
  }
}

}  // namespace palpate::app

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/contact/contact.h"
#include "io/scene/make_world.h"
#include "io/scene/organ_distance.h"
#include "view/render/needle_section.h"
#include "view/report/page.h"
#include "view/report/sections.h"

namespace palpate::report {
namespace {

/// u [m]: negative where the needle draws the tissue outwards.
double displacement_of(const haptics::TickRow& row) {
  if (static_cast<contact::Phase>(row.phase) != contact::Phase::kInsert) return row.depth;
  return -row.distance < row.inserted_mm / kMilli ? -row.depth : row.depth;
}

/// The rows of the three sections; the last two are missing where the needle did not go that far.
std::array<std::optional<std::size_t>, 3> moments_of(const HandAnalysis& hand) {
  std::array<std::optional<std::size_t>, 3> found;
  const auto better = [&hand](std::optional<std::size_t> known, std::size_t i, double sign, auto value) {
    return !known || sign * value(hand.rows[i]) > sign * value(hand.rows[*known]) ? i : *known;
  };
  for (std::size_t i = 0; i < hand.rows.size(); ++i) {
    const auto phase = static_cast<contact::Phase>(hand.rows[i].phase);
    if (phase == contact::Phase::kPress && !found[1]) found[0] = better(found[0], i, 1.0, displacement_of);
    if (phase != contact::Phase::kInsert) continue;
    found[1] = better(found[1], i, 1.0, [](const haptics::TickRow& row) { return row.inserted_mm; });
    if (displacement_of(hand.rows[i]) < 0.0) found[2] = better(found[2], i, -1.0, displacement_of);
  }
  return found;
}

/// The section of a row.
std::optional<render::SectionPicture> section_at(const haptics::TickRow& row, const geometry::Tool& tool,
                                                 const Pose& organ_W, render::NeedleSection& section) {
  const auto vector = [](const std::array<double, 3>& v) { return Vec3(v[0], v[1], v[2]); };
  const double moved = displacement_of(row);
  contact::ContactView view;
  view.point_S = organ_W.inverse() * vector(row.contact);
  view.direction_S = organ_W.rotation.conjugate() * Vec3(-std::copysign(1.0, moved) * vector(row.normal));
  view.depth = std::abs(moved);
  view.tip_radius = contact::tip_radius_of(tool);
  view.half_width = tool.needle->diameter / 2.0;
  const Pose handle_W{Quat(row.tool_q[0], row.tool_q[1], row.tool_q[2], row.tool_q[3]), vector(row.tool)};
  return section.picture(organ_W.inverse() * handle_W, {&view, 1});
}

/// The tables of a panel and the curves that draw them.
void add_panel(const render::SectionPicture& section, const std::string& name, std::vector<PlotData>& data,
               std::string& script) {
  std::vector<std::string> curves;
  for (const render::SectionPicture::Band& band : section.bands) {
    PlotData table{fmt::format("{}-{}.dat", name, data.size()), {}};
    for (std::size_t i = 0; i < band.outer.size(); ++i) {
      table.rows.push_back(
          {band.outer[i].across * kMilli, band.outer[i].along * kMilli, band.inner[i].along * kMilli});
    }
    curves.push_back(fmt::format("'{}' using 1:2:3 with filledcurves lc rgb '#{:06x}' notitle", table.name,
                                 render::kLayerColours[band.layer % render::kLayerColours.size()]));
    data.push_back(std::move(table));
  }
  const double half = section.diameter / 2.0;
  const render::SectionPicture::Point way{section.hub.across - section.tip.across,
                                          section.hub.along - section.tip.along};
  const double length = std::hypot(way.across, way.along);
  const double shoulder = std::min(2.0 * section.diameter / length, 1.0);
  PlotData needle{name + "-needle.dat", {}};
  const auto add = [&](double along, double side) {
    needle.rows.push_back({(section.tip.across + along * way.across + side * half) * kMilli,
                           (section.tip.along + along * way.along) * kMilli});
  };
  add(0.0, 0.0);
  add(shoulder, 1.0);
  add(1.0, 1.0);
  add(1.0, -1.0);
  add(shoulder, -1.0);
  add(0.0, 0.0);
  curves.push_back("'" + needle.name + "' using 1:2 with filledcurves closed lc rgb '#3b4148' notitle");
  data.push_back(std::move(needle));
  script += plot(curves);
}

}  // namespace

Figure draw_sections(const HandAnalysis& hand, const scene::Scene& scene, const std::filesystem::path& file) {
  const geometry::Tool& tool = scene.tools[hand.hand];
  render::NeedleSection section(scene::organ_distance_of(scene), scene.tissue.layers, *tool.needle,
                                scene.tissue.reach);
  const model::OrganMotion motion = scene::organ_motion_of(scene);
  constexpr std::array kTitles{"before the puncture", "deepest", "on the way out"};
  std::vector<PlotData> data;
  std::string script = preamble(800, 460, "off");
  script += fmt::format(
      "unset grid\nset xrange [{0}:{1}]\nset yrange [{2}:{3}]\nset size ratio -1\nset xlabel 'across (mm)' "
      "offset 0,0.4\nset ylabel 'along the needle (mm)' offset 1\nset xtics 10\nset multiplot layout 1,4 "
      "margins 0.08,0.9,0.15,0.9 spacing 0.05\n",
      -render::NeedleSection::kHalfWidth * kMilli, render::NeedleSection::kHalfWidth * kMilli,
      section.depth() * kMilli, -render::NeedleSection::kAbove * kMilli);
  const auto moments = moments_of(hand);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (!moments[i]) continue;
    const haptics::TickRow& row = hand.rows[*moments[i]];
    const Pose organ_W = motion.pose_at(scene.organ_pose, row.tick, scene.rate_Hz);
    const auto picture = section_at(row, tool, organ_W, section);
    if (!picture) continue;
    script += fmt::format("set title '{}, {} s' offset 0,-0.5\n", kTitles[i], brief(row.time, 3));
    add_panel(*picture, "panel" + std::to_string(i), data, script);
    script += "unset ylabel\n";
  }
  script +=
      "unset title\nunset border\nunset tics\nunset xlabel\nset size noratio\nset key at graph "
      "0,1 left top Left reverse samplen 1 spacing 1.3 font ',12'\n";
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.tissue.layers.size(); ++i) {
    names.push_back(fmt::format("1/0 with boxes fs solid lc rgb '#{:06x}' title {}", render::kLayerColours[i],
                                quoted(excerpt(one_line(scene.tissue.layers[i].name), 22))));
  }
  script += plot(names) + "unset multiplot\n";
  Figure figure{file, "Sections along the needle, with the layers of the tissue"};
  figure.caption =
      "The tissue's layers in a plane through the needle. The tissue moves with the surface at the needle: "
      "inwards until a layer gives way, outwards while friction holds the shaft on the way out.";
  return drawn(figure, script, data);
}

}  // namespace palpate::report

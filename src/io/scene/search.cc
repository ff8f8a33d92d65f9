#include "io/scene/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "core/base/philox.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/scene/minimum_jerk.h"
#include "io/scene/organ_distance.h"
#include "io/scene/scene_keys.h"
#include "io/scene/variation_reader.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr double kTravelHeight = 10e-3;  // m, above everything nearby, between presses

/// Points where a vertical line enters and leaves the organ.
struct Crossing {
  double top = 0.0;     // m, height in the world
  double bottom = 0.0;  // m
  std::int32_t triangle = -1;
};

/// Vertical lines through an organ in its pose.
class VerticalLines final {
 public:
  VerticalLines(const geometry::TriangleMesh& organ, const geometry::SignedDistance& distance,
                const Pose& organ_pose)
      : surface_(distance), to_organ_(organ_pose.inverse()) {
    geometry::TriangleMesh placed = organ;
    geometry::transform(placed, organ_pose);
    box_ = geometry::bounds(placed);
  }

  [[nodiscard]] const geometry::Bounds& box() const noexcept { return box_; }

  [[nodiscard]] std::optional<Crossing> at(double x, double y) const {
    constexpr double kMargin = 10e-3;  // m, beyond the bounding box at both ends
    const Vec3 high(x, y, box_.high.z() + kMargin);
    const Vec3 low(x, y, box_.low.z() - kMargin);
    const auto from_above = surface_.first_entry(to_organ_ * high, to_organ_ * low);
    const auto from_below = surface_.first_entry(to_organ_ * low, to_organ_ * high);
    if (!from_above || !from_below) return std::nullopt;
    const double length = high.z() - low.z();
    return Crossing{high.z() - from_above->fraction * length, low.z() + from_below->fraction * length,
                    from_above->triangle};
  }

 private:
  geometry::SignedDistance surface_;
  Pose to_organ_;
  geometry::Bounds box_;
};

bool is_flat_enough(const geometry::TriangleMesh& organ, const Pose& pose, std::int32_t triangle) {
  constexpr double kCosine = 0.5;  // of 60 degrees
  const Vec3 area = geometry::area_vector_doubled(organ, organ.triangles[static_cast<std::size_t>(triangle)]);
  return (pose.rotation * area).z() > kCosine * area.norm();
}

Vec3 middle_of(const geometry::TriangleMesh& organ, const geometry::Triangle& triangle) {
  Vec3 middle = Vec3::Zero();
  for (const std::int32_t v : triangle) middle += organ.vertices[static_cast<std::size_t>(v)] / 3.0;
  return middle;
}

/// A random point of the search area, uniform over its area: a pure function of seed and number.
class RandomPlaces final {
 public:
  RandomPlaces(const geometry::TriangleMesh& organ, const SearchArea& area, std::uint64_t seed)
      : organ_(organ), area_(area), seed_(seed) {
    double sum = 0.0;
    for (const std::int32_t t : area.triangles()) {
      sum += geometry::area_vector_doubled(organ, organ.triangles[static_cast<std::size_t>(t)]).norm();
      sums_.push_back(sum);
    }
  }

  [[nodiscard]] Vec3 at(std::uint32_t number) const {
    constexpr std::uint32_t kStream = 0x6c75'6d70;  // differs from the touch noise's
    const PhiloxCounter words =
        philox4x32({number, kStream, 0, 0},
                   {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
    const auto unit = [](std::uint32_t word) { return (word + 0.5) * 0x1p-32; };
    const auto found = std::upper_bound(sums_.begin(), sums_.end(), unit(words[0]) * sums_.back());
    const auto place = static_cast<std::size_t>(std::min(found, sums_.end() - 1) - sums_.begin());
    const geometry::Triangle& corners = organ_.triangles[static_cast<std::size_t>(area_.triangles()[place])];
    const auto corner = [&](std::size_t i) { return organ_.vertices[static_cast<std::size_t>(corners[i])]; };
    const double root = std::sqrt(unit(words[1]));
    const double share = unit(words[2]);
    return (1.0 - root) * corner(0) + root * (1.0 - share) * corner(1) + root * share * corner(2);
  }

 private:
  const geometry::TriangleMesh& organ_;
  const SearchArea& area_;
  std::uint64_t seed_;
  std::vector<double> sums_;
};

/// One press of the search path.
struct SearchPress {
  Vec3 touch = Vec3::Zero();  // in the world
  double depth = 0.0;         // m
  double height = 0.0;        // m, in the world, above everything nearby
};

/// The highest point of the organ within `radius` of a vertical line, by samples.
double highest_near(const VerticalLines& lines, double x, double y, double radius) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const double share : {0.0, 0.5, 1.0}) {
    for (int k = 0; k < 8; ++k) {
      const double angle = 0.25 * portable::kPi * k;
      const double r = share * radius;
      const auto hit = lines.at(x + r * std::cos(angle), y + r * std::sin(angle));
      if (hit) highest = std::max(highest, hit->top);
    }
  }
  return highest;
}

/// Whether a tool that comes down there meets the search area all around: not at its rim.
bool is_inside(const VerticalLines& lines, const SearchArea& area, double x, double y) {
  constexpr double kRim = 5e-3;  // m
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.25 * portable::kPi * k;
    const auto hit = lines.at(x + kRim * std::cos(angle), y + kRim * std::sin(angle));
    if (!hit || !area.contains(hit->triangle)) return false;
  }
  return true;
}

std::vector<SearchPress> presses_at(const VerticalLines& lines, const SearchArea& area, double spacing) {
  constexpr double kDepth = 8e-3;       // m
  constexpr double kOfThickness = 0.4;  // largest share of the thickness
  std::vector<SearchPress> presses;
  const geometry::Bounds& box = lines.box();
  const int rows = std::max(1, static_cast<int>(box.size().y() / spacing));
  const int along = std::max(1, static_cast<int>(box.size().x() / spacing));
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < along; ++i) {
      const int column = row % 2 == 0 ? i : along - 1 - i;  // to and fro
      const double x = box.middle().x() + (column - 0.5 * (along - 1)) * spacing;
      const double y = box.middle().y() + (row - 0.5 * (rows - 1)) * spacing;
      const std::optional<Crossing> hit = lines.at(x, y);
      if (!hit || !is_inside(lines, area, x, y)) continue;
      presses.push_back({Vec3(x, y, hit->top), std::min(kDepth, kOfThickness * (hit->top - hit->bottom)),
                         kTravelHeight + highest_near(lines, x, y, spacing)});
    }
  }
  return presses;
}

std::vector<SearchPress> presses_of(const VerticalLines& lines, const Scene& scene) {
  constexpr std::size_t kMax = 60;
  constexpr double kMaxColumns = 4000.0;
  constexpr double kClosest = 8e-3;  // m, between two presses
  const SearchArea area(scene.organ, organ_distance_of(scene), scene.organ_pose);
  const Vec3 size = lines.box().size();
  const double coarse = std::sqrt(size.x() * size.y() / kMaxColumns);  // of a very large organ
  for (double spacing = std::max(kClosest, coarse);; spacing *= 1.1) {
    std::vector<SearchPress> presses = presses_at(lines, area, spacing);
    if (presses.empty()) throw InputError("task palpate: a tool from above meets no flat part of the organ");
    if (presses.size() <= kMax) return presses;
  }
}

}  // namespace

SearchTable read_search(const std::optional<TomlTable>& table) {
  SearchTable search;
  std::string preset = "nodule";
  if (table) {
    search.given = true;
    table->allow_only(keys_in("search"));
    search.where = table->location("") + ": search";
    preset = table->text("preset").value_or(preset);
  }
  const std::optional<InclusionTable> known = find_inclusion_preset(preset);
  if (!known && !table) throw std::logic_error("read_search: there is no preset \"" + preset + "\"");
  if (!known) table->fail("preset", "must be " + inclusion_preset_names());
  search.lump = known->setup.inclusion;
  search.depth = known->depth;
  if (!table) return search;
  const auto read = [&](const char* key, double unit, double& value) {
    if (const auto given = number_in(*table, key)) value = *given * unit;
  };
  const auto whole = [&](const char* key, std::uint64_t largest) {
    const auto given = table->whole_number(key);
    if (given && *given > largest) table->fail(key, "must be 0 to " + std::to_string(largest));
    return given;
  };
  search.lumps = whole("lumps", model::kMaxInclusions);
  read("radius_mm", kMillimetre, search.lump.radius);
  read("stiffness_ratio", 1.0, search.lump.ratio);
  read("depth_mm", kMillimetre, search.depth);
  read("tolerance_mm", kMillimetre, search.setup.tolerance);
  if (const auto button = whole("mark_button", kLastButton)) {
    search.setup.mark_button = static_cast<std::uint32_t>(*button);
  }
  try {
    model::validate(search.lump);
  } catch (const ParameterError& error) {
    table->fail(error);
  }
  return search;
}

SearchArea::SearchArea(const geometry::TriangleMesh& organ, const geometry::SignedDistance& distance,
                       const Pose& organ_pose)
    : inside_(organ.triangles.size(), false) {
  constexpr double kSame = 0.1e-3;  // m, between a triangle's middle and the entry of the vertical line
  const VerticalLines lines(organ, distance, organ_pose);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(organ.triangles.size()); ++t) {
    if (!is_flat_enough(organ, organ_pose, t)) continue;
    const Vec3 middle = organ_pose * middle_of(organ, organ.triangles[static_cast<std::size_t>(t)]);
    const std::optional<Crossing> hit = lines.at(middle.x(), middle.y());
    if (!hit || hit->top > middle.z() + kSame) continue;
    inside_[static_cast<std::size_t>(t)] = true;
    triangles_.push_back(t);
  }
}

void hide_inclusions(const SearchTable& table, Scene& scene) {
  constexpr std::uint32_t kTries = 1000;
  const bool has_hidden = std::any_of(scene.inclusions.begin(), scene.inclusions.end(),
                                      [](const InclusionSetup& one) { return !one.visible; });
  const std::size_t wanted = table.lumps.value_or(has_hidden ? 0 : scene.task == Task::kInsert ? 1 : 3);
  if (scene.inclusions.size() + wanted > model::kMaxInclusions) {
    throw InputError(fmt::format("{}.lumps = {}: there are {} inclusions already, must be at most {} in all",
                                 table.where, wanted, scene.inclusions.size(), model::kMaxInclusions));
  }
  if (wanted == 0) return;
  const geometry::SignedDistance surface = organ_distance_of(scene);
  const SearchArea area(scene.organ, surface, scene.organ_pose);
  const RandomPlaces places(scene.organ, area, scene.seed);
  std::size_t hidden = 0;
  for (std::uint32_t number = 0; number < kTries && hidden < wanted && !area.triangles().empty(); ++number) {
    const geometry::NearestPoint top = surface.nearest(places.at(number));
    InclusionSetup made{"lump " + std::to_string(hidden + 1), false, table.lump};
    made.inclusion.centre_S = top.point - table.depth * mean_normal(scene.organ, top, table.depth);
    const geometry::NearestPoint above = surface.nearest(made.inclusion.centre_S);
    const bool inside = -above.distance >= made.inclusion.radius + made.inclusion.pulse;
    if (!inside || !area.contains(above.triangle)) continue;
    const bool apart =
        std::all_of(scene.inclusions.begin(), scene.inclusions.end(), [&](const InclusionSetup& other) {
          const double distance = (other.inclusion.centre_S - made.inclusion.centre_S).norm();
          return distance > std::max(2.0 * table.setup.tolerance + made.inclusion.radius,
                                     other.inclusion.radius + made.inclusion.radius);
        });
    if (!apart) continue;
    scene.inclusions.push_back(std::move(made));
    ++hidden;
  }
  if (hidden < (table.lumps ? wanted : 1)) {
    throw InputError(fmt::format(
        "{}.lumps = {}: only {} of {} mm radius have room {} mm below the organ's upper side: must be fewer, "
        "smaller or at another depth",
        table.where, wanted, hidden, brief(table.lump.radius / kMillimetre, 3),
        brief(table.depth / kMillimetre, 3)));
  }
}

std::vector<PathRow> search_path(const Scene& scene, std::size_t hand, const Vec3& tip) {
  constexpr double kPeakSpeed = 60e-3;  // m/s
  constexpr double kRowSpacing = 5e-3;  // s
  const Quat down(0.0, 1.0, 0.0, 0.0);  // tool +z down
  std::vector<PathRow> rows;
  const auto move_to = [&](double x, double y, double height) {
    const Vec3 to = Vec3(x, y, height) - tip;
    if (rows.empty()) {
      rows.push_back({0.0, to, down});
      return;
    }
    const PathRow from = rows.back();
    // 1.875 is the largest slope of minimum_jerk().
    const double duration = std::max(kRowSpacing, 1.875 * (to - from.position).norm() / kPeakSpeed);
    const int steps = static_cast<int>(std::ceil(duration / kRowSpacing));
    for (int i = 1; i <= steps; ++i) {
      const double u = static_cast<double>(i) / steps;
      rows.push_back(
          {from.time + u * duration, from.position + minimum_jerk(u) * (to - from.position), down});
    }
  };
  const VerticalLines lines(scene.organ, organ_distance_of(scene), scene.organ_pose);
  const std::vector<SearchPress> presses = presses_of(lines, scene);
  const std::size_t first = std::min(presses.size() - 1, presses.size() * hand / scene.tools.size());
  const std::size_t last = std::max(first + 1, presses.size() * (hand + 1) / scene.tools.size());
  for (std::size_t i = first; i < last; ++i) {
    const auto& [touch, depth, height] = presses[i];
    if (i > first) {
      const SearchPress& before = presses[i - 1];
      const double over = std::max(before.height, height);
      move_to(before.touch.x(), before.touch.y(), over);
      move_to(touch.x(), touch.y(), over);
    } else {
      // From above the middle, so that a mouse, which begins there, reaches all around.
      const Vec3 middle = lines.box().middle();
      const double over = lines.box().high.z() + kTravelHeight;
      if (scene.tools.size() == 1) move_to(middle.x(), middle.y(), over);
      move_to(touch.x(), touch.y(), over);
    }
    move_to(touch.x(), touch.y(), touch.z() - depth);
  }
  move_to(presses[last - 1].touch.x(), presses[last - 1].touch.y(), presses[last - 1].height);
  return rows;
}

}  // namespace palpate::scene

#include "io/scene/default_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/core.h>

#include "core/geometry/cell.h"
#include "io/scene/approach.h"
#include "io/scene/device_kinds.h"
#include "io/scene/minimum_jerk.h"
#include "io/scene/organ_distance.h"
#include "io/scene/plausibility.h"
#include "io/scene/search.h"
#include "palpate/spring_law.h"
#include "palpate/tool_path.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr double kClearance = 10e-3;  // m, above the surface at the start and the end
constexpr double kTravel = 12e-3;     // m, of depth or lift
constexpr double kInsertion = 60e-3;  // m, of a needle
constexpr double kInsideShare = 0.7;  // of the organ's thickness: a needle stays inside
constexpr double kEntryTravel = 1.2;  // of the depth at which the surface gives way: where the organ is thick
                                      // enough for it, kInsideShare of the thickness is deeper than that
constexpr double kTouchDepth = 0.2e-3;  // m, depth of the tool's lowest point when the jaws close
constexpr double kHold = 1.0;           // s, at the deepest or highest point
constexpr double kTurnJaws = 0.3;       // s, to open or close
constexpr double kPause = 0.1;          // s, between motion and closing
constexpr double kPeakSpeed = 15e-3;    // m/s, a slow motion
constexpr double kRowSpacing = 5e-3;    // s
constexpr double kHandSpacing = 30e-3;  // m, largest distance between two hands
constexpr double kTipHeight = 0.2e-3;   // m: the vertices within this height of the lowest one are the tip

/// A part of the path: height [m] above the surface point and gripper at its end, and its duration [s].
struct Leg {
  double height = 0.0;
  double gripper = 0.0;
  double duration = 0.0;
  Vec3 aside = Vec3::Zero();  // m, across the motion, from that surface point
};

/// Duration of a minimum-jerk motion over `distance` [m] whose speed stays at or below the peak speed; 1.875
/// is the largest slope of minimum_jerk().
double time_for(double distance) { return 1.875 * distance / kPeakSpeed; }

/// Tool +z down: a rotation by 180 degrees about x.
Quat downwards() { return {0.0, 1.0, 0.0, 0.0}; }

/// The tip of the closed tool that points down, relative to the handle, in world directions: the mean of its
/// lowest vertices, at the height of the lowest.
Vec3 lowest_point(const geometry::Tool& tool) {
  const Quat down = downwards();
  std::vector<Vec3> points;
  double lowest = std::numeric_limits<double>::infinity();
  for (const geometry::ToolPart& part : tool.parts) {
    const Pose pose = geometry::part_pose(part, 0.0);
    for (const Vec3& vertex : part.mesh.vertices) {
      points.push_back(down * (pose * vertex));
      lowest = std::min(lowest, points.back().z());
    }
  }
  if (points.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const Vec3& p : points) {
    if (p.z() > lowest + kTipHeight) continue;
    sum += p;
    count += 1.0;
  }
  return {sum.x() / count, sum.y() / count, lowest};
}

/// Where a hand comes down: the organ's centre; several hands side by side along its longer side.
Vec3 column_of(const geometry::Bounds& box, std::size_t hand, std::size_t hands) {
  Vec3 place = box.middle();
  if (hands < 2) return place;
  const Eigen::Index along = box.size().y() > box.size().x() ? 1 : 0;
  const double spacing = std::min(kHandSpacing, box.size()(along) / (static_cast<double>(hands) + 1.0));
  place(along) += spacing * (static_cast<double>(hand) - 0.5 * (static_cast<double>(hands) - 1.0));
  return place;
}

/// The highest point of the organ on the vertical line; its highest vertex if the line misses the organ (a
/// ring's centre).
Vec3 surface_below(const Scene& scene, const geometry::SignedDistance& surface, const geometry::Bounds& box,
                   const Vec3& column) {
  constexpr double kMargin = 10e-3;  // m, beyond the bounding box at both ends
  const Pose to_organ = scene.organ_pose.inverse();
  const Vec3 top(column.x(), column.y(), box.high.z() + kMargin);
  const Vec3 bottom(column.x(), column.y(), box.low.z() - kMargin);
  if (const auto entry = surface.first_entry(to_organ * top, to_organ * bottom)) {
    return {column.x(), column.y(), top.z() + entry->fraction * (bottom.z() - top.z())};
  }
  Vec3 highest(0.0, 0.0, -std::numeric_limits<double>::infinity());
  for (const Vec3& vertex : scene.organ.vertices) {
    const Vec3 placed = scene.organ_pose * vertex;
    if (placed.z() > highest.z()) highest = placed;
  }
  return highest;
}

/// Sample points [m] of the closed tool that points down, relative to `tip`.
std::vector<Vec3> hanging_points(const geometry::Tool& tool, const Vec3& tip) {
  constexpr double kLongest = 5e-3;  // m, of an edge: a long shaft may have vertices only at its ends
  constexpr double kSpacing = 2e-3;  // m, approximate
  std::vector<Vec3> points;
  std::set<geometry::Cell> taken;
  for (const geometry::ToolPart& part : tool.parts) {
    const Pose pose = geometry::part_pose(part, 0.0);
    for (const Vec3& vertex : geometry::refine(part.mesh, kLongest).vertices) {
      const Vec3 point = downwards() * (pose * vertex) - tip;
      if (taken.insert(geometry::cell_at(point, kSpacing)).second) points.push_back(point);
    }
  }
  return points;
}

/// Way of a needle to the scene's target.
struct Aim {
  Vec3 aside = Vec3::Zero();  // m, across the approach, from where the path would go in without a target
  double depth = 0.0;         // m, along the approach, from its touch
};

/// The start of a hand's path, in the world.
struct PressPoint {
  Approach approach;
  double depth = kTravel;    // m, of the press or the insertion
  std::string remark{};      // about a press at this point; empty: nothing to report
  bool square = true;        // the tool meets the surface squarely to the whole travel
  std::optional<Aim> aim{};  // a needle goes there instead
};

std::string thin_warning(double thickness) {
  return fmt::format(
      "the organ is {:.2g} mm thick where the default path presses it {:.3g} mm deep, and thicker nowhere "
      "that the tool meets squarely",
      thickness / kMillimetre, kTravel / kMillimetre);
}

std::string depth_warning(double depth) {
  return fmt::format(
      "the organ is too thin or too curved for a default path {:.3g} mm deep: the tool meets it squarely "
      "nowhere; the path presses {:.3g} mm deep",
      kTravel / kMillimetre, depth / kMillimetre);
}

/// Displacement [m] of the tissue under a needle with this depth inside and this force on its tip [N].
double displacement_under(const Scene& scene, double depth, double on_tip) {
  double force = on_tip;
  double low = 0.0;
  for (const model::TissueLayer& layer : scene.tissue.layers) {
    if (depth <= low) break;
    force += layer.friction + layer.friction_per_length * (std::min(depth, low + layer.thickness) - low);
    low += layer.thickness;
  }
  return model::SpringLaw(scene.tissue, model::Direction::kPress, 1.0 / scene.rate_Hz)
      .deformation_under(force)
      .depth;
}

/// Just into the target's layer, or to the centre of the first target: there the tip is as deep as the path
/// less the tissue's displacement.
std::optional<Aim> aim_of(const Scene& scene, const Approach& approach) {
  constexpr double kInto = 1.2e-3;  // m
  double low = 0.0;
  double cutting = 0.0;  // N, of the layer before
  for (const model::TissueLayer& layer : scene.tissue.layers) {
    if (layer.name == scene.target.layer) {
      const double on_tip = std::max(cutting, layer.puncture_force);
      return Aim{Vec3::Zero(), low + kInto + displacement_under(scene, low, on_tip)};
    }
    low += layer.thickness;
    cutting = layer.cutting_force;
  }
  const auto hidden = std::find_if(scene.inclusions.begin(), scene.inclusions.end(),
                                   [](const InclusionSetup& one) { return !one.visible; });
  const auto target = hidden != scene.inclusions.end() ? hidden : scene.inclusions.begin();
  if (target == scene.inclusions.end()) return std::nullopt;
  const Vec3 way = scene.organ_pose * target->inclusion.centre_S - approach.touch;
  const double depth = way.dot(approach.direction);
  const double on_tip = target->inclusion.ratio * scene.tissue.layers.back().cutting_force;
  return Aim{way - depth * approach.direction, depth + displacement_under(scene, depth, on_tip)};
}

/// How far a needle goes in: kInsertion, or less in a thin organ, so that it stays inside.
double insertion_depth(const Scene& scene, const geometry::SignedDistance& surface,
                       const Approach& approach) {
  constexpr double kStep = 1e-3;  // m
  const Pose to_organ = scene.organ_pose.inverse();
  double thickness = kStep;
  const auto is_inside = [&](double depth) {
    return surface.nearest(to_organ * Vec3(approach.touch + depth * approach.direction)).distance < 0.0;
  };
  while (kInsideShare * thickness < kInsertion && is_inside(thickness)) thickness += kStep;
  return std::min(kInsertion, kInsideShare * thickness);
}

/// Way [m] of a needle's tip that leaves its hub out of the tissue.
double way_to_hub(const Scene& scene, std::size_t hand) {
  constexpr double kMargin = 1e-3;  // m
  const double inside = scene.tools[hand].needle->length - kMargin;
  double low = 0.0;
  for (const model::TissueLayer& layer : scene.tissue.layers) {
    low += layer.thickness;
    if (inside < low) return inside + displacement_under(scene, inside, layer.cutting_force);
  }
  return inside;  // the last layer has no end
}

/// Depth [m] at which the surface gives way to a needle that presses it squarely.
double entry_depth(const Scene& scene) {
  return displacement_under(scene, 0.0, scene.tissue.layers.front().puncture_force);
}

std::string insertion_warning(const PressPoint& place, double entry, bool is_short) {
  if (place.depth <= entry) {
    return fmt::format(
        "the {} that the needle goes only {:.2g} mm deep, and the surface gives way at {:.3g} mm: give a {}",
        is_short ? "needle is so short" : "organ is so thin where the default path enters it",
        place.depth / kMillimetre, entry / kMillimetre, is_short ? "longer needle" : "path");
  }
  if (is_short) {
    return fmt::format(
        "the needle is so short that the default path ends {:.2g} mm deep, where its hub stays out of the "
        "tissue: give a longer needle",
        (place.aim ? place.aim->depth : place.depth) / kMillimetre);
  }
  if (place.square) return {};
  return fmt::format(
      "the surface gives way to the needle at {:.3g} mm, and the needle meets it squarely to that depth "
      "nowhere: it may slide off the default path before it enters, give a path",
      entry / kMillimetre);
}

/// By default from above the organ's centre. A tool that would slide off there, or start inside, gets the
/// best approach of ApproachFinder; if none allows the whole travel [m], one with a smaller depth.
PressPoint square_point_of(const Scene& scene, const geometry::SignedDistance& surface,
                           const HangingTool& tool, const Vec3& touch, double travel) {
  constexpr int kDepths = 12;  // trial depths
  PressPoint place{{touch, -Vec3::UnitZ()}, travel};
  const ApproachFinder finder(scene.organ, surface, tool);
  const Pose to_organ = scene.organ_pose.inverse();
  const Approach above{to_organ * touch, to_organ.rotation * place.approach.direction};
  for (int k = kDepths; k > 0; --k) {
    const double depth = travel * k / kDepths;
    const ApproachCheck from_above = finder.check(above, depth);
    if (from_above.thick && k == kDepths) return place;
    ApproachCheck taken = from_above;
    if (!from_above.thick) {
      const auto [approach, result] = finder.best(-above.direction, depth);
      if (result.thick || !from_above.square) {
        if (!result.square) continue;
        taken = result;
        place.approach = {scene.organ_pose * approach.touch, scene.organ_pose.rotation * approach.direction};
      }
    }
    place.depth = depth;
    place.square = k == kDepths;
    if (!place.square) {
      place.remark = depth_warning(depth);
    } else if (!taken.thick) {
      place.remark = thin_warning(taken.thickness);
    }
    return place;
  }
  place.square = false;
  place.remark =
      "the tool meets the organ squarely nowhere: the default path comes from above and may slide off";
  return place;
}

PressPoint press_point_of(const Scene& scene, std::size_t hand, const Vec3& tip) {
  const geometry::SignedDistance surface = organ_distance_of(scene);
  const geometry::Bounds box = organ_box(scene);
  const Vec3 touch = surface_below(scene, surface, box, column_of(box, hand, scene.tools.size()));
  const bool inserts = scene.task == Task::kInsert;
  const double entry = inserts ? entry_depth(scene) : 0.0;
  PressPoint place{{touch, -Vec3::UnitZ()}};
  if (scene.task != Task::kPull && scene.tools.size() == 1) {
    const HangingTool tool{hanging_points(scene.tools[hand], tip), kClearance};
    place = square_point_of(scene, surface, tool, touch, inserts ? kEntryTravel * entry : kTravel);
  }
  if (inserts) {
    const double to_hub = way_to_hub(scene, hand);
    place.depth = std::min(insertion_depth(scene, surface, place.approach), to_hub);
    if (scene.tools.size() == 1) place.aim = aim_of(scene, place.approach);
    const bool is_short = std::max(place.depth, place.aim ? place.aim->depth : 0.0) >= to_hub;
    if (place.aim) place.aim->depth = std::min(place.aim->depth, to_hub);
    place.remark = insertion_warning(place, entry, is_short);
  }
  return place;
}

std::vector<Leg> legs_of(Task task, double depth) {
  const double approach = kClearance + (task == Task::kPull ? kTouchDepth : depth);
  if (task != Task::kPull) {
    return {{-depth, 0.0, time_for(approach)}, {-depth, 0.0, kHold}, {kClearance, 0.0, time_for(approach)}};
  }
  const double top = kTravel - kTouchDepth;
  return {{-kTouchDepth, 1.0, time_for(approach)}, {-kTouchDepth, 1.0, kPause},
          {-kTouchDepth, 0.0, kTurnJaws},          {-kTouchDepth, 0.0, kPause},
          {top, 0.0, time_for(kTravel)},           {top, 0.0, kHold},
          {-kTouchDepth, 0.0, time_for(kTravel)},  {-kTouchDepth, 1.0, kTurnJaws},
          {kClearance, 1.0, time_for(approach)}};
}

/// Height [m] of the whole organ above the touch, against the direction of the approach.
double height_over(const Scene& scene, const Approach& approach) {
  double most = 0.0;
  for (const Vec3& vertex : scene.organ.vertices)
    most = std::max(most, (approach.touch - scene.organ_pose * vertex).dot(approach.direction));
  return most;
}

/// A needle's, by way of a height over the whole organ where the target is aside. The start is the same
/// wherever the target hides.
std::vector<Leg> legs_to(const Aim& aim, double top) {
  const Vec3& aside = aim.aside;
  const double low = -aim.depth;
  if (aside.norm() == 0.0) return legs_of(Task::kInsert, aim.depth);
  return {{top, 0.0, time_for(top), Vec3::Zero()},
          {top, 0.0, time_for(aside.norm()), aside},
          {low, 0.0, time_for(top - low), aside},
          {low, 0.0, kHold, aside},
          {top, 0.0, time_for(top - low), aside}};
}

}  // namespace

std::vector<std::string> default_path_remarks(const Scene& scene) {
  std::vector<std::string> remarks;
  if (scene.task == Task::kPalpate) return remarks;
  for (std::size_t hand = 0; hand < scene.tools.size(); ++hand) {
    const DeviceKind* kind = find_device_kind(scene.devices[hand].kind);
    if (kind == nullptr || kind->path != DevicePath::kToolPath || !scene.devices[hand].path.empty()) continue;
    const std::string remark = press_point_of(scene, hand, lowest_point(scene.tools[hand])).remark;
    if (!remark.empty()) remarks.push_back("device " + scene.devices[hand].kind + ": " + remark);
  }
  return remarks;
}

Vec3 default_touch(const Scene& scene, std::size_t hand) {
  return press_point_of(scene, hand, lowest_point(scene.tools[hand])).approach.touch;
}

ToolPath default_path(const Scene& scene, std::size_t hand) {
  const Vec3 tip = lowest_point(scene.tools[hand]);
  const DeviceSetup& device = scene.devices[hand];
  const Pose to_device = device.base.inverse();
  if (scene.task == Task::kPalpate) {
    std::vector<PathRow> rows = search_path(scene, hand, tip);
    for (PathRow& row : rows) {
      row.position = (to_device * row.position) / device.workspace_scale;
      row.orientation = to_device.rotation * row.orientation;
    }
    return ToolPath(std::move(rows));
  }
  const PressPoint place = press_point_of(scene, hand, tip);
  const Vec3& direction = place.approach.direction;
  const Quat turn = turn_from_down(direction);
  const Vec3 handle_at_touch = place.approach.touch - turn * tip;
  const Quat orientation = turn * downwards();

  std::vector<PathRow> rows;
  const auto add = [&](double time, double height, double gripper, const Vec3& aside) {
    const Vec3 handle_W = handle_at_touch - height * direction + aside;
    rows.push_back(
        {time, (to_device * handle_W) / device.workspace_scale, to_device.rotation * orientation, gripper});
  };
  Leg from{kClearance, scene.task == Task::kPull ? 1.0 : 0.0, 0.0};
  double start = 0.0;
  add(start, from.height, from.gripper, from.aside);
  const double top = height_over(scene, place.approach) + 2.0 * kClearance;
  for (const Leg& leg : place.aim ? legs_to(*place.aim, top) : legs_of(scene.task, place.depth)) {
    const int steps = std::max(1, static_cast<int>(std::ceil(leg.duration / kRowSpacing)));
    for (int i = 1; i <= steps; ++i) {
      const double u = static_cast<double>(i) / steps;
      const double way = minimum_jerk(u);
      add(start + u * leg.duration, (1.0 - way) * from.height + way * leg.height,
          (1.0 - way) * from.gripper + way * leg.gripper, (1.0 - way) * from.aside + way * leg.aside);
    }
    start += leg.duration;
    from = leg;
  }
  return ToolPath(std::move(rows));
}

}  // namespace palpate::scene

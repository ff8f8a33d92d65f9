#include "io/mesh_io/repair/repair_components.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/repair/crossings.h"
#include "palpate/units.h"

namespace palpate::mesh_io {
namespace {

constexpr double kSmall = 0.01;  // of the largest component's volume; of an open one, of the surface's area
constexpr std::size_t kMaxComponents = 32;  // that are not small
constexpr double kMaxCrossing = 0.05;       // of the surface's area
constexpr double kNoVolume = 1e-9;          // of the surface's area to the power of 3/2

struct Component {
  double volume = 0.0;
  double area = 0.0;
  std::size_t triangles = 0;
  Box box;
};

/// The components, each at the index of its smallest triangle; other entries stay empty.
std::vector<Component> measured(const WorkSurface& surface, const std::vector<std::uint32_t>& component_of) {
  std::vector<Component> components(*std::max_element(component_of.begin(), component_of.end()) + 1);
  for (std::uint32_t t = 0; t < component_of.size(); ++t) {
    Component& component = components[component_of[t]];
    const Vec3& origin = surface.point_at(3 * component_of[t]);  // on the component, against cancellation
    const Vec3 doubled = geometry::area_vector_doubled(surface.mesh, surface.mesh.triangles[t]);
    component.volume += (surface.point_at(3 * t) - origin).dot(doubled) / 6.0;
    component.area += 0.5 * doubled.norm();
    ++component.triangles;
    for (const std::int32_t v : surface.mesh.triangles[t]) component.box.add(surface.point(v));
  }
  return components;
}

void turn_outwards(WorkSurface& surface, const std::vector<std::uint32_t>& component_of,
                   std::vector<Component>& components) {
  for (std::size_t t = 0; t < component_of.size(); ++t) {
    if (components[component_of[t]].volume < 0.0) surface.turn(t);
  }
  for (Component& component : components) component.volume = std::abs(component.volume);
}

RepairCount drop_components(WorkSurface& surface, const std::vector<std::uint32_t>& component_of,
                            const std::vector<std::uint8_t>& goes) {
  RepairCount done;
  std::vector<std::uint8_t> doomed(component_of.size());
  for (std::uint32_t t = 0; t < component_of.size(); ++t) {
    doomed[t] = goes[component_of[t]];
    done.times += component_of[t] == t && doomed[t] != 0 ? 1 : 0;
  }
  done.triangles = surface.drop(doomed);
  return done;
}

/// Whether a point is inside a component, by the winding number.
bool is_inside(const WorkSurface& surface, const std::vector<std::uint32_t>& component_of,
               std::uint32_t component, const Vec3& p) {
  double half_angles = 0.0;
  for (std::uint32_t t = 0; t < component_of.size(); ++t) {
    if (component_of[t] != component) continue;
    half_angles += half_solid_angle(surface.point_at(3 * t) - p, surface.point_at(3 * t + 1) - p,
                                    surface.point_at(3 * t + 2) - p);
  }
  constexpr double kHalfTurn = 3.141592653589793;
  return half_angles > kHalfTurn;
}

void drop_small(WorkSurface& surface, bool is_one, ComponentRepairs& done) {
  const std::vector<std::uint32_t> component_of =
      is_one ? std::vector<std::uint32_t>(surface.mesh.triangles.size(), 0)
             : components_of(pair_half_edges(surface));
  std::vector<Component> components = measured(surface, component_of);
  turn_outwards(surface, component_of, components);
  double largest = 0.0;
  double whole = 0.0;
  for (const Component& component : components) {
    largest = std::max(largest, component.volume);
    whole += component.volume;
  }
  const double area = surface.area();
  if (!(largest > kNoVolume * area * std::sqrt(area))) {
    done.refusal = "it encloses no volume";
    return;
  }
  std::vector<std::uint8_t> goes(components.size(), 0);
  for (std::size_t t = 0; t < components.size(); ++t) {
    if (components[t].triangles == 0) continue;
    if (components[t].volume <= kSmall * largest) {
      goes[t] = 1;
      done.small_share += components[t].volume / whole;
    } else {
      ++done.kept;
    }
  }
  done.small = drop_components(surface, component_of, goes);
  if (done.kept > kMaxComponents) {
    done.refusal = fmt::format("it is {} separate components of like size, at most {} can be one organ",
                               done.kept, kMaxComponents);
    done.remedy = "join parts in a mesh tool, or leave some out";
  }
}

/// Drops components inside others, unless they intersect them.
void drop_inner(WorkSurface& surface, const std::vector<std::uint32_t>& component_of,
                ComponentRepairs& done) {
  const std::vector<Component> components = measured(surface, component_of);
  std::vector<std::uint8_t> goes(components.size(), 0);
  for (std::uint32_t inner = 0; inner < components.size(); ++inner) {
    for (std::uint32_t outer = 0; outer < components.size() && components[inner].triangles > 0; ++outer) {
      if (outer == inner || components[outer].triangles == 0 || goes[inner] != 0) continue;
      if (!components[outer].box.holds(components[inner].box) ||
          components[outer].volume <= components[inner].volume)
        continue;
      if (is_inside(surface, component_of, outer, surface.point_at(3 * inner))) goes[inner] = 1;
    }
  }
  done.inner = drop_components(surface, component_of, goes);
  done.kept -= done.inner.times;
}

void account_for(const WorkSurface& surface, const Crossings& crossings, ComponentRepairs& done) {
  done.crossing_pairs = crossings.pairs.size();
  std::vector<std::uint8_t> crosses(surface.mesh.triangles.size(), 0);
  for (const auto& [s, t] : crossings.pairs) crosses[s] = crosses[t] = 1;
  double area = 0.0;
  for (std::size_t t = 0; t < crosses.size(); ++t) area += crosses[t] != 0 ? surface.area(t) : 0.0;
  done.crossing_share = area / surface.area();
}

/// Refuses a surface whose crossing triangles part it into an outer and an inside-out patch: there the tissue
/// would be outside.
void refuse_inside_out(const WorkSurface& surface, const Crossings& crossings, ComponentRepairs& done) {
  constexpr double kLarge = 0.01;  // of the surface's area
  Opposites opposite = pair_half_edges(surface);
  for (const auto& pair : crossings.pairs) {
    for (const std::uint32_t t : pair) {
      for (Corner c = 3 * t; c < 3 * t + 3; ++c) {
        if (opposite[c] != kNoOpposite) opposite[opposite[c]] = kNoOpposite;
        opposite[c] = kNoOpposite;
      }
    }
  }
  const std::vector<std::uint32_t> patch_of = components_of(opposite);
  std::vector<double> area(patch_of.size(), 0.0);
  std::vector<std::uint32_t> largest(patch_of.size());  // triangle of each patch
  for (std::uint32_t t = 0; t < patch_of.size(); ++t) {
    const std::uint32_t patch = patch_of[t];
    if (area[patch] == 0.0 || surface.area(t) > surface.area(largest[patch])) largest[patch] = t;
    area[patch] += surface.area(t);
  }
  const double whole = surface.area();
  for (std::size_t patch = 0; patch < area.size(); ++patch) {
    if (!(area[patch] > kLarge * whole)) continue;
    const std::uint32_t at = largest[patch];
    const Vec3 middle =
        (surface.point_at(3 * at) + surface.point_at(3 * at + 1) + surface.point_at(3 * at + 2)) / 3.0;
    double half_angles = 0.0;  // of all others: behind the triangle is one turn more than before it
    for (std::uint32_t t = 0; t < patch_of.size(); ++t) {
      if (t == at) continue;
      half_angles += half_solid_angle(surface.point_at(3 * t) - middle, surface.point_at(3 * t + 1) - middle,
                                      surface.point_at(3 * t + 2) - middle);
    }
    if (half_angles > 0.0) continue;
    const Vec3 mm = middle / kMillimetre;
    done.refusal = fmt::format(
        "it goes through itself (at {} pairs of triangles), and {} of its surface, around ({:.3g}, {:.3g}, "
        "{:.3g}) mm, is inside out",
        crossings.pairs.size(), percent(area[patch] / whole), mm.x(), mm.y(), mm.z());
    return;
  }
}

}  // namespace

RepairCount drop_small_open_components(WorkSurface& surface, const Opposites& opposite) {
  const std::vector<std::uint32_t> component_of = components_of(opposite);
  std::vector<double> area(component_of.size(), 0.0);
  std::vector<std::uint8_t> is_open(component_of.size(), 0);
  for (Corner c = 0; c < opposite.size(); ++c) {
    if (opposite[c] == kNoOpposite) is_open[component_of[c / 3]] = 1;
  }
  double whole = 0.0;
  for (std::size_t t = 0; t < component_of.size(); ++t) {
    area[component_of[t]] += surface.area(t);
    whole += surface.area(t);
  }
  const auto largest = static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
  for (std::size_t t = 0; t < area.size(); ++t) {
    if (t == largest || area[t] > kSmall * whole) is_open[t] = 0;
  }
  return drop_components(surface, component_of, is_open);
}

ComponentRepairs clean_components(WorkSurface& surface, bool is_one) {
  ComponentRepairs done;
  drop_small(surface, is_one, done);
  if (!done.refusal.empty()) return done;
  Crossings crossings = find_crossings(surface.mesh);
  if (done.kept > 1) {
    const std::vector<std::uint32_t> component_of = components_of(pair_half_edges(surface));
    const auto joins_two = [&](const auto& pair) { return component_of[pair[0]] != component_of[pair[1]]; };
    if (std::any_of(crossings.pairs.begin(), crossings.pairs.end(), joins_two)) {
      account_for(surface, crossings, done);
      done.refusal = fmt::format("{} of its components go through each other (at {} pairs of triangles)",
                                 done.kept, crossings.pairs.size());
      return done;
    }
    drop_inner(surface, component_of, done);
    if (done.inner.times > 0) crossings = find_crossings(surface.mesh);
  }
  account_for(surface, crossings, done);
  if (!crossings.all || done.crossing_share > kMaxCrossing) {
    done.refusal = fmt::format("{}{} pairs of its triangles go through each other",
                               crossings.all ? "" : "at least ", done.crossing_pairs);
  } else if (done.crossing_pairs > 0) {
    refuse_inside_out(surface, crossings, done);
  }
  return done;
}

}  // namespace palpate::mesh_io

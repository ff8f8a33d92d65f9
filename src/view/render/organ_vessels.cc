// How a vertex takes the colour of a vessel.
//
// A great vessel is a tube around its line: a vertex on its wall is as far from the line as the tube's radius
// there, one on the organ beside it farther. So the colour fades from 0.3 mm to 3 mm outside the tube, which
// makes a soft edge at the vessel's root, at any resolution of the mesh.
//
// A coronary vessel is narrower than the distance of two vertices. Its colour cannot be the vertices': the
// picture would show beads. Each vertex stores how far it lies to the side of the line instead, in radii and
// with a sign. That is linear across the line, so it can be interpolated over a triangle, and the shader
// draws the vessel where its amount is below 1:
//
//                     n (normal)
//         o---.       |      .---o      o vertices, x the line; side = (p - x) . (t x n) / radius,
//        -2.2  '---.  x  .---'  +1.9    t along the line
//
// The depth of the line under the surface does not count, so a vessel shows on a coarse mesh as well, which
// does not have its relief. Another byte fades the vessel beside the line (where the sign jumps between two
// vessels) and beyond its ends. The fat around a vessel is a colour of the vertices: it has no sharp edge.
#include "view/render/organ_vessels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/deform/surface_parts.h"

namespace palpate::render {
namespace {

using Eigen::Vector3f;

constexpr float kMillimetre = 1e-3F;  // m
constexpr float kWidest = 3.0F;       // radii that a byte spans to each side
// m: a line farther under the surface, or above it, belongs to another part of the organ; fades from half of
// this
constexpr float kFarOff = 3.2e-3F;
constexpr float kTaper = 15e-3F;  // m before its end over which a vessel becomes thin
constexpr float kRise = 4e-3F;    // m from its start over which a vessel appears, out of the one before it
constexpr float kThin = 0.35F;    // of its radius, at the end

float clamped_ramp(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

std::uint8_t share_byte(float share) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(share, 0.0F, 1.0F)));
}

// The place of a line that is nearest to a point.
struct LinePlace {
  Vector3f offset = Vector3f::Zero();  // from the line to the point [m]
  Vector3f along = Vector3f::Zero();   // unit
  float radius = 0.0F;                 // m
  float beyond = 0.0F;                 // m past an end of the line
  float run = 0.0F;                    // m along the line from its start
  float left = 0.0F;                   // m along the line to its end
};

LinePlace nearest_on(const std::vector<VesselKnot>& line, const Vector3f& p) {
  LinePlace best;
  float least = std::numeric_limits<float>::infinity();
  float run = 0.0F;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector3f from = kMillimetre * Vector3f(line[i].x, line[i].y, line[i].z);
    const Vector3f piece = kMillimetre * Vector3f(line[i + 1].x, line[i + 1].y, line[i + 1].z) - from;
    const float length = piece.norm();
    const float place = (p - from).dot(piece) / (length * length);
    const float inside = std::clamp(place, 0.0F, 1.0F);
    const Vector3f offset = p - from - inside * piece;
    run += length;
    if (offset.squaredNorm() >= least) continue;
    least = offset.squaredNorm();
    const float radius = line[i].radius + inside * (line[i + 1].radius - line[i].radius);
    const bool at_end = (i == 0 && place < 0.0F) || (i + 2 == line.size() && place > 1.0F);
    best = {offset,
            piece / length,
            kMillimetre * radius,
            at_end ? std::abs(place - inside) * length : 0.0F,
            run - (1.0F - inside) * length,
            0.0F};
  }
  best.left = run - best.run;
  return best;
}

Vector3f colour_of(VesselKind kind) {  // linear
  switch (kind) {
    case VesselKind::kArtery:
      return {0.50F, 0.24F, 0.18F};  // a thick pale wall
    case VesselKind::kVein:
      return {0.20F, 0.095F, 0.115F};  // dark blood through a thin wall
    case VesselKind::kDuct:
      return {0.47F, 0.36F, 0.19F};
    case VesselKind::kCoronary:
      break;
  }
  return Vector3f::Zero();
}

void mix_colour(StaticVertex& vertex, const Vector3f& colour, float share) {
  for (std::size_t k = 0; k < 3; ++k) {
    const float root = static_cast<float>(vertex.colour[k]) / 255.0F;
    const float mixed = root * root + share * (colour[static_cast<Eigen::Index>(k)] - root * root);
    vertex.colour[k] = share_byte(std::sqrt(mixed));
  }
}

// @return how far the vertex is the vessel's, 0 to 1
float paint_great_vessel(const OrganVessel& vessel, const LinePlace& place, StaticVertex& vertex) {
  const float share = (1.0F - clamped_ramp(0.3e-3F, 3e-3F, place.offset.norm() - place.radius)) *
                      (1.0F - clamped_ramp(1.5F, 3.0F, place.beyond / place.radius));
  mix_colour(vertex, colour_of(vessel.kind), 0.9F * share);
  vertex.colour[3] = share_byte((1.0F - share) * static_cast<float>(vertex.colour[3]) / 255.0F);
  vertex.light[1] = share_byte((1.0F - 3.0F * share) * static_cast<float>(vertex.light[1]) / 255.0F);
  return share;
}

// A vertex beside a coronary vessel.
struct Beside {
  float side = 0.0F;    // radii
  float share = 0.0F;   // of the vessel's colour
  float around = 0.0F;  // of the fat
};

Beside beside(const LinePlace& place, const Vector3f& normal) {
  const float high = place.offset.dot(normal);
  const float own = 1.0F - clamped_ramp(0.5F * kFarOff, kFarOff, std::abs(high));
  const Vector3f across = place.along.cross(normal);
  if (!(across.squaredNorm() > 1e-6F)) return {};
  const float thin = kThin + (1.0F - kThin) * clamped_ramp(0.0F, kTaper, place.left);
  const float side = place.offset.dot(across.normalized()) / (thin * place.radius);
  const float faded =
      own * (1.0F - clamped_ramp(0.0F, 2e-3F, place.beyond)) * clamped_ramp(0.0F, kRise, place.run);
  const float wide = (place.offset - high * normal).norm();
  const float thick = clamped_ramp(0.7e-3F, 2.0e-3F, place.radius);
  return {side, faded * (1.0F - clamped_ramp(0.6F * kWidest, 0.9F * kWidest, std::abs(side))),
          own * thick * (1.0F - clamped_ramp(1.5e-3F, 8e-3F, wide + place.beyond))};
}

std::string_view without_detail(std::string_view organ_name) {
  for (const std::string_view ending : {"-30k", "-300k"}) {
    if (organ_name.ends_with(ending)) return organ_name.substr(0, organ_name.size() - ending.size());
  }
  return organ_name;
}

}  // namespace

const std::vector<OrganVessel>& organ_vessels() {
  static const std::vector<OrganVessel> vessels = {
#include "view/render/organ_vessels.inc"
  };
  return vessels;
}

void paint_vessels(std::string_view organ_name, const geometry::TriangleMesh& rest,
                   const TissueAppearance& look, std::vector<StaticVertex>& pattern) {
  std::vector<const OrganVessel*> own;
  for (const OrganVessel& vessel : organ_vessels())
    if (vessel.organ == without_detail(organ_name)) own.push_back(&vessel);
  if (own.empty()) return;
  const std::vector<Vec3> normals = deform::vertex_normals(rest);
  for (std::size_t v = 0; v < pattern.size(); ++v) {
    StaticVertex& vertex = pattern[v];
    Beside nearest;
    float second = 0.0F;  // share of the next coronary vessel
    float fat = 0.0F;
    float other = 0.0F;  // share of great vessels
    for (const OrganVessel* vessel : own) {
      const LinePlace place = nearest_on(vessel->line, vertex.rest);
      if (vessel->kind != VesselKind::kCoronary) {
        other = std::max(other, paint_great_vessel(*vessel, place, vertex));
        continue;
      }
      const Beside here = beside(place, normals[v].cast<float>());
      fat = std::max(fat, here.around);
      second = std::max(second, std::min(here.share, nearest.share));
      if (here.share > nearest.share) nearest = here;
    }
    // Between two vessels the sign jumps.
    nearest.share *=
        1.0F - clamped_ramp(0.0F, 0.3F, second) * clamped_ramp(1.0F, 1.3F, std::abs(nearest.side));
    const float patches = 0.75F + 0.5F * smooth_noise(vertex.rest * 160.0F).value;
    const float share = std::clamp(0.7F * fat * patches, 0.0F, 0.75F) * (1.0F - other);
    mix_colour(vertex, look.fat, share);
    vertex.colour[3] = std::max(vertex.colour[3], share_byte(share));
    vertex.light[2] = share_byte(0.5F + 0.5F * nearest.side / kWidest);
    vertex.light[3] = share_byte(nearest.share * (1.0F - clamped_ramp(0.1F, 0.5F, other)));
  }
}

}  // namespace palpate::render

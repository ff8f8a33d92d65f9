#include "palpate/deform/live_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpate::deform {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

constexpr std::size_t kBlock = 64;             // vertices that count as changed together
constexpr std::size_t kTableSize = 1024;       // entries a R_6
constexpr float kSameContact = 8e-3F;          // m: a contact this near to one of a frame ago is that one
constexpr float kNewFront = 1.5e-3F;           // m: moved farther than this from where its front began
constexpr double kImprintReach = 20e-3;        // m: fronts under a press go at least as far, for near()
constexpr std::size_t kMostContacts = 24;      // kept, with their fronts
constexpr double kFreeShareOfThickness = 0.7;  // as held_back

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

std::vector<Vector3f> angle_weighted_normals(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> sums(mesh.vertices.size(), Vec3::Zero());
  for (const geometry::Triangle& t : mesh.triangles) {
    const std::array<Vec3, 3> edge = {mesh.vertices[index(t[1])] - mesh.vertices[index(t[0])],
                                      mesh.vertices[index(t[2])] - mesh.vertices[index(t[1])],
                                      mesh.vertices[index(t[0])] - mesh.vertices[index(t[2])]};
    const Vec3 area = edge[0].cross(edge[1]);
    const double doubled = area.norm();
    if (!(doubled > 0.0)) continue;
    for (std::size_t k = 0; k < 3; ++k)
      sums[index(t[k])] += (std::atan2(doubled, -edge[k].dot(edge[(k + 2) % 3])) / doubled) * area;
  }
  std::vector<Vector3f> normals;
  normals.reserve(sums.size());
  for (const Vec3& sum : sums) normals.emplace_back(sum.normalized().cast<float>());
  return normals;
}

// Negative when it goes inwards.
float signed_length(const Vector3f& displacement, const Vector3f& normal) {
  return displacement.dot(normal) < 0.0F ? -displacement.norm() : displacement.norm();
}

// The adjugate's transpose of F = I + J times n: the normal of a surface moved by F, not of unit length.
Vector3f carried_normal(const Matrix3f& j, const Vector3f& n) {
  const Vector3f u = n.unitOrthogonal();
  const Vector3f v = n.cross(u);
  return (u + j * u).cross(v + j * v);
}

}  // namespace

ProfileTable::ProfileTable(const model::ReachParameters& reach, double rounding)
    : per_entry_(static_cast<float>(kTableSize)) {
  const SurfaceProfile profile(reach, 1.0, 1.0);
  const auto count = static_cast<std::size_t>(std::ceil(static_cast<double>(kTableSize) / (1.0 - rounding)));
  const auto u_at = [&](double i) {
    return profile.rounded_at(std::abs(i) / static_cast<double>(kTableSize) * profile.reach(), rounding);
  };
  for (std::size_t i = 0; i <= count + 1; ++i) {
    const double x = static_cast<double>(i);
    values_.push_back({static_cast<float>(u_at(x)), static_cast<float>((u_at(x + 0.5) - u_at(x - 0.5)) *
                                                                       static_cast<double>(kTableSize))});
  }
}

float ProfileTable::where(float share) const noexcept {
  const auto end = std::partition_point(values_.begin(), values_.end(),
                                        [share](const Value& value) { return value.u >= share; });
  return static_cast<float>(end - values_.begin()) / per_entry_;
}

// One contact, kept as long as it is near where it was, with what it knows of distances.
struct LiveSurface::Contact {
  explicit Contact(const FrontSurface& surface) : front(surface), next(surface) {}

  GeodesicFront front;
  GeodesicFront next;
  bool begun = false;
  bool next_runs = false;
  bool used = false;
  std::uint64_t last_used = 0;
  SurfacePoint place;
  Vector3f point = Vector3f::Zero();        // now
  Vector3f normal_part = Vector3f::Zero();  // displacement at the contact across the surface [m]
  Vector3f side_part = Vector3f::Zero();    // and along it [m]
  float depth = 0.0F;                       // [m]
  float reach = 0.0F;                       // R_6 [m]
  float side_reach = 0.0F;                  // the same of the side part [m]
  float wanted = 0.0F;                      // how far the front must come [m]
  float own_excess = 0.0F;                  // of the way along the surface over the straight one [m]
  float lowered = 0.0F;                     // u/D where the front ends
  float lowered_side = 0.0F;

  [[nodiscard]] float excess(const FrontSurface& surface, std::int32_t v) const noexcept {
    return front.at(v) - (surface.vertices[index(v)] - front.source()).norm();
  }
  // Vertices of the front that may be nearer than `radius` [m] to the contact as it is now.
  [[nodiscard]] std::span<const std::int32_t> within(float radius) const {
    const float limit = radius + (point - front.source()).norm();
    const auto settled = front.settled();
    const auto end = std::partition_point(settled.begin(), settled.end(),
                                          [&](std::int32_t v) { return front.at(v) < limit; });
    return settled.first(static_cast<std::size_t>(end - settled.begin()));
  }
  // What the contact does to one vertex; false: nothing.
  struct Effect {
    Vector3f displacement;
    Vector3f along;    // unit, in the surface, away from the contact
    Vector3f derived;  // of the displacement along it
  };
  bool effect(const FrontSurface& surface, const ProfileTable& profile, std::size_t settled,
              const Vector3f& normal, Effect& out) const noexcept;
};

bool LiveSurface::Contact::effect(const FrontSurface& surface, const ProfileTable& profile,
                                  std::size_t settled, const Vector3f& normal, Effect& out) const noexcept {
  const Vector3f offset = surface.vertices[index(front.settled()[settled])] - point;
  const float straight = offset.norm();
  const float r = straight + std::max(0.0F, front.excess()[settled] - own_excess);
  const ProfileTable::Value across = profile.at(r / reach);
  const ProfileTable::Value side = profile.at(r / side_reach);
  const float up = std::max(0.0F, (across.u - lowered) / (1.0F - lowered));
  const float up_side = std::max(0.0F, (side.u - lowered_side) / (1.0F - lowered_side));
  if (!(up > 0.0F) && !(up_side > 0.0F)) return false;
  out.displacement = up * normal_part + up_side * side_part;
  out.derived.setZero();
  if (up > 0.0F) out.derived += (across.slope / (reach * (1.0F - lowered))) * normal_part;
  if (up_side > 0.0F) out.derived += (side.slope / (side_reach * (1.0F - lowered_side))) * side_part;
  out.along = offset - offset.dot(normal) * normal;
  const float squared = out.along.squaredNorm();
  out.along *= squared > 1e-14F ? 1.0F / std::sqrt(squared) : 0.0F;
  return true;
}

// Of the contacts that move one vertex, weighted by the eighth powers of their displacements in mm.
struct LiveSurface::Sums {
  float weight = 0.0F;
  Vector3f displacement = Vector3f::Zero();
  Matrix3f derivative = Matrix3f::Zero();
  Vector3f weight_slope = Vector3f::Zero();
};

LiveSurface::LiveSurface(geometry::TriangleMesh rest, const model::ReachParameters& reach, double rounding)
    : rest_(std::move(rest)),
      grid_(rest_),
      surface_(rest_),
      reach_(reach),
      profile_(reach, rounding),
      end_(profile_.where(kLeastShare)),
      rest_normals_(angle_weighted_normals(rest_)),
      is_moved_(rest_.vertices.size(), 0),
      changed_block_(rest_.vertices.size() / kBlock + 1, 0) {
  vertices_.reserve(rest_.vertices.size());
  for (std::size_t v = 0; v < rest_.vertices.size(); ++v)
    vertices_.push_back(LiveVertex{surface_.vertices[v], rest_normals_[v], 0.0F});
  for (std::size_t v = 0; v < rest_.vertices.size(); v += kBlock) mark(static_cast<std::int32_t>(v));
}

LiveSurface::~LiveSurface() = default;

void LiveSurface::mark(std::int32_t vertex) {
  const std::size_t block = index(vertex) / kBlock;
  if (changed_block_[block] != 0) return;
  changed_block_[block] = 1;
  changed_blocks_.push_back(block);
}

void LiveSurface::mark_moved(std::int32_t vertex) {
  mark(vertex);
  if (is_moved_[index(vertex)] != 0) return;
  is_moved_[index(vertex)] = 1;
  moved_.push_back(vertex);
}

LiveVertex& LiveSurface::move(std::int32_t vertex) {
  mark_moved(vertex);
  return vertices_[index(vertex)];
}

const std::vector<LiveSurface::Range>& LiveSurface::take_changes() {
  changes_.clear();
  std::sort(changed_blocks_.begin(), changed_blocks_.end());
  for (const std::size_t block : changed_blocks_) {
    changed_block_[block] = 0;
    const std::size_t first = block * kBlock;
    const std::size_t end = std::min(first + kBlock, vertices_.size());
    if (first >= end) continue;
    if (!changes_.empty() && changes_.back().first + changes_.back().count == first) {
      changes_.back().count += end - first;
    } else {
      changes_.push_back({first, end - first});
    }
  }
  changed_blocks_.clear();
  return changes_;
}

void LiveSurface::begin_frame() {
  ++frame_;
  for (const std::int32_t v : moved_) {
    vertices_[index(v)] = LiveVertex{surface_.vertices[index(v)], rest_normals_[index(v)], 0.0F};
    is_moved_[index(v)] = 0;
    mark(v);
  }
  moved_.clear();
  for (const auto& contact : contacts_) contact->used = false;
  now_.clear();
  growing_ = false;
}

Vector3f LiveSurface::normal_at(const SurfacePoint& place) const {
  // Barycentric weights from the areas opposite to each corner.
  const geometry::Triangle& corners = rest_.triangles[index(place.triangle)];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = rest_.vertices[index(corners[(k + 1) % 3])] - place.point;
    const Vec3 v = rest_.vertices[index(corners[(k + 2) % 3])] - place.point;
    sum += u.cross(v).norm() * rest_normals_[index(corners[k])].cast<double>();
  }
  return sum.normalized().cast<float>();
}

LiveSurface::Contact& LiveSurface::contact_for(const SurfacePoint& place) {
  const Vector3f point = place.point.cast<float>();
  Contact* best = nullptr;
  float nearest = kSameContact;
  for (const auto& contact : contacts_) {
    const float way = (contact->point - point).norm();
    if (contact->used || way >= nearest) continue;
    nearest = way;
    best = contact.get();
  }
  if (best == nullptr && contacts_.size() >= kMostContacts) {
    for (const auto& contact : contacts_)
      if (!contact->used && (best == nullptr || contact->last_used < best->last_used)) best = contact.get();
    if (best != nullptr) best->begun = false;
  }
  if (best == nullptr) {
    contacts_.push_back(std::make_unique<Contact>(surface_));
    best = contacts_.back().get();
  }
  return *best;
}

void LiveSurface::prepare(Contact& contact, const Indentation& indentation, const SurfacePoint& place) {
  contact.used = true;
  contact.last_used = frame_;
  contact.place = place;
  contact.point = place.point.cast<float>();
  const Vector3f normal = normal_at(place);
  const Vector3f direction = indentation.direction.cast<float>();
  const float along_normal = direction.dot(normal);
  double depth = indentation.depth;
  if (along_normal < 0.0F)
    depth =
        held_back(depth, grid_.far_side(place.point, indentation.direction, depth / kFreeShareOfThickness));
  const SurfaceProfile profile(reach_, depth, indentation.tip_radius, indentation.half_width);
  contact.depth = static_cast<float>(depth);
  contact.normal_part = contact.depth * along_normal * normal;
  contact.side_part = contact.depth * direction - contact.normal_part;
  const double side_share = static_cast<double>(contact.side_part.norm()) / depth;
  const double fold = std::max(1.0, side_share * profile.steepest() / kSteepestSideways);
  contact.reach = static_cast<float>(profile.reach());
  contact.side_reach = static_cast<float>(fold * profile.reach());
  const double limit = static_cast<double>(end_) * fold * profile.reach();
  contact.wanted = static_cast<float>(along_normal < 0.0F ? std::max(limit, kImprintReach) : limit);
}

int LiveSurface::run_fronts(Contact& contact, int steps, bool settle) {
  const geometry::Triangle& corners = rest_.triangles[index(contact.place.triangle)];
  const bool off_source = (contact.point - contact.front.source()).norm() > (settle ? 0.0F : kNewFront);
  if (!contact.begun || (settle && off_source)) {
    contact.front.begin(corners, contact.point);
    contact.begun = true;
    contact.next_runs = false;
  } else if (off_source && !contact.next_runs) {
    contact.next.begin(corners, contact.point);
    contact.next_runs = true;
  }
  const float shifted = contact.wanted + (contact.point - contact.front.source()).norm();
  int taken = contact.front.advance(shifted, steps);
  if (contact.next_runs) {
    const float wanted = std::min(shifted, contact.front.radius());
    taken += contact.next.advance(wanted, steps - taken);
    if (contact.next.radius() >= wanted) {
      std::swap(contact.front, contact.next);
      contact.next_runs = false;
    }
  }
  const float way = (contact.point - contact.front.source()).norm();
  growing_ = growing_ || contact.next_runs || contact.front.radius() < contact.wanted + way;
  // Where the front ends the displacement must have ended, too.
  const float end = contact.front.radius() - way;
  const auto lowered = [this, end](float reach) {
    return std::clamp(profile_.at(std::max(0.0F, end) / reach).u, kLeastShare, 0.9F);
  };
  contact.lowered = lowered(contact.reach);
  contact.lowered_side = lowered(contact.side_reach);
  float least = std::numeric_limits<float>::infinity();
  for (const std::int32_t v : corners) least = std::min(least, contact.excess(surface_, v));
  contact.own_excess = std::isfinite(least) ? least : 0.0F;
  return taken;
}

void LiveSurface::move_by(const Contact& contact) {
  Contact::Effect effect;
  const std::span<const std::int32_t> reached = contact.within(end_ * contact.side_reach);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::int32_t v = reached[i];
    const Vector3f& normal = rest_normals_[index(v)];
    if (!contact.effect(surface_, profile_, i, normal, effect)) continue;
    LiveVertex& vertex = move(v);
    vertex.position += effect.displacement;
    vertex.moved = signed_length(effect.displacement, normal);
    vertex.normal =
        ((1.0F + effect.derived.dot(effect.along)) * normal - effect.derived.dot(normal) * effect.along)
            .normalized();
  }
}

void LiveSurface::add(const Contact& contact) {
  Contact::Effect effect;
  const std::span<const std::int32_t> reached = contact.within(end_ * contact.side_reach);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::int32_t v = reached[i];
    if (!contact.effect(surface_, profile_, i, rest_normals_[index(v)], effect)) continue;
    const float squared = effect.displacement.squaredNorm() * 1e6F;  // mm^2
    const float weight = std::max(squared * squared * squared * squared, 1e-30F);
    Sums& sums = sums_[index(v)];
    if (is_moved_[index(v)] == 0) sums = Sums{};
    mark_moved(v);
    const float slope =  // of the weight, along the surface away from this contact
        squared > 1e-8F ? 8.0F * weight * effect.displacement.dot(effect.derived) * 1e6F / squared : 0.0F;
    sums.weight += weight;
    sums.displacement += weight * effect.displacement;
    sums.derivative += (weight * effect.derived + slope * effect.displacement) * effect.along.transpose();
    sums.weight_slope += slope * effect.along;
  }
}

void LiveSurface::finish_sums() {
  for (const std::int32_t v : moved_) {
    const Sums& sums = sums_[index(v)];
    LiveVertex& vertex = vertices_[index(v)];
    const Vector3f displacement = sums.displacement / sums.weight;
    vertex.position += displacement;
    vertex.moved = signed_length(displacement, rest_normals_[index(v)]);
    const Matrix3f derivative =
        (sums.derivative - displacement * sums.weight_slope.transpose()) / sums.weight;
    const Vector3f normal = carried_normal(derivative, rest_normals_[index(v)]);
    if (normal.squaredNorm() > 0.0F) vertex.normal = normal.normalized();
  }
}

void LiveSurface::update(std::span<const Indentation> indentations, int steps) {
  begin_frame();
  const bool settle = steps == kSettle;
  int left = steps;
  std::size_t count = 0;
  for (const Indentation& indentation : indentations) {
    now_.push_back(nullptr);
    if (!(indentation.depth > 0.0)) continue;
    const SurfacePoint place = grid_.nearest(indentation.point);
    if (place.triangle < 0) continue;
    Contact& contact = contact_for(place);
    prepare(contact, indentation, place);
    const int taken = run_fronts(contact, left, settle);
    if (!settle) left -= std::min(left, taken);
    now_.back() = &contact;
    ++count;
  }
  if (count > 1 && sums_.empty()) sums_.resize(vertices_.size());
  for (const Contact* contact : now_) {
    if (contact == nullptr) continue;
    if (count == 1) {
      move_by(*contact);
    } else {
      add(*contact);
    }
  }
  if (count > 1) finish_sums();
}

std::span<const std::int32_t> LiveSurface::near(std::size_t i, double radius) const {
  if (i >= now_.size() || now_[i] == nullptr) return {};
  return now_[i]->within(static_cast<float>(radius));
}

}  // namespace palpate::deform

#include "core/deform/deformed_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/deform/surface_parts.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

// m; a new front starts when the contact is farther than this from its front's source
constexpr float kNewFront = 1.5e-3F;
// m; largest error of a vertex that is not computed again, with a margin for rounding to the stated 0.05 mm
constexpr float kMaxError = 0.045e-3F;
constexpr float kAlwaysWithin = 8e-3F;         // m from a contact; nearer vertices are always computed again
constexpr float kEarliestEnd = 0.9F;           // u/D; the profile is cut off at most at this value
constexpr double kImprintReach = 20e-3;        // m; fronts under a press go at least this far, for is_near()
constexpr std::size_t kMaxContacts = 24;       // kept with their fronts
constexpr double kFreeShareOfThickness = 0.7;  // as in limited_depth()

std::vector<Vector3f> float_normals(const geometry::TriangleMesh& mesh) {
  std::vector<Vector3f> normals;
  for (const Vec3& normal : vertex_normals(mesh)) normals.emplace_back(normal.cast<float>());
  return normals;
}

// Appends a range; merges it with the last one if they touch.
void append(std::vector<DeformedSurface::Range>& ranges, DeformedSurface::Range range) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == range.first) {
    ranges.back().count += range.count;
  } else {
    ranges.push_back(range);
  }
}

}  // namespace

// One contact with its geodesic front. It is kept while the contact stays near.
struct DeformedSurface::TrackedContact {
  explicit TrackedContact(const FrontSurface& surface) : front(surface), next(surface) {}

  GeodesicFront front;
  GeodesicFront next;
  bool begun = false;
  bool next_runs = false;
  bool used = false;
  bool was_used = false;  // in the last frame
  std::uint64_t last_used = 0;
  contact::SurfacePoint place;
  ContactField field;
  float wanted = 0.0F;  // distance that the front must reach [m]

  // Per block: smallest geodesic distance from the front's source; infinity where the front has not come.
  std::vector<float> least;
  std::size_t noted = 0;  // settled vertices that `least` includes
  float noted_to = 0.0F;  // front radius at that time [m]
  ContactField before;    // the field of the last frame
  float slack_before = 0.0F;
  FieldChange change;
  float slack = 0.0F;  // a vertex may be nearer than `least` by this much, now or in the last frame [m]
  bool has_new_front = false;  // the drawn vertices belong to a previous front

  // Distance [m] of the contact from the front's source.
  [[nodiscard]] float distance_from_source() const { return (field.point - front.source()).norm(); }
  // A vertex may be nearer to the contact than to the front's source by this much [m].
  [[nodiscard]] float closing_bound() const {
    return distance_from_source() + std::max(0.0F, field.own_excess);
  }
};

DeformedSurface::DeformedSurface(geometry::TriangleMesh rest, const model::FalloffRatios& reach,
                                 double rounding, float least_share)
    : rest_(std::move(rest)),
      search_(rest_),
      surface_(rest_),
      reach_(reach),
      profile_(reach, rounding),
      least_share_(least_share),
      end_(profile_.where(least_share)),
      rest_normals_(float_normals(rest_)),
      blocks_(surface_.vertices, rest_normals_),
      vertices_(rest_.vertices.size()),
      state_(blocks_.count()) {
  for (std::size_t block = 0; block < blocks_.count(); ++block)
    blocks_.rest(block, &vertices_[blocks_.first(block)]);
}

DeformedSurface::~DeformedSurface() = default;

std::vector<std::int32_t> DeformedSurface::moved() const {
  std::vector<std::int32_t> moved;
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    if (vertices_[v].position != surface_.vertices[v]) moved.push_back(static_cast<std::int32_t>(v));
  return moved;
}

SurfaceVertex& DeformedSurface::move(std::int32_t vertex) {
  state_[at(vertex) / SurfaceBlocks::kBlock] = {true, true, true};
  return vertices_[at(vertex)];
}

const std::vector<DeformedSurface::Range>& DeformedSurface::take_changes() {
  changes_.clear();
  for (std::size_t block = 0; block < blocks_.count(); ++block) {
    if (!state_[block].changed) continue;
    state_[block].changed = false;
    append(changes_, {blocks_.first(block), blocks_.size(block)});
  }
  return changes_;
}

const std::vector<DeformedSurface::Range>& DeformedSurface::near(std::size_t i, double radius) {
  near_.clear();
  if (i >= now_.size() || now_[i] == nullptr) return near_;
  for (std::size_t block = 0; block < blocks_.count(); ++block) {
    if (blocks_.near(block, now_[i]->field.point, static_cast<float>(radius)))
      append(near_, {blocks_.first(block), blocks_.size(block)});
  }
  return near_;
}

bool DeformedSurface::is_near(std::size_t i, std::int32_t vertex, double radius) const noexcept {
  return now_[i]->front.distance_of(vertex) < static_cast<float>(radius) + now_[i]->distance_from_source();
}

void DeformedSurface::begin_frame() {
  ++frame_;
  for (const auto& contact : contacts_) {
    contact->was_used = contact->used;
    contact->used = false;
    contact->has_new_front = false;
    contact->before = contact->field;
    contact->slack_before = contact->closing_bound();
  }
  now_.clear();
  growing_ = false;
}

Vector3f DeformedSurface::normal_at(const contact::SurfacePoint& place) const {
  // Barycentric weights from the areas opposite to each corner.
  const geometry::Triangle& corners = rest_.triangles[at(place.triangle)];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = rest_.vertices[at(corners[(k + 1) % 3])] - place.point;
    const Vec3 v = rest_.vertices[at(corners[(k + 2) % 3])] - place.point;
    sum += u.cross(v).norm() * rest_normals_[at(corners[k])].cast<double>();
  }
  return sum.normalized().cast<float>();
}

DeformedSurface::TrackedContact& DeformedSurface::contact_for(const contact::SurfacePoint& place) {
  const Vector3f point = place.point.cast<float>();
  TrackedContact* best = nullptr;
  float nearest = kSameContact;
  for (const auto& contact : contacts_) {
    const float way = (contact->field.point - point).norm();
    if (contact->used || way >= nearest) continue;
    nearest = way;
    best = contact.get();
  }
  if (best == nullptr && contacts_.size() >= kMaxContacts) {
    for (const auto& contact : contacts_)
      if (!contact->used && (best == nullptr || contact->last_used < best->last_used)) best = contact.get();
    if (best != nullptr) best->begun = false;
  }
  if (best == nullptr) {
    contacts_.push_back(std::make_unique<TrackedContact>(surface_));
    best = contacts_.back().get();
  }
  return *best;
}

void DeformedSurface::prepare(TrackedContact& contact, const Indentation& indentation, const Drawn& drawn) {
  contact.used = true;
  contact.last_used = frame_;
  contact.place = drawn.place;
  ContactField& field = contact.field;
  field.point = drawn.place.point.cast<float>();
  const Vector3f direction = indentation.direction.cast<float>();
  const float along_normal = direction.dot(drawn.normal);
  const DisplacementProfile profile(reach_, drawn.depth, indentation.tip_radius, indentation.half_width);
  const auto depth = static_cast<float>(drawn.depth);
  field.normal_part = depth * along_normal * drawn.normal;
  field.side_part = depth * direction - field.normal_part;
  const double side_share = static_cast<double>(field.side_part.norm()) / drawn.depth;
  const double fold = std::max(1.0, side_share * profile.steepest() / kMaxTangentialSlope);
  field.reach = static_cast<float>(profile.outer_radius());
  field.side_reach = static_cast<float>(fold * profile.outer_radius());
  field.limit = drawn.local > 0.0 ? end_ * field.side_reach : 0.0F;
  field.normal_part *= static_cast<float>(drawn.local);
  field.side_part *= static_cast<float>(drawn.local);
  contact.wanted =
      along_normal < 0.0F ? std::max(field.limit, static_cast<float>(kImprintReach)) : field.limit;
}

int DeformedSurface::run_fronts(TrackedContact& contact, int steps, bool settle) {
  const geometry::Triangle& corners = rest_.triangles[at(contact.place.triangle)];
  if (!contact.begun || settle) {
    contact.front.begin(corners, contact.field.point);
    contact.field.own_excess = 0.0F;
    contact.begun = true;
    contact.has_new_front = true;
    contact.next_runs = false;
  } else if (contact.distance_from_source() > kNewFront && !contact.next_runs) {
    contact.next.begin(corners, contact.field.point);
    contact.next_runs = true;
  }
  const float shifted = contact.wanted + contact.closing_bound();
  int taken = contact.front.advance(shifted, steps);
  if (contact.next_runs) {
    const float wanted = std::min(shifted, contact.front.radius());
    taken += contact.next.advance(wanted, steps - taken);
    if (contact.next.radius() >= wanted) {
      std::swap(contact.front, contact.next);
      contact.has_new_front = true;
      contact.next_runs = false;
    }
  }
  growing_ = growing_ || contact.next_runs ||
             contact.front.radius() < contact.wanted + contact.distance_from_source();
  return taken;
}

void DeformedSurface::lower_to_front(TrackedContact& contact) {
  ContactField& field = contact.field;
  field.excess = contact.front.excess();
  float least = kInfinityF;
  for (const std::int32_t v : rest_.triangles[at(contact.place.triangle)])
    least = std::min(least, field.excess[at(v)]);
  field.own_excess = std::isfinite(least) ? least : 0.0F;
  // The displacement must end where the front ends.
  const float end = contact.front.radius() - contact.closing_bound();
  const auto lowered = [this, end](float reach) {
    return std::clamp(profile_.at(std::max(0.0F, end) / reach).u, least_share_, kEarliestEnd);
  };
  field.lowered = lowered(field.reach);
  field.lowered_side = lowered(field.side_reach);
}

void DeformedSurface::update_least_distances(TrackedContact& contact) {
  if (contact.has_new_front) {
    contact.least.assign(blocks_.count(), kInfinityF);
    contact.noted = 0;
    contact.noted_to = 0.0F;
  }
  // The profile ended where the front ended, so vertices settled since then do not move yet. That does not
  // hold in a front's first steps and behind obtuse triangles, where vertices settle late.
  const bool had_ended = std::max(contact.before.lowered, contact.before.lowered_side) < kEarliestEnd;
  const float ended_at = had_ended ? contact.noted_to : kInfinityF;
  const std::span<const std::int32_t> settled = contact.front.settled();
  for (const std::int32_t v : settled.subspan(contact.noted)) {
    const std::size_t block = at(v) / SurfaceBlocks::kBlock;
    const float distance = contact.front.distance_of(v);
    contact.least[block] = std::min(contact.least[block], distance);
    if (distance < ended_at) state_[block].error = kInfinityF;
  }
  contact.noted = settled.size();
  contact.noted_to = contact.front.radius();
}

void DeformedSurface::update_change(TrackedContact& contact) {
  const ContactField& now = contact.field;
  const ContactField& before = contact.before;
  float drift = 0.0F;
  contact.slack = 0.0F;
  if (contact.used) contact.slack = contact.closing_bound();
  if (contact.was_used) contact.slack = std::max(contact.slack, contact.slack_before);
  if (contact.used && contact.was_used) {
    drift = (now.point - before.point).norm() + std::abs(now.own_excess - before.own_excess);
  }
  contact.change.set(contact.was_used ? &before : nullptr, contact.used ? &now : nullptr, drift, profile_);
}

float DeformedSurface::added_error(std::size_t block) {
  near_changes_.clear();
  for (const TrackedContact* contact : changing_) {
    if (contact->has_new_front && contact->was_used) {
      if (blocks_.near(block, contact->before.point, contact->before.limit) ||
          (contact->used && blocks_.near(block, contact->field.point, contact->field.limit)))
        return kInfinityF;
      continue;
    }
    const float distance = contact->least[block] - contact->slack;
    if (distance < contact->change.limit()) near_changes_.push_back({&contact->change, distance});
  }
  return max_motion(near_changes_);
}

void DeformedSurface::find_changes() {
  changing_.clear();
  bool any = false;
  for (const auto& contact : contacts_) {
    if (!contact->used && !contact->was_used) continue;
    update_change(*contact);
    changing_.push_back(contact.get());
    any = any || contact->has_new_front || !contact->change.is_still();
  }
  if (!any) changing_.clear();
}

void DeformedSurface::move_blocks(bool settle) {
  std::vector<const ContactField*> fields;
  for (const TrackedContact* contact : now_)
    if (contact != nullptr) fields.push_back(&contact->field);
  const bool whole = whole_ != nullptr && !whole_->is_zero();
  std::vector<const ContactField*> near;
  for (std::size_t block = 0; block < blocks_.count(); ++block) {
    near.clear();
    bool close = false;
    for (const ContactField* field : fields) {
      if (!blocks_.near(block, field->point, field->limit)) continue;
      near.push_back(field);
      close = close || blocks_.near(block, field->point, kAlwaysWithin);
    }
    BlockState& state = state_[block];
    SurfaceVertex* const out = &vertices_[blocks_.first(block)];
    if (near.empty() && !whole) {
      if (state.moved) {
        blocks_.rest(block, out);
        state.changed = true;
      }
      state = {false, false, state.changed, 0.0F};
      continue;
    }
    if (!settle && !state.lowered) {
      if (!near.empty()) state.error += added_error(block);
      if (whole) state.error += whole_change(block);
      if (state.error <= (close ? 0.0F : kMaxError)) continue;
    }
    bool moves = false;
    if (!near.empty()) {
      moves = blocks_.move(block, near, profile_, out);
    } else if (!whole) {
      blocks_.rest(block, out);
    }
    if (whole) {
      move_whole(block, !moves);
      moves = true;
    }
    state = {moves, false, state.changed || state.moved || moves, 0.0F};
  }
}

void DeformedSurface::set_response(std::shared_ptr<const OrganResponse> response) {
  whole_ = response ? std::make_unique<ResponseField>(std::move(response)) : nullptr;
  for (BlockState& state : state_) state.error = kInfinityF;  // drawn by what moved it before
  groups_.clear();
  first_group_ = {0};
  block_nodes_.clear();
  first_node_ = {0};
  if (whole_ == nullptr) return;
  for (std::size_t block = 0; block < blocks_.count(); ++block) gather_groups(block);
  const bool touched = std::any_of(contacts_.begin(), contacts_.end(), [](const auto& c) { return c->used; });
  whole_share_ = touched ? 0.0F : 1.0F;
}

void DeformedSurface::gather_groups(std::size_t block) {
  std::map<std::int32_t, float> weight_of;
  std::map<std::uint32_t, std::vector<Member>> in_piece;
  for (std::size_t v = blocks_.first(block); v < blocks_.first(block) + blocks_.size(block); ++v) {
    const ResponseField::Place place = whole_->place_of(rest_.vertices[v], rest_normals_[v].cast<double>());
    in_piece[place.piece].push_back({static_cast<std::uint32_t>(v), place});
    const auto& nodes = whole_->splines_of(place.piece);
    const auto weights = ResponseField::weights_of(place);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      weight_of[nodes[n]] = std::max(weight_of[nodes[n]], std::abs(weights[n]));
  }
  for (const auto& [node, weight] : weight_of) block_nodes_.push_back({node, weight});
  first_node_.push_back(block_nodes_.size());
  for (const auto& entry : in_piece) {
    const std::span<const Member> members = entry.second;
    for (std::size_t first = 0; first < members.size(); first += kLanes)
      groups_.push_back(group_of(members.subspan(first, std::min(kLanes, members.size() - first))));
  }
  first_group_.push_back(groups_.size());
}

DeformedSurface::VertexGroup DeformedSurface::group_of(std::span<const Member> members) const {
  const auto member = [members](std::size_t lane) -> const Member& {
    return members[std::min(lane, members.size() - 1)];
  };
  const auto four = [](const auto& of) {
    std::array<Float4, kLanes> rows;
    for (std::size_t i = 0; i < kLanes; ++i)
      rows[i] = Float4(std::array<float, 4>{of(i)[0], of(i)[1], of(i)[2], 0.0F});
    transpose(rows);
    return Float4x3{rows[0], rows[1], rows[2]};
  };
  VertexGroup group;
  group.piece = members.front().place.piece;
  group.count = members.size();
  for (std::size_t i = 0; i < kLanes; ++i) group.vertices[i] = member(i).vertex;
  group.within = four([&member](std::size_t i) { return member(i).place.within; });
  group.place = four([&member, this](std::size_t i) { return surface_.vertices[member(i).vertex]; });
  group.normal = four([&member, this](std::size_t i) { return rest_normals_[member(i).vertex]; });
  return group;
}

DeformedSurface::Drawn DeformedSurface::drawn_at(const Indentation& indentation, double share) const {
  Drawn drawn;
  const double depth = share * indentation.depth;
  if (!(depth > 0.0)) return drawn;
  drawn.place = search_.nearest(indentation.point);
  if (drawn.place.triangle < 0) return drawn;
  drawn.normal = normal_at(drawn.place);
  drawn.depth = depth;
  if (indentation.direction.dot(drawn.normal.cast<double>()) < 0.0) {
    drawn.depth = limited_depth(
        depth, search_.far_side(drawn.place.point, indentation.direction, depth / kFreeShareOfThickness));
  }
  return drawn;
}

double DeformedSurface::curvature_at(const Vec3& point, const Vec3& inwards, double radius) const {
  // least squares of the depth below the point: curvature r^2 / 2
  const Eigen::Vector3f middle = point.cast<float>();
  const Eigen::Vector3f along = inwards.cast<float>();
  const auto reach = static_cast<float>(radius);
  float products = 0.0F;
  float squares = 0.0F;
  for (std::size_t block = 0; block < blocks_.count(); ++block) {
    if (!blocks_.near(block, middle, 2.0F * reach)) continue;
    for (std::size_t v = blocks_.first(block); v < blocks_.first(block) + blocks_.size(block); ++v) {
      const Eigen::Vector3f way = surface_.vertices[v] - middle;
      const float below = way.dot(along);
      const float aside = way.squaredNorm() - below * below;
      const float inside = 1.0F - aside / (reach * reach);
      if (inside <= 0.0F || std::abs(below) > reach || rest_normals_[v].dot(along) >= 0.0F) continue;
      products += inside * inside * below * aside;
      squares += inside * inside * aside * aside;
    }
  }
  return squares > 0.0F ? std::max(0.0F, 2.0F * products / squares) : 0.0;
}

void DeformedSurface::set_whole(std::span<const Indentation> indentations, std::span<Drawn> drawn,
                                bool settle) {
  std::vector<ResponseField::Contact> contacts;
  std::vector<Drawn*> owner;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!(drawn[i].depth > 0.0)) continue;
    contacts.push_back(
        {drawn[i].place.point, drawn[i].normal.cast<double>(), drawn[i].depth * indentations[i].direction,
         indentations[i].tip_radius,
         curvature_at(drawn[i].place.point, indentations[i].direction, indentations[i].tip_radius)});
    owner.push_back(&drawn[i]);
  }
  whole_share_ = settle || contacts.empty() ? 1.0F : std::min(1.0F, whole_share_ + 1.0F / kFadeUpdates);
  whole_->set(contacts, whole_share_);
  for (std::size_t c = 0; c < contacts.size(); ++c)
    owner[c]->local = 1.0 - static_cast<double>(whole_share_) * (1.0 - whole_->missing(c));
}

float DeformedSurface::whole_change(std::size_t block) const {
  float change = 0.0F;
  for (const NearFieldChange& near : whole_->near_changes()) {
    const float distance = blocks_.distance(block, near.point());
    const float moved = near.at(distance);
    if (moved > 0.0F && distance < kAlwaysWithin) return kInfinityF;
    change += moved;
  }
  for (std::size_t n = first_node_[block]; n < first_node_[block + 1]; ++n)
    change += block_nodes_[n].weight * whole_->change(block_nodes_[n].node);
  return change;
}

void DeformedSurface::move_whole(std::size_t block, bool at_rest) {
  ResponseField::CellPolynomial polynomial;
  const VertexGroup* before = nullptr;
  for (std::size_t g = first_group_[block]; g < first_group_[block + 1]; ++g) {
    const VertexGroup& group = groups_[g];
    if (before == nullptr || before->piece != group.piece) whole_->take_polynomial(group.piece, polynomial);
    before = &group;
    const FourMotions motions = whole_->at(polynomial, group.within, group.place);
    std::array<SurfaceVertex*, kLanes> vertices{};
    for (std::size_t i = 0; i < kLanes; ++i) vertices[i] = &vertices_[group.vertices[i]];
    FourVertices four{group.place, group.normal};
    if (!at_rest) four = read_vertices({vertices[0], vertices[1], vertices[2], vertices[3]});
    four.position = four.position + motions.displacement;
    auto [by_x, by_y, by_z] = motions.gradient;
    by_x.x += Float4(1.0F);
    by_y.y += Float4(1.0F);
    by_z.z += Float4(1.0F);
    const Float4x3 normal = turned_normal(four.normal, by_x, by_y, by_z);
    four.normal = select(dot(normal, normal) > Float4(0.0F), unit(normal), four.normal);
    write_vertices(four, four.position - group.place, group.normal, std::span(vertices).first(group.count));
  }
}

void DeformedSurface::update(std::span<const Indentation> indentations, int steps) {
  begin_frame();
  const bool settle = steps == kSettle;
  int left = steps;
  const std::vector<double> shares = opposition_factors(indentations);
  std::vector<Drawn> drawn;
  for (std::size_t i = 0; i < indentations.size(); ++i) drawn.push_back(drawn_at(indentations[i], shares[i]));
  if (whole_ != nullptr) set_whole(indentations, drawn, settle);
  for (std::size_t i = 0; i < indentations.size(); ++i) {
    now_.push_back(nullptr);
    if (!(drawn[i].depth > 0.0)) continue;
    TrackedContact& contact = contact_for(drawn[i].place);
    prepare(contact, indentations[i], drawn[i]);
    const int taken = run_fronts(contact, left, settle);
    lower_to_front(contact);
    update_least_distances(contact);
    if (!settle) left -= std::min(left, taken);
    now_.back() = &contact;
  }
  find_changes();
  move_blocks(settle);
  growing_ = growing_ || (whole_ != nullptr && whole_share_ < 1.0F);
}

}  // namespace palpate::deform

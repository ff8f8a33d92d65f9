// The motion of a whole organ under its contacts, drawn at every picture.
//
// The response of the organ's cells to a force (organ_response.h) is too blunt under a tool: the cells spread
// the force over the length h of one cell. Near the contact the organ moves like a half-space, whose field H
// is known for any contact radius a (half_space.h). So
//
//     u(x) = U_h(x) f + (H_a - H_h)(x) f
//
//            |<- a ->|                    U_h: the cells' field under a force f spread over h. Smooth,
//        ----.       .----                     knows the organ's shape and its support.
//            '.     .'    H_a             H_h: the half-space's field under the same spread force
//     ---..    '._.'   ..---              H_a - H_h: what the cells miss; falls with r^-3, so it is cut
//          ''---...--''    H_h                 off smoothly between 2 h and 3.5 h.
//
// Forces follow from the depths; Young's modulus cancels. Contacts act on each other, so a linear system
// couples all contacts:
//
// 1. A press acts along its direction, moves its contact by its depth there and lets it slide freely across:
//    one unknown. A pull holds its contact: three unknowns. A press whose force would pull is left out,
//    because another contact presses the surface away from it.
// 2. A press that is far off the surface's normal drags the surface by friction and takes away the motion
//    across its direction: three unknowns a contact.
//
// Where the support holds the surface under the tool the organ cannot give way by the depth. A press is then
// softened to a quarter of the half-space's answer, and missing() says how much of the depth is left for the
// local profile.

#include "core/deform/response_field.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/base/simd.h"
#include "core/deform/half_space.h"

namespace palpate::deform {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;

constexpr double kSmallestContact = 0.5e-3;  // m, radius
constexpr double kLeastShare = 0.25;         // of the half-space's motion that an organ has at least
constexpr int kRadiusRounds = 6;
// Slope of a dent's wall. A deeper dent is wider than the tool: real tissue gives way beside it, while the
// linear half-space would have a wall that folds.
constexpr double kSteepest = 1.7;
constexpr double kSoftening = 1e-5;  // keeps coincident contacts solvable
// A press whose direction is off the surface's normal by less than the first slides freely across its
// direction, one by more than the second not at all: sines of 20 and 45 degrees.
constexpr double kSlides = 0.34;
constexpr double kSticks = 0.71;

bool presses(const ResponseField::Contact& c) { return c.displacement.dot(c.normal) < 0.0; }

// Share of the motion across its direction that a press does not allow.
double stuck_share(const ResponseField::Contact& c) {
  if (!presses(c)) return 0.0;
  const double sine = c.displacement.cross(c.normal).norm() / c.displacement.norm();
  return std::clamp((sine - kSlides) / (kSticks - kSlides), 0.0, 1.0);
}

FourMotions no_motions() {
  const Float4x3 none{Float4(0.0F), Float4(0.0F), Float4(0.0F)};
  return {none, {none, none, none}};
}

// Radius [m] of the contact of a tool that dents the surface to `depth` [m].
double radius_of(double tip_radius, double depth) {
  return std::max({kSmallestContact, ball_contact_radius(tip_radius, depth), depth / kSteepest});
}

// Radius [m] of a ball that dents a plane as the tool dents a convex surface: by Hertz, curvatures add up.
// The cells know the organ's shape, which leaves this part of its curvature, and a deep dent has none of it.
double fitted_radius(const ResponseField::Contact& contact, double depth) {
  constexpr double kPart = 0.4;
  constexpr double kDeep = 0.6;  // of the tool's radius
  const double deep = depth / (kDeep * contact.tip_radius);
  const double part = kPart / (1.0 + deep * deep * deep * deep);
  return contact.tip_radius / (1.0 + part * contact.curvature * contact.tip_radius);
}

}  // namespace

ResponseField::ResponseField(std::shared_ptr<const OrganResponse> response)
    : response_(std::move(response)), field_(response_->none()), change_(field_.size(), 0.0F) {}

ResponseField::Columns ResponseField::columns_for(const Contact& contact, const CellPieces::Place& place,
                                                  double spread) const {
  Columns columns;
  columns.place = place;
  columns.spread = spread;
  columns.load = response_->load_at(contact.point, contact.normal, spread);
  columns.along = response_->under(columns.load);
  columns.near.place(contact.point, -contact.normal);
  return columns;
}

void ResponseField::set_radius(Columns& columns) const {
  // The tool dents the surface by the part of its depth by which the organ as a whole does not give way.
  const Contact& contact = columns.contact;
  const double depth = contact.displacement.norm();
  Vec3 cells;
  for (std::size_t axis = 0; axis < 3; ++axis)
    cells[static_cast<Index>(axis)] = contact.normal.dot(response_->at(columns.along[axis], columns.place));
  const double beyond = cells.dot(contact.normal) - half_space_depth(columns.spread);
  double radius = radius_of(contact.tip_radius, depth);
  for (int round = 0; round < kRadiusRounds; ++round) {
    const double dent = half_space_depth(radius);
    const double share = std::clamp(dent / std::max(dent + beyond, 0.5 * dent), 0.02, 1.0);
    const double local = share * depth;
    radius = radius_of(fitted_radius(contact, local), local);
  }
  if (!presses(contact)) radius = std::max(radius, kHeldWide * contact.tip_radius);
  if (radius == columns.radius) return;
  columns.radius = radius;
  columns.near.set_terms(radius, columns.spread, response_->pieces().edge_of(columns.place.piece));
}

Matrix3d ResponseField::response(const Columns& from, const Columns& to) const {
  Matrix3d motion;
  for (Index axis = 0; axis < 3; ++axis) {
    FourMotions near = no_motions();
    from.near.add(lanes_of(to.contact.point.cast<float>().eval()), from.near.part_of(Vec3::Unit(axis)), near);
    motion.col(axis) = response_->at(from.along[static_cast<std::size_t>(axis)], to.place) +
                       near.first().displacement.cast<double>();
  }
  return motion;
}

void ResponseField::set(std::span<const Contact> contacts, float share) {
  std::vector<NearField> near_before;
  for (const Columns& c : contacts_) near_before.push_back(c.near);
  std::swap(before_, contacts_);
  contacts_.clear();
  for (const Contact& contact : contacts) {
    const CellPieces& pieces = response_->pieces();
    const CellPieces::Place place = pieces.place_of(contact.point, contact.normal);
    const double spread = std::max(OrganResponse::spread(pieces.edge_of(place.piece)),
                                   radius_of(contact.tip_radius, contact.displacement.norm()));
    const auto same = std::find_if(before_.begin(), before_.end(), [&](const Columns& c) {
      return c.contact.point == contact.point && c.spread == spread && c.contact.normal == contact.normal;
    });
    if (same != before_.end()) {
      contacts_.push_back(std::move(*same));
      before_.erase(same);
    } else {
      contacts_.push_back(columns_for(contact, place, spread));
    }
    contacts_.back().contact = contact;
    contacts_.back().force.setZero();
    set_radius(contacts_.back());
  }
  const auto rows = static_cast<Index>(3 * contacts_.size());
  between_.resize(rows, rows);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (std::size_t j = 0; j < contacts_.size(); ++j)
      between_.block<3, 3>(static_cast<Index>(3 * i), static_cast<Index>(3 * j)) =
          response(contacts_[j], contacts_[i]);
  solve_presses();
  solve_sides();
  sum_up(share);
  compare_near(near_before);
}

void ResponseField::solve_presses() {
  // The unknowns: a contact and the direction of its force.
  struct Unknown {
    std::size_t contact;
    Vec3 direction;
  };
  std::vector<bool> apart(contacts_.size(), false);
  for (std::size_t round = 0; round <= contacts_.size(); ++round) {
    std::vector<Unknown> unknowns;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (apart[i]) continue;
      if (presses(contacts_[i].contact)) {
        unknowns.push_back({i, contacts_[i].contact.displacement.normalized()});
      } else {
        for (Index axis = 0; axis < 3; ++axis) unknowns.push_back({i, Vec3::Unit(axis)});
      }
    }
    if (unknowns.empty()) return;
    const auto size = static_cast<Index>(unknowns.size());
    Eigen::MatrixXd matrix(size, size);
    Eigen::VectorXd wanted(size);
    for (Index a = 0; a < size; ++a) {
      const Unknown& row = unknowns[static_cast<std::size_t>(a)];
      wanted[a] = row.direction.dot(contacts_[row.contact].contact.displacement);
      for (Index b = 0; b < size; ++b) {
        const Unknown& column = unknowns[static_cast<std::size_t>(b)];
        matrix(a, b) = row.direction.dot(between_.block<3, 3>(static_cast<Index>(3 * row.contact),
                                                              static_cast<Index>(3 * column.contact)) *
                                         column.direction);
      }
      const double least = kLeastShare * half_space_depth(contacts_[row.contact].radius);
      matrix(a, a) = std::max(matrix(a, a), least) * (1.0 + kSoftening);
    }
    const Eigen::VectorXd force = matrix.partialPivLu().solve(wanted);
    double lowest = 0.0;
    std::size_t pulls = contacts_.size();
    for (Columns& c : contacts_) c.force.setZero();
    for (Index a = 0; a < size; ++a) {
      const Unknown& unknown = unknowns[static_cast<std::size_t>(a)];
      contacts_[unknown.contact].force += force[a] * unknown.direction;
      if (presses(contacts_[unknown.contact].contact) && force[a] < lowest) {
        lowest = force[a];
        pulls = unknown.contact;
      }
    }
    if (pulls == contacts_.size()) return;
    apart[pulls] = true;
  }
}

void ResponseField::solve_sides() {
  if (std::none_of(contacts_.begin(), contacts_.end(),
                   [](const Columns& c) { return stuck_share(c.contact) > 0.0; }))
    return;
  Eigen::VectorXd force(between_.rows());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    force.segment<3>(static_cast<Index>(3 * i)) = contacts_[i].force;
  const Eigen::VectorXd reached = between_ * force;
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(between_.rows());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i].contact;
    const Vec3 along = c.displacement.normalized();
    const Vec3 motion = reached.segment<3>(static_cast<Index>(3 * i));
    wanted.segment<3>(static_cast<Index>(3 * i)) = -stuck_share(c) * (motion - motion.dot(along) * along);
  }
  Eigen::MatrixXd matrix = between_;
  matrix.diagonal() *= 1.0 + kSoftening;
  const Eigen::VectorXd added = matrix.partialPivLu().solve(wanted);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    contacts_[i].force += added.segment<3>(static_cast<Index>(3 * i));
}

void ResponseField::sum_up(float share) {
  const OrganResponse::Displacements before = std::exchange(field_, response_->none());
  Eigen::VectorXd force(between_.rows());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Columns& c = contacts_[i];
    force.segment<3>(static_cast<Index>(3 * i)) = c.force;
    const Vec3 shared = static_cast<double>(share) * c.force;
    const Eigen::Vector3f by = shared.cast<float>();
    for (std::size_t n = 0; n < field_.size(); ++n)
      field_[n] += by.x() * c.along[0][n] + by.y() * c.along[1][n] + by.z() * c.along[2][n];
    c.near.set_force(shared);
  }
  for (std::size_t n = 0; n < field_.size(); ++n) change_[n] = (field_[n] - before[n]).norm();
  const Eigen::VectorXd reached = between_ * force;
  missing_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i].contact;
    const Vec3 along = c.displacement.normalized();
    const double wanted = c.displacement.dot(along);
    const double there = reached.segment<3>(static_cast<Index>(3 * i)).dot(along);
    const double missing = wanted > 0.0 ? 1.0 - there / wanted : 0.0;
    missing_.push_back(missing > 1e-3 ? std::min(missing, 1.0) : 0.0);
  }
}

void ResponseField::compare_near(std::span<const NearField> before) {
  near_changes_.clear();
  std::vector<bool> continued(before.size(), false);
  const auto compare = [this](const NearField* then, const NearField* now) {
    near_changes_.emplace_back();
    near_changes_.back().set(then, now);
  };
  for (const Columns& c : contacts_) {
    std::size_t nearest = before.size();
    float least = kSameContact;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const float way = (before[i].point() - c.near.point()).norm();
      if (continued[i] || way >= least) continue;
      nearest = i;
      least = way;
    }
    if (nearest < before.size()) continued[nearest] = true;
    compare(nearest < before.size() ? &before[nearest] : nullptr, &c.near);
  }
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!continued[i]) compare(&before[i], nullptr);
}

ResponseField::Place ResponseField::place_of(const Vec3& vertex, const Vec3& outward) const noexcept {
  const CellPieces::Place place = response_->pieces().place_of(vertex, outward);
  Place made;
  made.piece = static_cast<std::uint32_t>(place.piece);
  for (std::size_t axis = 0; axis < 3; ++axis) made.within[axis] = static_cast<float>(place.within[axis]);
  return made;
}

std::array<float, CellGrid::kNodesOfCell> ResponseField::weights_of(const Place& place) noexcept {
  const auto exact = CellGrid::weights({place.within[0], place.within[1], place.within[2]});
  std::array<float, CellGrid::kNodesOfCell> weights{};
  std::transform(exact.begin(), exact.end(), weights.begin(), [](double w) { return static_cast<float>(w); });
  return weights;
}

PlaceMotion ResponseField::at(const Eigen::Vector3f& vertex, const Place& place) const noexcept {
  const Float4x3 within{Float4(place.within[0]), Float4(place.within[1]), Float4(place.within[2])};
  CellPolynomial cell;
  take_polynomial(place.piece, cell);
  return at(cell, within, lanes_of(vertex)).first();
}

void ResponseField::take_polynomial(std::uint32_t piece, CellPolynomial& cell) const noexcept {
  // Along one axis the splines are 1/2 - t + t^2/2, 1/2 + t - t^2 and t^2/2.
  const auto along_axis = [](std::array<Float4, 3>& of) {
    const auto [a, b, c] = of;
    const Float4 half(0.5F);
    of = {half * (a + b), b - a, half * (a + c) - b};
  };
  std::array<std::array<std::array<Float4, 3>, 3>, 3> nodes;  // components in lanes
  const auto& numbers = splines_of(piece);
  cell.edge = static_cast<float>(response_->pieces().edge_of(piece));
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      for (std::size_t c = 0; c < 3; ++c)
        nodes[a][b][c] = Float4::load_unaligned(field_[palpate::at(numbers[9 * a + 3 * b + c])].data());
      along_axis(nodes[a][b]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<Float4, 3> line = {nodes[a][0][c], nodes[a][1][c], nodes[a][2][c]};
      along_axis(line);
      for (std::size_t b = 0; b < 3; ++b) nodes[a][b][c] = line[b];
    }
  }
  for (std::size_t b = 0; b < 3; ++b) {
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<Float4, 3> line = {nodes[0][b][c], nodes[1][b][c], nodes[2][b][c]};
      along_axis(line);
      for (std::size_t a = 0; a < 3; ++a)
        cell.of[a][b][c] = {Float4(line[a].get(0)), Float4(line[a].get(1)), Float4(line[a].get(2))};
    }
  }
}

FourMotions ResponseField::at(const CellPolynomial& cell, const Float4x3& within,
                              const Float4x3& vertices) const noexcept {
  const Float4 by_edge(1.0F / cell.edge);
  FourMotions motions;
  // Horner's scheme with derivatives, along z, then y, then x.
  const auto sum = [&](Float4 Float4x3::*component) __attribute__((always_inline)) {
    struct Plane {
      Float4 value, by_y, by_z;
    };
    std::array<Plane, 3> planes;
    const Float4 twice_x = within.x + within.x;
    const Float4 twice_y = within.y + within.y;
    const Float4 twice_z = within.z + within.z;
#pragma GCC unroll 3
    for (std::size_t a = 0; a < 3; ++a) {
      std::array<Float4, 3> line;
      std::array<Float4, 3> line_z;
#pragma GCC unroll 3
      for (std::size_t b = 0; b < 3; ++b) {
        const auto& of = cell.of[a][b];
        const Float4 highest = of[2].*component;
        const Float4 middle = of[1].*component;
        line[b] = of[0].*component + within.z * (middle + within.z * highest);
        line_z[b] = middle + twice_z * highest;
      }
      planes[a] = {line[0] + within.y * (line[1] + within.y * line[2]), line[1] + twice_y * line[2],
                   line_z[0] + within.y * (line_z[1] + within.y * line_z[2])};
    }
    const auto& [p, q, r] = planes;
    motions.displacement.*component = p.value + within.x * (q.value + within.x * r.value);
    motions.gradient[0].*component = by_edge * (q.value + twice_x * r.value);
    motions.gradient[1].*component = by_edge * (p.by_y + within.x * (q.by_y + within.x * r.by_y));
    motions.gradient[2].*component = by_edge * (p.by_z + within.x * (q.by_z + within.x * r.by_z));
  };
  sum(&Float4x3::x);
  sum(&Float4x3::y);
  sum(&Float4x3::z);
  for (const Columns& from : contacts_) from.near.add(vertices, motions);
  return motions;
}

}  // namespace palpate::deform

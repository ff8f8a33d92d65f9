// The field that the cells of a whole organ miss near a contact, and how far its change moves the surface.
//
// With N the force along the normal and S the force along the surface, both by 4 pi G, and e the direction
// away from the contact, half_space.h gives
//
//     u = 2 (1 - nu) psi N z - (1 - 2 nu) s N e                                      (a press)
//       + 2 psi S - 2 nu ((psi + 2 t) (e S) e - t S) + (1 - 2 nu) s (e S) z          (a drag, a pull)
//
// where psi, s and t are here differences: those of the tool's contact radius less those of the cells'
// spread, in a table by the distance r, linear between its entries.
//
// NearFieldChange bounds |u_now - u_before| at a distance by the sum of
//
// 1. the change of the products psi N, s N, ... at the same r and e. They are linear between entries, so the
//    larger end of a piece bounds it;
// 2. the slope of the terms times the drift of the contact, because r changes by at most the drift;
// 3. the terms times the turn of e, at most 2 (drift / r + turn of the normal), and times that of the normal.
//
// Each entry then takes the maximum over all larger distances, so that the nearest vertex of a block gives
// the bound of the whole block.

#include "core/deform/near_field.h"

#include <algorithm>
#include <cmath>

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr double kFadesFrom = 2.0;  // cells from the contact
constexpr double kEnds = 3.5;
constexpr auto kNu = static_cast<float>(kPoisson);

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

HalfSpaceTerms<float> scaled(const HalfSpaceTerms<float>& a, float by) {
  return {by * a.psi, by * a.s, by * a.t};
}

HalfSpaceTerms<float> difference(const HalfSpaceTerms<float>& a, const HalfSpaceTerms<float>& b) {
  return {a.psi - b.psi, a.s - b.s, a.t - b.t};
}

// Bounds of the displacement by terms that a force along the normal or along the surface has been multiplied
// with, for any direction from the contact.
float under_normal(const HalfSpaceTerms<float>& terms) {
  return 2.0F * (1.0F - kNu) * std::abs(terms.psi) + (1.0F - 2.0F * kNu) * std::abs(terms.s);
}
float under_side(const HalfSpaceTerms<float>& terms) {
  return 2.0F * std::abs(terms.psi) + 2.0F * kNu * std::abs(terms.t) +
         (1.0F - 2.0F * kNu) * std::abs(terms.s);
}

}  // namespace

void NearField::place(const Vec3& point, const Vec3& inward) noexcept {
  point_ = point.cast<float>();
  inward_ = inward.cast<float>();
}

void NearField::set_terms(double radius, double spread, double cell) noexcept {
  const double reach = kEnds * cell;
  per_metre_ = static_cast<float>(static_cast<double>(kEntries) / reach);
  terms_ = {};
  if (radius >= spread) return;
  for (std::size_t i = 0; i < kEntries; ++i) {
    const double r = static_cast<double>(i) * reach / static_cast<double>(kEntries);
    const HalfSpaceTerms<> fine = half_space_terms(r, radius);
    const HalfSpaceTerms<> blunt = half_space_terms(r, spread);
    const double share = 1.0 - smooth_step((r / cell - kFadesFrom) / (kEnds - kFadesFrom));
    terms_[i] = {static_cast<float>(share * (fine.psi - blunt.psi)),
                 static_cast<float>(share * (fine.s - blunt.s)),
                 static_cast<float>(share * (fine.t - blunt.t))};
  }
}

NearField::Force NearField::part_of(const Vec3& force) const noexcept {
  const Vector3f scaled = (force / kHalfSpaceModulus).cast<float>();
  const float normal = scaled.dot(inward_);
  Vector3f side = scaled - normal * inward_;
  if (side.squaredNorm() < 1e-12F * normal * normal) side.setZero();
  return {normal, side};
}

PlaceMotion FourMotions::first() const noexcept {
  const auto of = [](const Float4x3& v) { return Vector3f(v.x.get(0), v.y.get(0), v.z.get(0)); };
  PlaceMotion motion{of(displacement), {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    motion.gradient.col(static_cast<Eigen::Index>(axis)) = of(gradient[axis]);
  return motion;
}

void NearField::add(const Float4x3& places, const Force& force, FourMotions& motions) const noexcept {
  const Float4 zero(0.0F);
  const Float4x3 inward = lanes_of(inward_);
  const Float4x3 offset = places - lanes_of(point_);
  const Float4 r = sqrt(dot(offset, offset));
  const Float4 entry = min(r * Float4(per_metre_), Float4(static_cast<float>(kEntries)));
  const Float4Mask reached = entry < Float4(static_cast<float>(kEntries));
  if (none(reached)) return;
  // Entries of the table before and after each place; each is three floats.
  static_assert(sizeof(Terms) == 3 * sizeof(float));
  const Int4 low = __builtin_convertvector(entry.v, Int4);
  std::array<Float4, kLanes> rows;
  std::array<Float4, kLanes> next;
#pragma GCC unroll 4
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const Terms* const before = &terms_[std::min(static_cast<std::size_t>(low[lane]), kEntries - 1)];
    rows[lane] = Float4::load_unaligned(&before[0].psi);
    next[lane] = Float4::load_unaligned(&before[1].psi);
  }
  transpose(rows);
  transpose(next);
  const Float4 share =
      entry - min(Float4(__builtin_convertvector(low, RawFloat4)), Float4(static_cast<float>(kEntries - 1)));
  const HalfSpaceTerms<Float4> change{next[0] - rows[0], next[1] - rows[1], next[2] - rows[2]};
  const HalfSpaceTerms<Float4> here{rows[0] + share * change.psi, rows[1] + share * change.s,
                                    rows[2] + share * change.t};
  // Shorter than a unit vector beside the half-space's surface, so that nothing jumps on the line through the
  // organ under the contact.
  const Float4 by_r = Float4(1.0F) / max(r, Float4(1e-7F));
  const Float4x3 e = by_r * (offset - dot(offset, inward) * inward);
  const Float4 normal(force.normal);
  const Float4x3 side = lanes_of(force.side);
  const bool presses = force.side.isZero(0.0F);
  const auto displacement = [&](const HalfSpaceTerms<Float4>& terms) __attribute__((always_inline)) {
    return presses ? half_space_displacement(terms, e, inward, normal)
                   : half_space_displacement(terms, e, inward, normal, side);
  };
  motions.displacement = motions.displacement + displacement(here);
  const Float4x3 slope = select(reached, Float4(per_metre_) * by_r, zero) * displacement(change);
  motions.gradient[0] = motions.gradient[0] + offset.x * slope;
  motions.gradient[1] = motions.gradient[1] + offset.y * slope;
  motions.gradient[2] = motions.gradient[2] + offset.z * slope;
}

void NearFieldChange::set(const NearField* before, const NearField* now) noexcept {
  const NearField none;
  const NearField& a = before != nullptr ? *before : none;
  const NearField& b = now != nullptr ? *now : none;
  const bool both = before != nullptr && now != nullptr;
  point_ = now != nullptr ? b.point_ : a.point_;
  drift_ = both ? (b.point_ - a.point_).norm() : 0.0F;
  per_metre_ = std::max(a.per_metre_, b.per_metre_);
  const float turn = both ? (b.inward_ - a.inward_).norm() : 0.0F;
  const float side = b.force_.side.norm();
  const float side_before = a.force_.side.norm();
  float beyond = 0.0F;
  bounds_.back() = 0.0F;
  for (std::size_t i = NearField::kEntries; i-- > 0;) {
    const HalfSpaceTerms<float>& here = b.terms_[i];
    // At the same distance in the same direction.
    const float by_normal =
        under_normal(difference(scaled(here, b.force_.normal), scaled(a.terms_[i], a.force_.normal)));
    const float by_side = (b.force_.side - a.force_.side).norm() * under_side(here) +
                          side_before * under_side(difference(here, a.terms_[i]));
    float bound = by_normal + by_side;
    if (drift_ > 0.0F || turn > 0.0F) {
      // Nearer or farther, and in another direction e.
      const HalfSpaceTerms<float> step = difference(b.terms_[i + 1], here);
      bound +=
          drift_ * per_metre_ * (std::abs(b.force_.normal) * under_normal(step) + side * under_side(step));
      const float r = static_cast<float>(i) / per_metre_;
      const float e_turn = r > 0.0F ? std::min(2.0F, 2.0F * (drift_ / r + turn)) : 2.0F;
      const HalfSpaceTerms<float> most{std::max(std::abs(here.psi), std::abs(b.terms_[i + 1].psi)),
                                       std::max(std::abs(here.s), std::abs(b.terms_[i + 1].s)),
                                       std::max(std::abs(here.t), std::abs(b.terms_[i + 1].t))};
      bound += std::abs(b.force_.normal) *
               (2.0F * (1.0F - kNu) * most.psi * turn + (1.0F - 2.0F * kNu) * most.s * e_turn);
      bound += side * ((4.0F * kNu * (most.psi + 2.0F * most.t) + (1.0F - 2.0F * kNu) * most.s) * e_turn +
                       (1.0F - 2.0F * kNu) * most.s * turn);
    }
    beyond = std::max(beyond, bound);
    bounds_[i] = beyond;
  }
}

float NearFieldChange::at(float distance) const noexcept {
  const float entry = std::max(0.0F, (distance - drift_) * per_metre_);
  return bounds_[std::min(static_cast<std::size_t>(entry), NearField::kEntries)];
}

}  // namespace palpate::deform

#include "core/contact/load_sharing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/portable_math.h"
#include "core/contact/state.h"

namespace palpate::contact {
namespace {

/// Overlap weight c_ij = max(0, 1 - (r_ij/R_ref)^2): 1 for coincident contacts, 0 from R_ref. r_ij is the
/// length of the arc given by the chord and the two normals.
double overlap_weight(const Load& a, const Load& b, double reference_radius) noexcept {
  const double chord_squared = (a.at.point - b.at.point).squaredNorm();
  if (chord_squared >= reference_radius * reference_radius) return 0.0;  // the arc is longer than its chord
  const double cosine = std::clamp(a.normal.dot(b.normal), -1.0, 1.0);
  const double half_sine = std::sqrt(0.5 * (1.0 - cosine));
  constexpr double kStraight = 1e-6;  // below this the arc is its chord
  const double stretch = half_sine > kStraight ? 0.5 * portable::acos(cosine) / half_sine : 1.0;
  const double ratio_squared = chord_squared * stretch * stretch / (reference_radius * reference_radius);
  return std::max(0.0, 1.0 - ratio_squared);
}

double eighth_power(double x) noexcept {
  const double x2 = x * x;
  const double x4 = x2 * x2;
  return x4 * x4;
}

/// Share of contact i: 1 - C + C / (1 + S), with C = max c_ij. S is the sum of c_ij (F_j/F_i)^8 over the
/// other contacts where c_ij = C. A contact with a smaller c_ij enters S with the weight that would, at C,
/// lower the share by as much as that contact lowers it alone. So its weight starts at 0 when it comes within
/// R_ref, however strong it is (docs/decisions/0010).
double load_share(const Load& one, std::span<Load* const> contacts, double reference_radius,
                  bool with_fading) noexcept {
  std::array<double, kMaxContacts> overlap_weights;  // of contacts within R_ref
  std::array<double, kMaxContacts> relative_loads;   // c_ij (F_j/F_i)^8
  std::size_t count = 0;
  double greatest = 0.0;
  for (const Load* const other : contacts) {
    if (other == &one || (other->fading() && !with_fading)) continue;
    const double close = overlap_weight(one, *other, reference_radius);
    if (close <= 0.0) continue;
    greatest = std::max(greatest, close);
    if (!(one.elastic_force > 0.0)) continue;
    overlap_weights[count] = close;
    relative_loads[count++] = close * eighth_power(other->elastic_force / one.elastic_force);
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    if (overlap_weights[k] == greatest) {
      sum += relative_loads[k];
    } else {
      const double lowers = overlap_weights[k] * (1.0 - 1.0 / (1.0 + relative_loads[k]));
      sum += lowers / (greatest - lowers);
    }
  }
  return 1.0 - greatest + greatest / (1.0 + sum);
}

}  // namespace

void share_load(double reference_radius, std::span<Load* const> contacts) noexcept {
  double fading = 0.0;  // largest fade weight of a fading contact
  for (const Load* const contact : contacts) {
    if (contact->fading()) fading = std::max(fading, contact->fade_weight);
  }
  for (Load* const one : contacts) {
    one->share = load_share(*one, contacts, reference_radius, true);
    if (one->fading()) {
      one->share *= one->fade_weight;
    } else if (fading > 0.0) {  // blend between the share with and without the fading contacts
      one->share = fading * one->share + (1.0 - fading) * load_share(*one, contacts, reference_radius, false);
    }
  }
}

void merge_histories(Load& a, Load& b) noexcept {
  const double elastic = a.memory.elastic + b.memory.elastic;
  if (!(elastic > 0.0)) return;
  for (std::size_t i = 0; i < model::kMaxRelaxationTerms; ++i) {
    const double kept = (a.memory.history[i] + b.memory.history[i]) / elastic;
    a.memory.history[i] = kept * a.memory.elastic;
    b.memory.history[i] = kept * b.memory.elastic;
  }
}

}  // namespace palpate::contact

// A needle in layered tissue (docs/needle.md). The needle's tip presses like any tool until the force along
// the needle reaches the puncture force of the first layer. From then on, until the needle has left, this
// file gives the force in place of the press.
//
// Along the needle. The tissue is carried by u, its displacement at the entry: F = f(u), the press law for
// u > 0, the pull law for u < 0, with relaxation. The shaft inside has the length L, so the tip is at the way
// z = u + L along the direction a in which the needle went in. In a tick z is given, and
//
// 1. without slip, u takes up all of the motion;
// 2. where F exceeds the bound on the tip plus phi(L), the tip slips inwards: u falls to where F is the
//    bound, and L grows. In a channel that is cut already the tip's bound is 0. At the channel's end it is
//    the layer's cutting force, at a membrane the puncture force of the layer behind it, so the membrane is
//    indented first;
// 3. where F is below -phi(L), the shaft slips outwards: L falls. Where phi falls faster than f, the tissue
//    snaps off; it does so within kFallTime, not in one tick. The needle is out at L <= 0 and F = 0.
//
// phi(L) is the sum over the layers of friction min(1, L_j/1 mm) + friction per length x L_j. After a
// puncture the bound falls from the puncture force to the cutting force with the time constant kFallTime.
//
// A slip has the sign of the force, and f is the slope of a convex energy evaluated at the tick's end. So the
// work of the hand in a tick is at least the growth of the stored energy: no closed path gives energy.
//
// Across the needle. The channel holds a rigid shaft by springs, k_j per length in layer j. A spring is
// relaxed where the tip was when it cut there. Force and torque depend on the springs' rest positions only by
// two moments, so a straight rest line with the same moments replaces them. The line has at most the energy
// of the springs, and a spring that the needle leaves takes its energy along, so this is passive too. The
// springs' force is perpendicular to the shaft.
//
// Layers follow the organ's surface inwards: the layer at the tip is that of the depth of its material point
// below the rest surface. Left out: bending of the needle, the tissue's own sideways motion, load sharing
// with other tools' contacts.

#include "core/contact/needle.h"

#include <algorithm>
#include <limits>

#include "core/base/portable_math.h"
#include "core/contact/state.h"

namespace palpate::contact {
namespace {

constexpr double kTipReach = 2e-3;        // m: a contact is at the tip within it, or within the diameter
constexpr double kFlattest = 0.2;         // least cosine between needle and normal for a puncture
constexpr double kFallTime = 20e-3;       // s, of the tip's force after a puncture
constexpr double kFrictionLength = 1e-3;  // m, in which the constant friction of a layer grows
constexpr double kPastBoundary = 1e-6;    // m, that a tip is past a boundary when it has crossed it
constexpr double kRateReference = 1e-3;   // m/s, of the rate term
constexpr int kMaxSteps = 20;             // of the search for the slip with a rate term
constexpr double kSameSlip = 1e-9;        // m, at which it ends, and from the hub
constexpr int kMaxSlips = 4;              // of different bounds in one tick
constexpr double kLeastTurn = 0.2;        // cosine between needle and channel: beyond it the needle is lost

/// The contact that carries the tip, or null: the one with the largest force near it.
const Proxy* contact_at_tip(const geometry::Needle& needle, const Vec3& tip_S,
                            std::span<PartState> parts) noexcept {
  const double reach = std::max(kTipReach, needle.diameter);
  const Proxy* best = nullptr;
  for (PartState& part : parts) {
    for (const Proxy& contact : part.active()) {
      if (contact.load().fading() || !(contact.depth() > 0.0)) continue;
      if ((contact.application_point() - tip_S).norm() > reach) continue;
      if (best == nullptr || contact.force().normal > best->force().normal) best = &contact;
    }
  }
  return best;
}

/// Depth range of a layer below the organ's surface [m]; the space outside ends at depth 0.
struct DepthRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = 0.0;
};

DepthRange range_of(const std::vector<model::TissueLayer>& layers, int layer) noexcept {
  DepthRange range;
  for (int i = 0; i <= layer; ++i) {
    range.low = range.high;
    range.high += layers[static_cast<std::size_t>(i)].thickness;
  }
  return range;
}

/// Of the membrane between two neighbouring layers [N]: that of the deeper one.
double puncture_between(const std::vector<model::TissueLayer>& layers, int one, int other) noexcept {
  return layers[static_cast<std::size_t>(std::max({one, other, 0}))].puncture_force;
}

/// Moments of the springs across the shaft: the integrals of k, k s, k s^2 over its length.
struct Moments {
  double zeroth = 0.0;
  double first = 0.0;
  double second = 0.0;

  void add(double stiffness, double from, double to) noexcept {
    zeroth += stiffness * (to - from);
    first += stiffness * (to * to - from * from) / 2.0;
    second += stiffness * (to * to * to - from * from * from) / 3.0;
  }
};

}  // namespace

struct NeedleInsertion::Tick {
  const OrganSurface* surface;  // null: flat, at z = 0
  const ToolTissue& tissue;
  const std::vector<model::TissueLayer>& layers;
  const geometry::Needle& needle;
  Vec3 tip_S;
  double period;
  double outwards;  // motion of the tip outwards in this tick [m], >= 0
  Vec3 unstrained;  // from the tip to its material point at displacement 0

  /// The tip's material point where the tissue is displaced by `displacement` along `direction`.
  [[nodiscard]] Vec3 material(double displacement, const Vec3& direction) const noexcept {
    return tip_S + unstrained - displacement * direction;
  }

  /// Without the rate term.
  [[nodiscard]] double cutting_force(int layer, const Vec3& tip_material) const noexcept {
    if (layer == kOutsideLayers) return 0.0;
    double force = layers[static_cast<std::size_t>(layer)].cutting_force;
    for (const InclusionNow& one : tissue.inclusions) {  // a stone stops the tip, a cyst gives way
      if ((tip_material - one.centre_S).squaredNorm() < one.radius * one.radius) force *= one.ratio;
    }
    return force;
  }
};

/// Elastic force [N] at a displacement.
double NeedleInsertion::elastic_at(const TissueLaws& laws, double displacement) const noexcept {
  return displacement >= 0.0 ? amplitude_ * laws.press.force_at(displacement * slant_).force
                             : -amplitude_ * laws.pull.force_at(-displacement * slant_).force;
}

double NeedleInsertion::displacement_under(const TissueLaws& laws, double elastic) const noexcept {
  return elastic >= 0.0 ? laws.press.deformation_under(elastic / amplitude_).depth / slant_
                        : -laws.pull.deformation_under(-elastic / amplitude_).depth / slant_;
}

/// The whole shaft is inside: the hub takes up what the tip and the shaft's friction do not.
bool NeedleInsertion::is_at_hub(const geometry::Needle& needle) const noexcept {
  return needle.length - length_ < kSameSlip;
}

int NeedleInsertion::layer_at_tip() const noexcept {
  std::size_t piece = 0;
  while (piece + 1 < piece_count_ && pieces_[piece + 1].start < length_) ++piece;
  return length_ >= cut_ ? pieces_[piece_count_ - 1].layer : pieces_[piece].layer;
}

double NeedleInsertion::shaft_friction(const Tick& tick) const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < piece_count_ && pieces_[i].start < length_; ++i) {
    if (pieces_[i].layer == kOutsideLayers) continue;
    const double end = i + 1 < piece_count_ ? std::min(pieces_[i + 1].start, length_) : length_;
    const double inside = end - pieces_[i].start;
    const model::TissueLayer& layer = tick.layers[static_cast<std::size_t>(pieces_[i].layer)];
    sum += layer.friction * std::min(1.0, inside / kFrictionLength) + layer.friction_per_length * inside;
  }
  return sum;
}

double NeedleInsertion::tip_bound(const Tick& tick) const noexcept {
  if (length_ < cut_) return 0.0;
  const int layer = pieces_[piece_count_ - 1].layer;
  const double cutting = tick.cutting_force(layer, tick.material(displacement_, direction_)) + surplus_;
  return at_membrane_ ? std::max(cutting, puncture_between(tick.layers, layer, beyond_)) : cutting;
}

/// The channel goes on into another layer.
void NeedleInsertion::enter(const Tick& tick, int layer, bool punctured) noexcept {
  const double bound = tip_bound(tick);
  at_membrane_ = false;
  if (piece_count_ < kMaxPieces) {
    pieces_[piece_count_++] = {cut_, layer};
  } else {
    pieces_[kMaxPieces - 1].layer = layer;  // a path along a boundary; its last pieces count as one
  }
  const double cutting = tick.cutting_force(layer, tick.material(displacement_, direction_));
  surplus_ = std::max(0.0, bound - cutting);
  if (punctured) state_.punctured = true;
}

/// Cuts on by `way`, or up to the next membrane. @return the way cut [m]
double NeedleInsertion::cut(const Tick& tick, double way) noexcept {
  const Vec3 end = tick.material(displacement_ - way, direction_);
  double depth = -end.z();
  if (tick.surface != nullptr) {
    const geometry::NearestPoint nearest = tick.surface->nearest(end, guess_);
    guess_ = nearest.triangle;
    depth = -nearest.distance;
  }
  const int layer = pieces_[piece_count_ - 1].layer;
  const DepthRange range = range_of(tick.layers, layer);
  if (depth <= range.high + kPastBoundary && depth >= range.low - kPastBoundary) {
    front_depth_ = depth;
    return way;
  }
  const bool deeper = depth > range.high;
  const double boundary = deeper ? range.high : range.low;
  const double share = (boundary - front_depth_) / (depth - front_depth_);
  front_depth_ = boundary;
  beyond_ = deeper ? layer + 1 : layer - 1;
  at_membrane_ = true;
  return way * std::clamp(share, 0.0, 1.0);
}

/// The slip s in a tick at which f(u - s) is the bound with the rate term, where `most` is that without it.
/// f falls with s and the bound rises, so there is one between 0 and `most` (regula falsi, Illinois).
double NeedleInsertion::rated_slip(const Tick& tick, const model::Relaxation::Line& line, double bound,
                                   double most) const noexcept {
  const int layer = pieces_[piece_count_ - 1].layer;
  if (layer == kOutsideLayers) return most;
  const double exponent = tick.layers[static_cast<std::size_t>(layer)].rate_exponent;
  if (exponent == 0.0) return most;
  const double cutting = tick.cutting_force(layer, tick.material(displacement_, direction_));
  const auto excess = [&](double slip) {
    const double rate = slip / tick.period / kRateReference;
    const double more = cutting * portable::expm1(exponent * portable::log(1.0 + rate));
    return line.at_zero + line.slope * elastic_at(tick.tissue.laws, displacement_ - slip) - bound - more;
  };
  double low = 0.0;
  double high = most;
  double at_low = excess(low);
  double at_high = excess(high);
  for (int i = 0; i < kMaxSteps && high - low > kSameSlip && at_high < 0.0; ++i) {
    const double between = low + (high - low) * at_low / (at_low - at_high);
    const double at_between = excess(between);
    if (at_between > 0.0) {
      low = between;
      at_low = at_between;
      at_high /= 2.0;
    } else {
      high = between;
      at_high = at_between;
      at_low /= 2.0;
    }
  }
  return low;
}

void NeedleInsertion::slip_inwards(const Tick& tick, const model::Relaxation::Line& line) noexcept {
  const TissueLaws& laws = tick.tissue.laws;
  for (int i = 0; i < kMaxSlips; ++i) {
    const double bound = tip_bound(tick) + shaft_friction(tick);
    const double elastic = (bound - line.at_zero) / line.slope;
    if (elastic_at(laws, displacement_) <= elastic || is_at_hub(tick.needle)) return;
    if (at_membrane_ && length_ >= cut_) {
      const int layer = pieces_[piece_count_ - 1].layer;
      enter(tick, beyond_, puncture_between(tick.layers, layer, beyond_) > 0.0);
      continue;
    }
    double whole = displacement_ - displacement_under(laws, elastic);
    if (length_ >= cut_) whole = rated_slip(tick, line, bound, whole);
    double way = std::max(0.0, std::min(whole, tick.needle.length - length_));
    if (length_ < cut_) {
      way = std::min(way, cut_ - length_);
      length_ = way < cut_ - length_ ? length_ + way : cut_;
    } else {
      way = cut(tick, way);
      length_ += way;
      cut_ = length_;
    }
    displacement_ -= way;
    state_.slip = 1;
    if (way >= whole) return;
  }
}

void NeedleInsertion::slip_outwards(const Tick& tick, const model::Relaxation::Line& line) noexcept {
  const TissueLaws& laws = tick.tissue.laws;
  const double elastic = (-shaft_friction(tick) - line.at_zero) / line.slope;
  if (elastic_at(laws, displacement_) >= elastic) return;
  const double whole = displacement_under(laws, elastic) - displacement_;
  const double longest = tick.outwards + (std::max(0.0, length_) + kFrictionLength) * tick.period / kFallTime;
  const double way = std::min(whole, longest);
  length_ -= way;
  displacement_ += way;
  state_.slip = -1;
  if (way < whole || length_ > 0.0) return;
  release_at_once();
  state_.left = true;
}

/// Force and torque of the springs across the shaft.
void NeedleInsertion::bind_sideways(const Tick& tick, const ShaftLine& shaft) noexcept {
  const auto moments_to = [&](double end) {
    Moments moments;
    for (std::size_t i = 0; i < piece_count_ && pieces_[i].start < end; ++i) {
      if (pieces_[i].layer == kOutsideLayers) continue;
      const double to = i + 1 < piece_count_ ? std::min(pieces_[i + 1].start, end) : end;
      moments.add(tick.layers[static_cast<std::size_t>(pieces_[i].layer)].lateral_stiffness, pieces_[i].start,
                  to);
    }
    return moments;
  };
  const Moments held = moments_to(length_);
  if (length_ > bound_length_) {  // new springs are relaxed at the shaft's end
    const Moments before = moments_to(bound_length_);
    const Vec3 added = shaft.at(length_);
    const Vec3 zeroth =
        before.zeroth * rest_.at_entry + before.first * rest_.slope + (held.zeroth - before.zeroth) * added;
    const Vec3 first =
        before.first * rest_.at_entry + before.second * rest_.slope + (held.first - before.first) * added;
    const double determinant = held.zeroth * held.second - held.first * held.first;
    if (determinant > 1e-9 * held.zeroth * held.second) {
      rest_.at_entry = (held.second * zeroth - held.first * first) / determinant;
      rest_.slope = (held.zeroth * first - held.first * zeroth) / determinant;
    } else {
      rest_.slope = shaft.slope;
      rest_.at_entry = held.zeroth > 0.0 ? Vec3((zeroth - held.first * rest_.slope) / held.zeroth)
                                         : Vec3(added - length_ * shaft.slope);
    }
  }
  bound_length_ = length_;
  const Vec3 offset = shaft.at_entry - rest_.at_entry;
  const Vec3 turn = shaft.slope - rest_.slope;
  const auto on_shaft = [&](const Vec3& lateral) -> Vec3 {  // perpendicular to the shaft
    return lateral - lateral.dot(shaft.slope) * direction_;
  };
  const Vec3 force = on_shaft(-(held.zeroth * offset + held.first * turn));
  const Vec3 moment = on_shaft(-(held.first * offset + held.second * turn));
  force_ += force;
  torque_ += (origin_ + shaft.at_entry).cross(force) + (direction_ + shaft.slope).cross(moment);
}

bool NeedleInsertion::try_puncture(const OrganSurface& surface, const ToolTissue& tissue,
                                   const std::vector<model::TissueLayer>& layers,
                                   const geometry::Needle& needle, const Pose& tool_S,
                                   std::span<PartState> parts) noexcept {
  const Vec3 tip_S = tool_S * needle.tip;
  const Proxy* const contact = contact_at_tip(needle, tip_S, parts);
  if (contact == nullptr) return false;
  const Vec3 direction = tool_S.rotation * needle.axis;
  const Load& load = contact->load();
  const double slant = -load.normal.dot(direction);
  const PressForce& press = contact->force();
  const Vec3 force = load.share * (press.normal * load.normal + press.friction + press.lateral);
  if (slant < kFlattest || -force.dot(direction) < layers.front().puncture_force) return false;
  const double uniform = tissue.laws.press.force_at(contact->depth()).force;
  if (!(uniform > 0.0) || !(load.elastic_force > 0.0)) return false;

  *this = {};
  inside_ = true;
  direction_ = direction;
  slant_ = std::min(1.0, slant);
  amplitude_ = slant_ * load.share * load.elastic_force / uniform;
  displacement_ = contact->depth() / slant_;
  origin_ = tip_S - displacement_ * direction_;
  const geometry::NearestPoint nearest = surface.nearest(origin_, load.at.triangle);
  entry_ = {nearest.point, nearest.triangle};
  guess_ = nearest.triangle;
  memory_ = load.memory;
  memory_.elastic *= load.share * slant_;
  for (double& history : memory_.history) history *= load.share * slant_;
  pieces_[piece_count_++] = {};
  tip_radius_ = contact->patch().tip_radius;
  radius_ = needle.diameter / 2.0;
  surplus_ = std::max(0.0, -force.dot(direction) - layers.front().cutting_force);
  state_.punctured = true;
  return true;
}

void NeedleInsertion::puncture_flat(const std::vector<model::TissueLayer>& layers, double depth, double force,
                                    const model::RelaxationState& memory) noexcept {
  *this = {};
  inside_ = true;
  direction_ = -Vec3::UnitZ();
  displacement_ = depth;
  memory_ = memory;
  pieces_[piece_count_++] = {};
  surplus_ = std::max(0.0, force - layers.front().cutting_force);
  state_.punctured = true;
}

void NeedleInsertion::advance(const OrganSurface* surface, const ToolTissue& tissue,
                              const std::vector<model::TissueLayer>& layers, const geometry::Needle& needle,
                              const Pose& tool_S, double period) noexcept {
  const Vec3 axis = tool_S.rotation * needle.axis;
  const double along = axis.dot(direction_);
  if (along < kLeastTurn) {
    release_at_once();
    state_.left = true;
    return;
  }
  const Vec3 tip_S = tool_S * needle.tip;
  const Vec3 from_origin = tip_S - origin_;
  const double way = from_origin.dot(direction_);
  const double outwards = std::max(0.0, displacement_ + length_ - way);
  const Tick tick{surface, tissue, layers, needle, tip_S, period, outwards, entry_.point - origin_};
  displacement_ = way - length_;
  if (surplus_ > 0.0) surplus_ *= portable::exp(-period / kFallTime);
  state_.slip = 0;
  const model::Relaxation& relaxation = tissue.laws.relaxation;
  const model::Relaxation::Line line = relaxation.next_line(memory_);
  slip_inwards(tick, line);
  slip_outwards(tick, line);
  if (!inside_) return;

  const double elastic = elastic_at(tissue.laws, displacement_);
  const double axial = relaxation.count() > 0 ? relaxation.next(memory_, elastic) : elastic;
  force_ = -axial * direction_;
  torque_ = tick.tip_S.cross(force_);
  ShaftLine shaft;
  shaft.slope = axis / along - direction_;
  shaft.at_entry = from_origin - way * direction_ - way * shaft.slope;
  bind_sideways(tick, shaft);
  torque_ -= tool_S.position.cross(force_);

  response_ = displacement_ >= 0.0 ? tissue.laws.press.force_at(displacement_ * slant_)
                                   : tissue.laws.pull.force_at(-displacement_ * slant_);
  const double friction = shaft_friction(tick);
  state_.layer = static_cast<std::uint32_t>(layer_at_tip() + 1);
  state_.length = std::max(0.0, length_);
  state_.tip_force = std::max(0.0, axial - friction);
  state_.at_hub = is_at_hub(needle);
  if (state_.at_hub) state_.tip_force = std::min(state_.tip_force, tip_bound(tick));
}

}  // namespace palpate::contact

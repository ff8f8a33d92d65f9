#include "core/deform/surface_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/surface.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr auto kAlikeSquared = static_cast<float>(kAlike);

struct Lanes3 {
  Lanes x, y, z;
};

Lanes3 lanes_of(const Vector3f& v) { return {Lanes(v.x()), Lanes(v.y()), Lanes(v.z())}; }
Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Lanes3 operator*(const Lanes& s, const Lanes3& a) { return {s * a.x, s * a.y, s * a.z}; }
Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Lanes3 select(const LaneMask& mask, const Lanes3& a, const Lanes3& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
// Normalizes; a zero vector stays zero.
Lanes3 unit(const Lanes3& a) { return (Lanes(1.0F) / sqrt(max(dot(a, a), Lanes(1e-30F)))) * a; }

// Four vertices at rest.
struct Rest {
  Lanes3 place, normal;
};

// One contact's effect on four vertices.
struct Effect {
  LaneMask moves;
  Lanes3 displacement;  // [m]; zero out of reach
  Lanes3 derived;       // derivative of the displacement along `along`
  Lanes3 along;         // unit, tangent to the surface, away from the contact
};

[[gnu::always_inline]] inline Effect effect_of(const ContactField& contact, const ProfileTable& profile,
                                               const Lanes& excess, const Rest& rest) {
  const Lanes zero(0.0F);
  const Lanes3 offset = rest.place - lanes_of(contact.point);
  const Lanes r = sqrt(dot(offset, offset)) + max(excess - Lanes(contact.own_excess), zero);
  Effect effect;
  // Adds one part of the displacement and its derivative.
  const auto add = [&](const Vector3f& part, float reach, float lowered) {
    const ProfileTable::LaneValue value = profile.at(r * Lanes(1.0F / reach));
    const Lanes left = Lanes(1.0F / (1.0F - lowered));
    const Lanes share = max(zero, (value.u - Lanes(lowered)) * left);
    const LaneMask moves = share > zero;
    const Lanes slope = select(moves, value.slope * left * Lanes(1.0F / reach), zero);
    effect.moves = effect.moves | moves;
    effect.displacement = effect.displacement + share * lanes_of(part);
    effect.derived = effect.derived + slope * lanes_of(part);
  };
  effect.moves = LaneMask(false);
  effect.displacement = effect.derived = {zero, zero, zero};
  if (contact.side_reach == contact.reach && contact.lowered_side == contact.lowered) {
    add(contact.normal_part + contact.side_part, contact.reach, contact.lowered);
  } else {
    add(contact.normal_part, contact.reach, contact.lowered);
    add(contact.side_part, contact.side_reach, contact.lowered_side);
  }
  const Lanes3 in_surface = offset - dot(offset, rest.normal) * rest.normal;
  const Lanes squared = dot(in_surface, in_surface);
  effect.along = select(squared > Lanes(1e-14F), Lanes(1.0F) / sqrt(squared), zero) * in_surface;
  return effect;
}

// Four displaced vertices.
struct Moved {
  LaneMask moves;
  Lanes3 displacement, normal;
};

Moved under_one(const ContactField& contact, const ProfileTable& profile, const Lanes& excess,
                const Rest& rest) {
  const Effect effect = effect_of(contact, profile, excess, rest);
  const Lanes3 normal = (Lanes(1.0F) + dot(effect.derived, effect.along)) * rest.normal -
                        dot(effect.derived, rest.normal) * effect.along;
  return {effect.moves, effect.displacement, unit(normal)};
}

// A sum of vectors, with its derivatives along the axes.
struct Sum3 {
  Lanes3 value;
  std::array<Lanes3, 3> derivative;

  // @param change derivative of v along `along`
  void add(const Lanes3& v, const Lanes3& change, const Lanes3& along) {
    value = value + v;
    derivative[0] = derivative[0] + along.x * change;
    derivative[1] = derivative[1] + along.y * change;
    derivative[2] = derivative[2] + along.z * change;
  }
};

struct Sum {
  Lanes value;
  Lanes3 derivative;

  void add(const Lanes& x, const Lanes& change, const Lanes3& along) {
    value += x;
    derivative = derivative + change * along;
  }
};

// Blend of the contacts that move four vertices. Lengths are in mm, so that their eighth powers stay in
// range.
struct Blend {
  LaneMask moves = LaneMask(false);
  Sum weights;      // sum of u^8
  Sum lengths;      // sum of u^9
  Sum squares;      // sum of u^2
  Sum3 directions;  // directions weighted by u^2

  Blend() {
    const Lanes zero(0.0F);
    const Lanes3 none{zero, zero, zero};
    weights = lengths = squares = {zero, none};
    directions = {none, {none, none, none}};
  }
  void add(const Effect& effect);
  [[nodiscard]] Moved result(const Rest& rest) const;
};

void Blend::add(const Effect& effect) {
  const Lanes zero(0.0F);
  const Lanes mm(1e3F);
  const Lanes3 displacement = mm * effect.displacement;
  const Lanes3 derived = mm * effect.derived;
  moves = moves | effect.moves;
  const Lanes u = sqrt(dot(displacement, displacement));
  const LaneMask clear = u > Lanes(1e-4F);
  const Lanes u_slope = select(clear, dot(displacement, derived) / max(u, Lanes(1e-4F)), zero);
  const Lanes second = u * u;
  const Lanes fourth = second * second;
  const Lanes weight = select(effect.moves, max(fourth * fourth, Lanes(1e-30F)), zero);
  const Lanes weight_slope = select(clear, Lanes(8.0F) * weight * u_slope / max(u, Lanes(1e-4F)), zero);
  weights.add(weight, weight_slope, effect.along);
  lengths.add(weight * u, weight_slope * u + weight * u_slope, effect.along);
  squares.add(second, Lanes(2.0F) * u * u_slope, effect.along);
  directions.add(u * displacement, u_slope * displacement + u * derived, effect.along);
}

Moved Blend::result(const Rest& rest) const {
  const Lanes zero(0.0F);
  const Lanes metre(1e-3F);
  // Mean length m and mean direction v, with derivatives.
  const Lanes share = Lanes(1.0F) / max(weights.value, Lanes(1e-30F));
  const Lanes m = share * lengths.value;
  const Lanes3 m_slope = share * (lengths.derivative - m * weights.derivative);
  const Lanes square_share = Lanes(1.0F) / max(squares.value, Lanes(1e-12F));
  const Lanes3 v = square_share * directions.value;
  const std::array<Lanes, 3> square_slope = {squares.derivative.x, squares.derivative.y,
                                             squares.derivative.z};
  // as mean_direction_gain()
  const Lanes q = dot(v, v);
  const Lanes bounded = max(q, Lanes(kAlikeSquared));
  const Lanes root = Lanes(1.0F) / sqrt(bounded);
  const LaneMask alike = q >= Lanes(kAlikeSquared);
  const Lanes gain = select(alike, root, root * (Lanes(1.5F) - Lanes(0.5F / kAlikeSquared) * q));
  const Lanes gain_slope = Lanes(-0.5F) * root / bounded;  // derivative with respect to q
  const std::array<Lanes, 3> m_slopes = {m_slope.x, m_slope.y, m_slope.z};
  std::array<Lanes3, 3> derivative;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Lanes3 v_slope = square_share * (directions.derivative[axis] - square_slope[axis] * v);
    const Lanes along_v = m_slopes[axis] * gain + Lanes(2.0F) * m * gain_slope * dot(v, v_slope);
    derivative[axis] = metre * (along_v * v + (m * gain) * v_slope);
  }
  derivative[0].x += Lanes(1.0F);
  derivative[1].y += Lanes(1.0F);
  derivative[2].z += Lanes(1.0F);
  // The transposed adjugate of I + J transforms normals.
  const Lanes3 normal = rest.normal.x * cross(derivative[1], derivative[2]) +
                        rest.normal.y * cross(derivative[2], derivative[0]) +
                        rest.normal.z * cross(derivative[0], derivative[1]);
  return {moves, (metre * m * gain) * v, select(dot(normal, normal) > zero, unit(normal), rest.normal)};
}

// @param excess_of(contact) geodesic excess of these vertices
template <typename ExcessOf>
Moved under(std::span<const ContactField* const> contacts, const ProfileTable& profile,
            const ExcessOf& excess_of, const Rest& rest) {
  if (contacts.size() == 1) return under_one(*contacts.front(), profile, excess_of(*contacts.front()), rest);
  Blend blend;
  for (const ContactField* contact : contacts) {
    const Effect effect = effect_of(*contact, profile, excess_of(*contact), rest);
    if (any(effect.moves)) blend.add(effect);
  }
  if (none(blend.moves)) return {blend.moves, blend.directions.value, rest.normal};
  return blend.result(rest);
}

// Writes the first `count` of four vertices.
void write(const Rest& rest, const Moved& moved, std::size_t count, SurfaceVertex* out) {
  const Lanes zero(0.0F);
  const Lanes3 displacement = select(moved.moves, moved.displacement, {zero, zero, zero});
  const Lanes3 place = rest.place + displacement;
  const Lanes3 normal = select(moved.moves, moved.normal, rest.normal);
  const Lanes length = sqrt(dot(displacement, displacement));
  const Lanes signed_length = select(dot(displacement, rest.normal) < zero, zero - length, length);
  // Each vertex is seven floats: two rows of four that share the fourth.
  static_assert(sizeof(SurfaceVertex) == 7 * sizeof(float));
  std::array<Lanes, kLanes> upper = {place.x, place.y, place.z, normal.x};
  std::array<Lanes, kLanes> lower = {normal.x, normal.y, normal.z, signed_length};
  transpose(upper);
  transpose(lower);
  for (std::size_t i = 0; i < count; ++i) {
    upper[i].store_unaligned(out[i].position.data());
    lower[i].store_unaligned(out[i].normal.data());
  }
}

}  // namespace

SurfaceBlocks::SurfaceBlocks(std::span<const Vector3f> vertices, std::span<const Vector3f> normals)
    : vertices_(vertices.size()) {
  const std::size_t filled = (vertices_ + kLanes - 1) / kLanes * kLanes;
  for (std::vector<float>* column : {&x_, &y_, &z_, &nx_, &ny_, &nz_}) column->assign(filled, 0.0F);
  for (std::size_t v = 0; v < vertices_; ++v) {
    x_[v] = vertices[v].x();
    y_[v] = vertices[v].y();
    z_[v] = vertices[v].z();
    nx_[v] = normals[v].x();
    ny_[v] = normals[v].y();
    nz_[v] = normals[v].z();
  }
  for (std::size_t begin = 0; begin < vertices_; begin += kBlock) {
    const std::span<const Vector3f> own = vertices.subspan(begin, std::min(kBlock, vertices_ - begin));
    Vector3f low = own.front();
    Vector3f high = own.front();
    for (const Vector3f& v : own) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    Sphere sphere;
    sphere.middle = 0.5F * (low + high);
    for (const Vector3f& v : own) sphere.radius = std::max(sphere.radius, (v - sphere.middle).norm());
    spheres_.push_back(sphere);
  }
}

std::size_t SurfaceBlocks::size(std::size_t block) const noexcept {
  return std::min(kBlock, vertices_ - first(block));
}

bool SurfaceBlocks::move(std::size_t block, std::span<const ContactField* const> contacts,
                         const ProfileTable& profile, SurfaceVertex* out) const noexcept {
  bool any_moved = false;
  const std::size_t begin = first(block);
  const std::size_t end = begin + size(block);
  for (std::size_t v = begin; v < end; v += kLanes) {
    const Rest rest{
        {Lanes::load_unaligned(&x_[v]), Lanes::load_unaligned(&y_[v]), Lanes::load_unaligned(&z_[v])},
        {Lanes::load_unaligned(&nx_[v]), Lanes::load_unaligned(&ny_[v]), Lanes::load_unaligned(&nz_[v])}};
    const Moved moved = under(
        contacts, profile,
        [v](const ContactField& contact) { return Lanes::load_unaligned(&contact.excess[v]); }, rest);
    any_moved = any_moved || any(moved.moves);
    write(rest, moved, std::min(kLanes, end - v), out + (v - begin));
  }
  return any_moved;
}

void SurfaceBlocks::rest(std::size_t block, SurfaceVertex* out) const noexcept {
  const std::size_t begin = first(block);
  for (std::size_t v = begin; v < begin + size(block); ++v)
    out[v - begin] = SurfaceVertex{Vector3f(x_[v], y_[v], z_[v]), Vector3f(nx_[v], ny_[v], nz_[v]), 0.0F};
}

}  // namespace palpate::deform

#include "palpate/deform/surface_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

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
  return {xsimd::select(mask, a.x, b.x), xsimd::select(mask, a.y, b.y), xsimd::select(mask, a.z, b.z)};
}
// Of length 1; a vector of no length stays so.
Lanes3 unit(const Lanes3& a) { return (Lanes(1.0F) / xsimd::sqrt(xsimd::max(dot(a, a), Lanes(1e-30F)))) * a; }

// Four vertices at rest.
struct Rest {
  Lanes3 place, normal;
};

// What one contact does to four vertices.
struct Effect {
  LaneMask moves;
  Lanes3 displacement;  // [m]; zero where it does not move
  Lanes3 derived;       // of the displacement along `along`
  Lanes3 along;         // unit, in the surface, away from the contact
};

[[gnu::always_inline]] inline Effect effect_of(const ContactField& contact, const ProfileTable& profile,
                                               const Lanes& excess, const Rest& rest) {
  const Lanes zero(0.0F);
  const Lanes3 offset = rest.place - lanes_of(contact.point);
  const Lanes r = xsimd::sqrt(dot(offset, offset)) + xsimd::max(excess - Lanes(contact.own_excess), zero);
  Effect effect;
  // The share of D, and its derivative.
  const auto add = [&](const Vector3f& part, float reach, float lowered) {
    const ProfileTable::LaneValue value = profile.at(r * Lanes(1.0F / reach));
    const Lanes left = Lanes(1.0F / (1.0F - lowered));
    const Lanes share = xsimd::max(zero, (value.u - Lanes(lowered)) * left);
    const LaneMask moves = share > zero;
    const Lanes slope = xsimd::select(moves, value.slope * left * Lanes(1.0F / reach), zero);
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
  effect.along =
      xsimd::select(squared > Lanes(1e-14F), Lanes(1.0F) / xsimd::sqrt(squared), zero) * in_surface;
  return effect;
}

// Where four vertices are.
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

// excess_of(contact): of these vertices.
template <typename ExcessOf>
Moved under_several(std::span<const ContactField* const> contacts, const ProfileTable& profile,
                    const ExcessOf& excess_of, const Rest& rest) {
  const Lanes zero(0.0F);
  const Lanes3 none{zero, zero, zero};
  Moved moved{LaneMask(false), none, rest.normal};
  // Sums over the contacts: of weights, weighted displacements, their derivative a column an axis, and the
  // weights' slope. Displacements count in mm, so that their eighth powers are no extreme numbers.
  Lanes weights = zero;
  Lanes3 displacements = none;
  std::array<Lanes3, 3> derivative = {none, none, none};
  Lanes3 weight_slopes = none;
  for (const ContactField* contact : contacts) {
    const Effect effect = effect_of(*contact, profile, excess_of(*contact), rest);
    if (xsimd::none(effect.moves)) continue;
    moved.moves = moved.moves | effect.moves;
    const Lanes squared = Lanes(1e6F) * dot(effect.displacement, effect.displacement);
    const Lanes fourth = squared * squared;
    const Lanes weight = xsimd::select(effect.moves, xsimd::max(fourth * fourth, Lanes(1e-30F)), zero);
    // Of the weight, along the surface away from this contact.
    const Lanes slope = xsimd::select(
        squared > Lanes(1e-8F),
        Lanes(8e6F) * weight * dot(effect.displacement, effect.derived) / xsimd::max(squared, Lanes(1e-8F)),
        zero);
    weights += weight;
    displacements = displacements + weight * effect.displacement;
    const Lanes3 change = weight * effect.derived + slope * effect.displacement;
    derivative[0] = derivative[0] + effect.along.x * change;
    derivative[1] = derivative[1] + effect.along.y * change;
    derivative[2] = derivative[2] + effect.along.z * change;
    weight_slopes = weight_slopes + slope * effect.along;
  }
  if (xsimd::none(moved.moves)) return moved;
  const Lanes share = Lanes(1.0F) / xsimd::max(weights, Lanes(1e-30F));
  moved.displacement = share * displacements;
  // I + J, whose adjugate's transpose carries normals.
  derivative[0] = share * (derivative[0] - weight_slopes.x * moved.displacement);
  derivative[1] = share * (derivative[1] - weight_slopes.y * moved.displacement);
  derivative[2] = share * (derivative[2] - weight_slopes.z * moved.displacement);
  derivative[0].x += Lanes(1.0F);
  derivative[1].y += Lanes(1.0F);
  derivative[2].z += Lanes(1.0F);
  const Lanes3 normal = rest.normal.x * cross(derivative[1], derivative[2]) +
                        rest.normal.y * cross(derivative[2], derivative[0]) +
                        rest.normal.z * cross(derivative[0], derivative[1]);
  moved.normal = select(dot(normal, normal) > zero, unit(normal), rest.normal);
  return moved;
}

template <typename ExcessOf>
Moved under(std::span<const ContactField* const> contacts, const ProfileTable& profile,
            const ExcessOf& excess_of, const Rest& rest) {
  if (contacts.size() == 1) return under_one(*contacts.front(), profile, excess_of(*contacts.front()), rest);
  return under_several(contacts, profile, excess_of, rest);
}

// The first `count` of four vertices, as the picture takes them.
void write(const Rest& rest, const Moved& moved, std::size_t count, LiveVertex* out) {
  const Lanes zero(0.0F);
  const Lanes3 displacement = select(moved.moves, moved.displacement, {zero, zero, zero});
  const Lanes3 place = rest.place + displacement;
  const Lanes3 normal = select(moved.moves, moved.normal, rest.normal);
  const Lanes length = xsimd::sqrt(dot(displacement, displacement));
  const Lanes signed_length = xsimd::select(dot(displacement, rest.normal) < zero, zero - length, length);
  // Each vertex is seven floats: two rows of four that share the fourth.
  static_assert(sizeof(LiveVertex) == 7 * sizeof(float));
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
                         const ProfileTable& profile, LiveVertex* out) const noexcept {
  bool any = false;
  const std::size_t begin = first(block);
  const std::size_t end = begin + size(block);
  for (std::size_t v = begin; v < end; v += kLanes) {
    const Rest rest{
        {Lanes::load_unaligned(&x_[v]), Lanes::load_unaligned(&y_[v]), Lanes::load_unaligned(&z_[v])},
        {Lanes::load_unaligned(&nx_[v]), Lanes::load_unaligned(&ny_[v]), Lanes::load_unaligned(&nz_[v])}};
    const Moved moved = under(
        contacts, profile,
        [v](const ContactField& contact) { return Lanes::load_unaligned(&contact.excess[v]); }, rest);
    any = any || xsimd::any(moved.moves);
    write(rest, moved, std::min(kLanes, end - v), out + (v - begin));
  }
  return any;
}

float SurfaceBlocks::change(std::size_t block, std::span<const ContactField* const> contacts,
                            const ProfileTable& profile, const LiveVertex* now) const noexcept {
  const std::size_t begin = first(block);
  std::array<std::size_t, kLanes> sample{};
  for (std::size_t i = 0; i < kLanes; ++i) sample[i] = (2 * i + 1) * size(block) / (2 * kLanes);
  const auto gather = [&sample](const float* from) {
    return Lanes({from[sample[0]], from[sample[1]], from[sample[2]], from[sample[3]]});
  };
  const Rest rest{{gather(&x_[begin]), gather(&y_[begin]), gather(&z_[begin])},
                  {gather(&nx_[begin]), gather(&ny_[begin]), gather(&nz_[begin])}};
  const Moved moved = under(
      contacts, profile, [&](const ContactField& contact) { return gather(&contact.excess[begin]); }, rest);
  const Lanes zero(0.0F);
  const Lanes3 place = rest.place + select(moved.moves, moved.displacement, {zero, zero, zero});
  const auto of = [&](Eigen::Index axis) {
    return Lanes({now[sample[0]].position[axis], now[sample[1]].position[axis], now[sample[2]].position[axis],
                  now[sample[3]].position[axis]});
  };
  const Lanes3 way = place - Lanes3{of(0), of(1), of(2)};
  return std::sqrt(largest_of(dot(way, way)));
}

void SurfaceBlocks::rest(std::size_t block, LiveVertex* out) const noexcept {
  const std::size_t begin = first(block);
  for (std::size_t v = begin; v < begin + size(block); ++v)
    out[v - begin] = LiveVertex{Vector3f(x_[v], y_[v], z_[v]), Vector3f(nx_[v], ny_[v], nz_[v]), 0.0F};
}

}  // namespace palpate::deform

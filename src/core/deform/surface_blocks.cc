#include "core/deform/surface_blocks.h"

#include <cmath>

#include "palpate/surface.h"

namespace palpate::deform {
namespace {

using Eigen::Vector3f;

constexpr auto kAlikeSquared = static_cast<float>(kAlike);

// Four vertices at rest.
struct Rest {
  Float4x3 place, normal;
};

// One contact's effect on four vertices.
struct Effect {
  Float4Mask moves;
  Float4x3 displacement;  // [m]; zero out of reach
  Float4x3 derived;       // derivative of the displacement along `along`
  Float4x3 along;         // unit, tangent to the surface, away from the contact
};

[[gnu::always_inline]] inline Effect effect_of(const ContactField& contact, const ProfileTable& profile,
                                               const Float4& excess, const Rest& rest) {
  const Float4 zero(0.0F);
  const Float4x3 offset = rest.place - lanes_of(contact.point);
  const Float4 r = sqrt(dot(offset, offset)) + max(excess - Float4(contact.own_excess), zero);
  Effect effect;
  // Adds one part of the displacement and its derivative.
  const auto add = [&](const Vector3f& part, float reach, float lowered) {
    const ProfileTable::Value4 value = profile.at(r * Float4(1.0F / reach));
    const Float4 left = Float4(1.0F / (1.0F - lowered));
    const Float4 share = max(zero, (value.u - Float4(lowered)) * left);
    const Float4Mask moves = share > zero;
    const Float4 slope = select(moves, value.slope * left * Float4(1.0F / reach), zero);
    effect.moves = effect.moves | moves;
    effect.displacement = effect.displacement + share * lanes_of(part);
    effect.derived = effect.derived + slope * lanes_of(part);
  };
  effect.moves = Float4Mask(false);
  effect.displacement = effect.derived = {zero, zero, zero};
  if (contact.side_reach == contact.reach && contact.lowered_side == contact.lowered) {
    add(contact.normal_part + contact.side_part, contact.reach, contact.lowered);
  } else {
    add(contact.normal_part, contact.reach, contact.lowered);
    add(contact.side_part, contact.side_reach, contact.lowered_side);
  }
  const Float4x3 in_surface = offset - dot(offset, rest.normal) * rest.normal;
  const Float4 squared = dot(in_surface, in_surface);
  effect.along = select(squared > Float4(1e-14F), Float4(1.0F) / sqrt(squared), zero) * in_surface;
  return effect;
}

// Four displaced vertices.
struct Moved {
  Float4Mask moves;
  Float4x3 displacement, normal;
};

Moved under_one(const ContactField& contact, const ProfileTable& profile, const Float4& excess,
                const Rest& rest) {
  const Effect effect = effect_of(contact, profile, excess, rest);
  const Float4x3 normal = (Float4(1.0F) + dot(effect.derived, effect.along)) * rest.normal -
                          dot(effect.derived, rest.normal) * effect.along;
  return {effect.moves, effect.displacement, unit(normal)};
}

// A sum of vectors, with its derivatives along the axes.
struct Sum3 {
  Float4x3 value;
  std::array<Float4x3, 3> derivative;

  // @param change derivative of v along `along`
  void add(const Float4x3& v, const Float4x3& change, const Float4x3& along) {
    value = value + v;
    derivative[0] = derivative[0] + along.x * change;
    derivative[1] = derivative[1] + along.y * change;
    derivative[2] = derivative[2] + along.z * change;
  }
};

struct Sum {
  Float4 value;
  Float4x3 derivative;

  void add(const Float4& x, const Float4& change, const Float4x3& along) {
    value += x;
    derivative = derivative + change * along;
  }
};

// Blend of the contacts that move four vertices. Lengths are in mm, so that their eighth powers stay in
// range.
struct Blend {
  Float4Mask moves = Float4Mask(false);
  Sum weights;      // sum of u^8
  Sum lengths;      // sum of u^9
  Sum squares;      // sum of u^2
  Sum3 directions;  // directions weighted by u^2

  Blend() {
    const Float4 zero(0.0F);
    const Float4x3 none{zero, zero, zero};
    weights = lengths = squares = {zero, none};
    directions = {none, {none, none, none}};
  }
  void add(const Effect& effect);
  [[nodiscard]] Moved result(const Rest& rest) const;
};

void Blend::add(const Effect& effect) {
  const Float4 zero(0.0F);
  const Float4 mm(1e3F);
  const Float4x3 displacement = mm * effect.displacement;
  const Float4x3 derived = mm * effect.derived;
  moves = moves | effect.moves;
  const Float4 u = sqrt(dot(displacement, displacement));
  const Float4Mask clear = u > Float4(1e-4F);
  const Float4 u_slope = select(clear, dot(displacement, derived) / max(u, Float4(1e-4F)), zero);
  const Float4 second = u * u;
  const Float4 fourth = second * second;
  const Float4 weight = select(effect.moves, max(fourth * fourth, Float4(1e-30F)), zero);
  const Float4 weight_slope = select(clear, Float4(8.0F) * weight * u_slope / max(u, Float4(1e-4F)), zero);
  weights.add(weight, weight_slope, effect.along);
  lengths.add(weight * u, weight_slope * u + weight * u_slope, effect.along);
  squares.add(second, Float4(2.0F) * u * u_slope, effect.along);
  directions.add(u * displacement, u_slope * displacement + u * derived, effect.along);
}

Moved Blend::result(const Rest& rest) const {
  const Float4 zero(0.0F);
  const Float4 metre(1e-3F);
  // Mean length m and mean direction v, with derivatives.
  const Float4 share = Float4(1.0F) / max(weights.value, Float4(1e-30F));
  const Float4 m = share * lengths.value;
  const Float4x3 m_slope = share * (lengths.derivative - m * weights.derivative);
  const Float4 square_share = Float4(1.0F) / max(squares.value, Float4(1e-12F));
  const Float4x3 v = square_share * directions.value;
  const std::array<Float4, 3> square_slope = {squares.derivative.x, squares.derivative.y,
                                              squares.derivative.z};
  // as mean_direction_gain()
  const Float4 q = dot(v, v);
  const Float4 bounded = max(q, Float4(kAlikeSquared));
  const Float4 root = Float4(1.0F) / sqrt(bounded);
  const Float4Mask alike = q >= Float4(kAlikeSquared);
  const Float4 gain = select(alike, root, root * (Float4(1.5F) - Float4(0.5F / kAlikeSquared) * q));
  const Float4 gain_slope = Float4(-0.5F) * root / bounded;  // derivative with respect to q
  const std::array<Float4, 3> m_slopes = {m_slope.x, m_slope.y, m_slope.z};
  std::array<Float4x3, 3> derivative;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Float4x3 v_slope = square_share * (directions.derivative[axis] - square_slope[axis] * v);
    const Float4 along_v = m_slopes[axis] * gain + Float4(2.0F) * m * gain_slope * dot(v, v_slope);
    derivative[axis] = metre * (along_v * v + (m * gain) * v_slope);
  }
  derivative[0].x += Float4(1.0F);
  derivative[1].y += Float4(1.0F);
  derivative[2].z += Float4(1.0F);
  const Float4x3 normal = turned_normal(rest.normal, derivative[0], derivative[1], derivative[2]);
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
  const Float4 zero(0.0F);
  const Float4x3 displacement = select(moved.moves, moved.displacement, {zero, zero, zero});
  const std::array<SurfaceVertex*, kLanes> vertices = {out, out + 1, out + 2, out + 3};
  write_vertices({rest.place + displacement, select(moved.moves, moved.normal, rest.normal)}, displacement,
                 rest.normal, std::span(vertices).first(count));
}

}  // namespace

void write_vertices(const FourVertices& four, const Float4x3& displacement, const Float4x3& rest_normal,
                    std::span<SurfaceVertex* const> out) noexcept {
  const Float4 zero(0.0F);
  const Float4 length = sqrt(dot(displacement, displacement));
  const Float4 signed_length = select(dot(displacement, rest_normal) < zero, zero - length, length);
  // Each vertex is seven floats: two rows of four that share the fourth.
  static_assert(sizeof(SurfaceVertex) == 7 * sizeof(float));
  std::array<Float4, kLanes> upper = {four.position.x, four.position.y, four.position.z, four.normal.x};
  std::array<Float4, kLanes> lower = {four.normal.x, four.normal.y, four.normal.z, signed_length};
  transpose(upper);
  transpose(lower);
  for (std::size_t i = 0; i < out.size(); ++i) {
    upper[i].store_unaligned(out[i]->position.data());
    lower[i].store_unaligned(out[i]->normal.data());
  }
}

FourVertices read_vertices(const std::array<const SurfaceVertex*, kLanes>& from) noexcept {
  std::array<Float4, kLanes> upper;
  std::array<Float4, kLanes> lower;
  for (std::size_t i = 0; i < kLanes; ++i) {
    upper[i] = Float4::load_unaligned(from[i]->position.data());
    lower[i] = Float4::load_unaligned(from[i]->normal.data());
  }
  transpose(upper);
  transpose(lower);
  return {{upper[0], upper[1], upper[2]}, {lower[0], lower[1], lower[2]}};
}

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
        {Float4::load_unaligned(&x_[v]), Float4::load_unaligned(&y_[v]), Float4::load_unaligned(&z_[v])},
        {Float4::load_unaligned(&nx_[v]), Float4::load_unaligned(&ny_[v]), Float4::load_unaligned(&nz_[v])}};
    const Moved moved = under(
        contacts, profile,
        [v](const ContactField& contact) { return Float4::load_unaligned(&contact.excess[v]); }, rest);
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

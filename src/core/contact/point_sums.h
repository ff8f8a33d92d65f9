#pragma once
#include <cstdint>
#include <span>

#include "core/contact/support.h"

namespace palpate::contact {

/// Numbers behind those of some points, which the functions below may write too: they work on four at a time.
inline constexpr std::size_t kDepthsBehind = 3;

/// [rt] How deep some points of a part are behind a plane, at full depth (none so far from the axis that it
/// tapers). @param depths room for kDepthsBehind more than there are points. @return the greatest, 0 when
/// none is behind [m]
double full_depths(const PartPoints& part, const Vec3& point, const Vec3& normal,
                   std::span<const std::uint16_t> points, double* depths) noexcept;

/// [rt] What points of these depths add up to, of which `depth` is the greatest.
/// @param depths of the points [m]; what is behind them is overwritten
Support sum_up(const PartPoints& part, std::span<const std::uint16_t> points, double* depths,
               double depth) noexcept;

// The functions above work on four points at a time where the processor has AVX2. Two at a time, as every
// processor can, these work out the same bits: a sum takes one point after the other either way.
namespace by_two {
double full_depths(const PartPoints& part, const Vec3& point, const Vec3& normal,
                   std::span<const std::uint16_t> points, double* depths) noexcept;
Support sum_up(const PartPoints& part, std::span<const std::uint16_t> points, double* depths,
               double depth) noexcept;
}  // namespace by_two

}  // namespace palpate::contact

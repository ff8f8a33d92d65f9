#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "palpate/pose.h"

namespace palpate::report {

inline constexpr double kMilli = 1e3;  // m to mm, N to mN

/// [any] `value` with `digits` decimals, independent of the locale.
[[nodiscard]] std::string fixed(double value, int digits);

/// [any] A count with commas between thousands: 2,110.
[[nodiscard]] std::string grouped(std::uint64_t value);

/// [any] A value with its unit, at most 12 digits: 1.5 mm; `unit` may be empty.
[[nodiscard]] std::string number(double value, const char* unit);
/// [any] A length [m]: 1.5 mm.
[[nodiscard]] std::string millimetres(double metres);
/// [any] A point [m]: 1, 2.5, 3 mm.
[[nodiscard]] std::string point_mm(const Vec3& p);

/// [any] `text` with &, <, > and quotes escaped for HTML text and attributes.
[[nodiscard]] std::string escaped(std::string_view text);

/// [any] RFC 4648 base64, padded.
[[nodiscard]] std::string base64(std::string_view bytes);

/// [any] A time since 1970 [ns] as "2011-07-01 12:00:00 UTC".
[[nodiscard]] std::string utc_time(std::int64_t unix_ns);

}  // namespace palpate::report

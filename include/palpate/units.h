#pragma once
#include <string_view>

namespace palpate {

/// Length units of mesh files, as in scene files and flags: "mm", "cm", "m", "in".
enum class LengthUnit { kMillimetre, kCentimetre, kMetre, kInch };

inline constexpr double kMillimetre = 1e-3;   // m
inline constexpr double kMicrosecond = 1e-6;  // s

/// [any] Metres in one `unit`.
[[nodiscard]] constexpr double metres_per(LengthUnit unit) noexcept {
  switch (unit) {
    case LengthUnit::kMillimetre:
      return 1e-3;
    case LengthUnit::kCentimetre:
      return 1e-2;
    case LengthUnit::kMetre:
      return 1.0;
    case LengthUnit::kInch:
      return 0.0254;
  }
  return 1.0;
}

/// [setup] The unit with this name. @throws InputError that lists the valid units.
[[nodiscard]] LengthUnit parse_length_unit(std::string_view text);

/// [any] "mm", "cm", "m" or "in".
[[nodiscard]] std::string_view to_string(LengthUnit unit) noexcept;

}  // namespace palpate

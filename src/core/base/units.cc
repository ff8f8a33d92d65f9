#include "palpate/units.h"

#include <string>

#include "palpate/error.h"

namespace palpate {

std::string_view to_string(LengthUnit unit) noexcept {
  switch (unit) {
    case LengthUnit::kMillimetre:
      return "mm";
    case LengthUnit::kCentimetre:
      return "cm";
    case LengthUnit::kMetre:
      return "m";
    case LengthUnit::kInch:
      return "in";
  }
  return "";
}

LengthUnit parse_length_unit(std::string_view text) {
  for (const LengthUnit unit :
       {LengthUnit::kMillimetre, LengthUnit::kCentimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
    if (text == to_string(unit)) return unit;
  }
  throw InputError("unit = \"" + std::string(text) + "\": must be mm, cm, m or in");
}

}  // namespace palpate

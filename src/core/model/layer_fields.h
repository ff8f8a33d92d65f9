#pragma once
#include <array>

#include "core/model/tissue_fields.h"

// The table of a tissue layer's numbers (docs/needle.md). Validation, tissue files, recordings, the live
// interface and Python iterate over it, so one row adds a number to all of them.
namespace palpate::model {

inline constexpr FieldUnit kNewtonPerMillimetre{"N/mm", "N/m", 1e3};
inline constexpr FieldUnit kNewtonPerSquareMillimetre{"N/mm2", "N/m2", 1e6};
/// Forces beyond every gate's limit stop a needle for good; larger ones would only overflow.
inline constexpr FieldRange kNeedleForceRange{.low_allowed = true, .high = 1e3, .high_allowed = true};
inline constexpr FieldRange kLayerThicknessRange{.high = 1e3, .high_allowed = true};  // mm
inline constexpr FieldRange kRateExponentRange{.low_allowed = true, .high = 1.0, .high_allowed = true};

/// One number of a TissueLayer.
struct LayerField {
  const char* key;     // in tissue files and messages
  const char* si_key;  // in recordings
  const char* name;    // in C++ and Python
  FieldUnit unit;      // of `key`
  double TissueLayer::*at;
  FieldRange range;     // in the unit of `key`
  bool required;        // in a tissue file; the others are 0
  const char* meaning;  // one line for users
};

/// Every number of a layer but its thickness, in the order of tissue files.
// clang-format off
inline constexpr std::array kLayerFields{
    LayerField{"puncture_force_N", "puncture_force_N", "puncture_force", kNewton, &TissueLayer::puncture_force, kNeedleForceRange,
               true, "force on the tip at which its membrane gives way"},
    LayerField{"cutting_force_N", "cutting_force_N", "cutting_force", kNewton, &TissueLayer::cutting_force, kNeedleForceRange,
               true, "force on the tip that goes on"},
    LayerField{"friction_N", "friction_N", "friction", kNewton, &TissueLayer::friction, kNeedleForceRange,
               false, "friction on the shaft, whatever its length in the layer"},
    LayerField{"friction_N_per_mm", "friction_N_per_m", "friction_per_length", kNewtonPerMillimetre, &TissueLayer::friction_per_length,
               kNeedleForceRange, false, "friction on the shaft, per length in the layer"},
    LayerField{"lateral_N_per_mm2", "lateral_N_per_m2", "lateral_stiffness", kNewtonPerSquareMillimetre, &TissueLayer::lateral_stiffness,
               kNeedleForceRange, false, "stiffness of the channel across the shaft, per length"},
    LayerField{"rate_exponent", "rate_exponent", "rate_exponent", kNoUnit, &TissueLayer::rate_exponent, kRateExponentRange,
               false, "e: the cutting force grows as (1 + speed / (1 mm/s))^e"},
};
// clang-format on
/// Its key in tissue files and in recordings; the last layer has none.
inline constexpr const char* kLayerThicknessKey = "thickness_mm";
inline constexpr const char* kLayerThicknessColumn = "thickness_m";

}  // namespace palpate::model

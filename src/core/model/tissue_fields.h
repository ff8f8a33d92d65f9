#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "palpate/tissue.h"
#include "palpate/units.h"

// The table of a tissue's numbers. Validation, tissue files, recordings, the live interface, the window,
// Python, the report and docs/file-formats.md go over it: a number that has a line here is known to all of
// them.
namespace palpate::model {

/// What a number may be; it must be finite.
struct FieldRange {
  double low = 0.0;
  bool low_allowed = false;
  double high = std::numeric_limits<double>::infinity();
  bool high_allowed = false;

  /// [any]
  [[nodiscard]] constexpr bool contains(double value) const noexcept {
    return (low_allowed ? value >= low : value > low) && (high_allowed ? value <= high : value < high);
  }
  /// [setup] "finite and > 0" or "> 0 and <= 1", for messages.
  [[nodiscard]] std::string in_words() const;
};

inline constexpr FieldRange kPositive{};
inline constexpr FieldRange kNotNegative{.low_allowed = true};

/// A unit of files and messages.
struct FieldUnit {
  const char* text;     // empty: a ratio
  const char* si_text;  // the unit inside
  double si;            // one unit in SI
};

/// Reads and writes one number of a tissue, SI. A number that need not be given is none when it is not.
struct FieldAccess {
  std::optional<double> (*get)(const TissueNumbers&) noexcept;
  void (*set)(TissueNumbers&, std::optional<double>) noexcept;  // none: a number that must be given stays
};

/// The number that these members lead to, each a member of the one before.
template <auto... kMembers>
inline constexpr FieldAccess kAt{
    [](const TissueNumbers& tissue) noexcept -> std::optional<double> { return (tissue.*....*kMembers); },
    [](TissueNumbers& tissue, std::optional<double> value) noexcept {
      auto& member = (tissue.*....*kMembers);
      if constexpr (std::is_same_v<decltype(member), double&>) {
        if (value) member = *value;
      } else {
        member = value;
      }
    }};

/// How a person drags a number, in the field's unit; a file may have values beyond the ends.
struct FieldSlider {
  double step;
  double low;
  double high;
  int decimals;
};

/// A tissue's three lengths of its first layer's spring are ordered.
enum class LengthOrder { kNone, kAboveRest, kBelowRest };

/// One number of a tissue.
struct TissueField {
  std::string_view section;  // of a tissue file: empty is [tissue] itself, else one of kTissueSections
  const char* key;           // in tissue files, messages and the live interface
  const char* si_key;        // in recordings
  const char* name;          // in C++ and Python
  FieldUnit unit;            // of `key`
  FieldAccess at;
  bool required = false;  // a tissue file must have it; the others have the default of their C++ member
  FieldRange range{};     // the same in SI as in the field's unit, because its ends are 0, 1 or nothing
  LengthOrder order = LengthOrder::kNone;
  double (*derived)(const TissueNumbers&) noexcept = nullptr;  // what it is when it is not given
  const char* derived_text = nullptr;                          // the same in words
  bool old_lack_it = false;  // recordings from before the number was a parameter have the default
  bool set_up_only = false;  // the organ is prepared for it: it cannot change while a run goes on
  const char* label;         // for people
  const char* meaning;       // for people, one line
  FieldSlider slider;

  /// [any] Whether it need not be given, and then follows from others.
  [[nodiscard]] constexpr bool optional() const noexcept { return derived != nullptr; }
  /// [any] The value in force, SI.
  [[nodiscard]] double in_force(const TissueNumbers& tissue) const noexcept {
    const std::optional<double> given = at.get(tissue);
    return given ? *given : derived(tissue);
  }
  /// [any] What a tissue file that does not name it means, SI; none: it is required, or derived.
  [[nodiscard]] std::optional<double> default_value() const noexcept {
    return required ? std::nullopt : at.get(TissueNumbers{});
  }
  /// [setup] "contact.friction", as error messages name it.
  [[nodiscard]] std::string path() const;
  /// [setup] @throws ParameterError naming path(), when the tissue's number is out of range.
  void check(const TissueNumbers& tissue) const;
};

/// A table of a tissue file below [tissue].
struct TissueSection {
  std::string_view key;
  const char* title;  // for people
};
inline constexpr std::array kTissueSections{TissueSection{"reach", "Reach of the dent"},
                                            TissueSection{"contact", "Contact"}};

inline constexpr FieldUnit kNoUnit{"", "", 1.0};
inline constexpr FieldUnit kInNewton{"N", "N", 1.0};
inline constexpr FieldUnit kInNewtonPerMetre{"N/m", "N/m", 1.0};
inline constexpr FieldUnit kInNewtonSecondPerMetre{"N s/m", "N s/m", 1.0};
inline constexpr FieldUnit kInMillimetre{"mm", "m", kMillimetre};
inline constexpr FieldUnit kInMicrosecond{"\u00b5s", "s", kMicrosecond};

/// Every number of a tissue; those of [tissue] itself come first. CONTRIBUTING.md says how to add one.
// clang-format off
inline constexpr std::array kTissueFields{
    TissueField{.section = "", .key = "k1_N_per_m", .si_key = "k1_N_per_m", .name = "k1", .unit = kInNewtonPerMetre,
                .at = kAt<&TissueNumbers::k1>, .required = true,
                .label = "k\u2081", .meaning = "stiffness of the first layer's spring", .slider = {0.1, 0.1, 2000, 2}},
    TissueField{.section = "", .key = "beta", .si_key = "beta", .name = "beta", .unit = kNoUnit,
                .at = kAt<&TissueNumbers::beta>, .required = true,
                .label = "\u03b2", .meaning = "layer i is exp((i-1)/\u03b2) times as stiff",
                .slider = {0.01, 0.2, 20, 3}},
    TissueField{.section = "", .key = "q", .si_key = "q", .name = "q", .unit = kNoUnit,
                .at = kAt<&TissueNumbers::q>, .required = true,
                .label = "q", .meaning = "layer i gives way q^(i-1) times as far", .slider = {0.002, 0.1, 1.5, 3}},
    TissueField{.section = "", .key = "rest_length_mm", .si_key = "rest_length_m", .name = "rest_length",
                .unit = kInMillimetre, .at = kAt<&TissueNumbers::rest_length>, .required = true,
                .label = "Rest length", .meaning = "X_1o, of a first-layer spring", .slider = {0.05, 0.5, 100, 2}},
    TissueField{.section = "", .key = "max_length_mm", .si_key = "max_length_m", .name = "max_length",
                .unit = kInMillimetre, .at = kAt<&TissueNumbers::max_length>, .required = true,
                .order = LengthOrder::kAboveRest,
                .label = "Longest", .meaning = "X_1max; less the rest length: the first layer's limit when pulled",
                .slider = {0.05, 0.5, 200, 2}},
    TissueField{.section = "", .key = "min_length_mm", .si_key = "min_length_m", .name = "min_length",
                .unit = kInMillimetre, .at = kAt<&TissueNumbers::min_length>, .required = true,
                .range = kNotNegative, .order = LengthOrder::kBelowRest,
                .label = "Shortest", .meaning = "X_1min; rest length less this: the first layer's limit when pressed",
                .slider = {0.05, 0, 100, 2}},
    TissueField{.section = "", .key = "t1_us", .si_key = "t1_s", .name = "t1", .unit = kInMicrosecond,
                .at = kAt<&TissueNumbers::t1>, .required = true,
                .label = "t\u2081", .meaning = "delay of the first layer: bounds the layers",
                .slider = {0.05, 0.05, 200, 2}},
    TissueField{.section = "reach", .key = "contact_ratio", .si_key = "contact_ratio", .name = "contact_ratio",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::reach, &ReachParameters::contact_ratio>,
                .label = "c", .meaning = "R_1 = c R (D/R)^p", .slider = {0.005, 0.1, 5, 3}},
    TissueField{.section = "reach", .key = "first_bar_ratio", .si_key = "first_bar_ratio", .name = "first_bar_ratio",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::reach, &ReachParameters::first_bar_ratio>,
                .label = "a", .meaning = "first bar to contact radius", .slider = {0.005, 0.01, 5, 3}},
    TissueField{.section = "reach", .key = "bar_ratio", .si_key = "bar_ratio", .name = "bar_ratio",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::reach, &ReachParameters::bar_ratio>, .range = {.low = 1.0},
                .label = "s", .meaning = "each bar to the one above", .slider = {0.005, 1.01, 5, 3}},
    TissueField{.section = "reach", .key = "weight_ratio", .si_key = "weight_ratio", .name = "weight_ratio",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::reach, &ReachParameters::weight_ratio>,
                .range = {.high = 1.0},
                .label = "g", .meaning = "weight of each layer to the one above", .slider = {0.002, 0.01, 0.99, 3}},
    // Above 1 a dent, as steep as D/R_1, would be the steeper the shallower it is.
    TissueField{.section = "reach", .key = "depth_exponent", .si_key = "depth_exponent", .name = "depth_exponent",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::reach, &ReachParameters::depth_exponent>,
                .range = {.high = 1.0, .high_allowed = true}, .old_lack_it = true,
                .label = "p", .meaning = "how R_1 grows with the depth; 1/2 as the square root",
                .slider = {0.002, 0.01, 1, 3}},
    TissueField{.section = "contact", .key = "friction", .si_key = "friction", .name = "friction",
                .unit = kNoUnit, .at = kAt<&TissueNumbers::contact, &ContactParameters::friction>,
                .range = kNotNegative,
                .label = "Friction", .meaning = "Coulomb's coefficient", .slider = {0.005, 0, 2, 3}},
    TissueField{.section = "contact", .key = "tangential_N_per_m", .si_key = "tangential_N_per_m",
                .name = "tangential_stiffness", .unit = kInNewtonPerMetre,
                .at = kAt<&TissueNumbers::contact, &ContactParameters::tangential_stiffness>,
                .derived = [](const TissueNumbers& tissue) noexcept { return tissue.tangential_stiffness(); },
                .derived_text = "10 k\u2081",
                .label = "Tangential stiffness", .meaning = "k_t, of the friction spring", .slider = {1, 1, 20000, 0}},
    TissueField{.section = "contact", .key = "tangential_damping_N_s_per_m",
                .si_key = "tangential_damping_N_s_per_m", .name = "tangential_damping", .unit = kInNewtonSecondPerMetre,
                .at = kAt<&TissueNumbers::contact, &ContactParameters::tangential_damping>, .range = kNotNegative,
                .old_lack_it = true,
                .label = "Tangential damping", .meaning = "c_t, beside the friction spring",
                .slider = {0.01, 0, 20, 2}},
    TissueField{.section = "contact", .key = "damping_N_s_per_m", .si_key = "damping_N_s_per_m", .name = "damping",
                .unit = kInNewtonSecondPerMetre, .at = kAt<&TissueNumbers::contact, &ContactParameters::damping>,
                .range = kNotNegative,
                .label = "Damping", .meaning = "along the normal", .slider = {0.01, 0, 20, 2}},
    TissueField{.section = "contact", .key = "reference_radius_mm", .si_key = "reference_radius_m",
                .name = "reference_radius", .unit = kInMillimetre,
                .at = kAt<&TissueNumbers::contact, &ContactParameters::reference_radius>, .set_up_only = true,
                .label = "Reference radius", .meaning = "R_ref, how much of the organ one contact is about",
                .slider = {0.1, 1, 100, 2}},
    TissueField{.section = "contact", .key = "grip_limit_N", .si_key = "grip_limit_N", .name = "grip_limit",
                .unit = kInNewton, .at = kAt<&TissueNumbers::contact, &ContactParameters::grip_limit>,
                .label = "Grip limit", .meaning = "past it the jaws let go", .slider = {0.05, 0.1, 50, 2}},
};
// clang-format on

}  // namespace palpate::model

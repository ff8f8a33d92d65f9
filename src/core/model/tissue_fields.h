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
// Python, the report and docs/file-formats.md iterate over it, so one row adds a number to all of them.
namespace palpate::model {

/// Order of a length of the first layer's spring relative to its rest length.
enum class LengthOrder { kNone, kAboveRest, kBelowRest };

/// The allowed values of a number; all are finite. The ends are the same numbers in SI and in
/// the unit of a tissue file.
struct FieldRange {
  double low = 0.0;
  bool low_allowed = false;
  double high = std::numeric_limits<double>::infinity();
  bool high_allowed = false;
  LengthOrder order = LengthOrder::kNone;  // checked in addition

  /// [any] Whether a value is within the range.
  [[nodiscard]] constexpr bool contains(double value) const noexcept {
    return (low_allowed ? value >= low : value > low) && (high_allowed ? value <= high : value < high);
  }
  /// [setup] The range as text for messages, such as "finite and > 0" or "> 0 and <= 1". @param rest_length
  /// name of the rest length in the message
  [[nodiscard]] std::string to_string(const std::string& rest_length = "`rest_length_mm`") const;
};

inline constexpr FieldRange kPositive{};
inline constexpr FieldRange kNotNegative{.low_allowed = true};
inline constexpr FieldRange kAboveOne{.low = 1.0};
inline constexpr FieldRange kBelowOne{.high = 1.0};
inline constexpr FieldRange kAtMostOne{.high = 1.0, .high_allowed = true};
/// Far above any lubricated organ. Above this no supported device is stable.
inline constexpr FieldRange kFrictionRange{.low_allowed = true, .high = 10.0, .high_allowed = true};
inline constexpr FieldRange kTangentialRange{.high = 1e5, .high_allowed = true};
/// Stiffer than any tissue or bone; beyond them a product of allowed numbers could overflow to an infinite
/// force.
inline constexpr FieldRange kStiffnessRange{.high = 1e9, .high_allowed = true};
inline constexpr FieldRange kDampingRange{.low_allowed = true, .high = 1e6, .high_allowed = true};
inline constexpr FieldRange kSizeExponentRange{.low_allowed = true, .high = 2.0, .high_allowed = true};
inline constexpr FieldRange kAboveRest{.order = LengthOrder::kAboveRest};
inline constexpr FieldRange kBelowRest{.low_allowed = true, .order = LengthOrder::kBelowRest};

/// A unit of tissue files and messages.
struct FieldUnit {
  const char* text;     // empty: no unit
  const char* si_text;  // the SI unit
  double si;            // one unit in SI
};
inline constexpr FieldUnit kNoUnit{"", "", 1.0};
inline constexpr FieldUnit kNewton{"N", "N", 1.0};
inline constexpr FieldUnit kNewtonPerMetre{"N/m", "N/m", 1.0};
inline constexpr FieldUnit kNewtonSecondPerMetre{"N s/m", "N s/m", 1.0};
inline constexpr FieldUnit kInMillimetres{"mm", "m", kMillimetre};
inline constexpr FieldUnit kInMicroseconds{"\u00b5s", "s", kMicrosecond};

/// Reads and writes one number of a tissue, in SI units. An optional number that is not given is nullopt.
struct FieldAccess {
  std::optional<double> (*get)(const TissueNumbers&) noexcept;
  // nullopt leaves a number that is not optional
  void (*set)(TissueNumbers&, std::optional<double>) noexcept;
};

/// Access to the number at the end of a chain of members.
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
template <auto kMember>
inline constexpr FieldAccess kAtReach = kAt<&TissueNumbers::reach, kMember>;
template <auto kMember>
inline constexpr FieldAccess kAtContact = kAt<&TissueNumbers::contact, kMember>;

/// The slider of a number in the window, in the field's unit. Files may have values outside.
struct FieldSlider {
  double step;
  double low;
  double high;
  int decimals;
};
/// For a number that the organ is prepared for; it cannot change during a run.
inline constexpr FieldSlider kNoSlider{};

/// One number of a tissue.
struct TissueField {
  std::string_view section;  // table in a tissue file: empty is [tissue] itself, else one of kTissueSections
  const char* key;           // in tissue files, messages and the live interface
  const char* name;          // in C++ and Python
  FieldUnit unit;            // of `key`
  FieldAccess at;
  const char* label;    // for users
  const char* meaning;  // one line for users
  FieldSlider slider;
  FieldRange range = kPositive;
  const char* si_key = nullptr;  // in recordings; null: `key`
  bool added_later = false;      // a recording without it uses the default
  // its value when it is not given; null: not optional
  double (*derived)(const TissueNumbers&) noexcept = nullptr;
  const char* derived_text = nullptr;  // the rule of `derived`, for users

  /// [any] Its name in recordings.
  [[nodiscard]] constexpr const char* column() const noexcept { return si_key != nullptr ? si_key : key; }
  /// [any] Its table in the tissue of a recorded scene; `source` is the indenter or null there.
  [[nodiscard]] std::string recorded_section() const;
  /// [any] Whether a tissue file must have it. The others default to the value of their C++ member.
  [[nodiscard]] constexpr bool required() const noexcept { return section.empty() && !added_later; }
  /// [any] Whether it may be omitted; it then follows from other numbers.
  [[nodiscard]] constexpr bool optional() const noexcept { return derived != nullptr; }
  /// [any] The value used, given or derived, SI.
  [[nodiscard]] double in_force(const TissueNumbers& tissue) const noexcept {
    const std::optional<double> given = at.get(tissue);
    return given ? *given : derived(tissue);
  }
  /// [setup] The name in error messages, such as "contact.friction".
  [[nodiscard]] std::string path() const;
  /// [setup] @throws ParameterError naming path() when the tissue's number is out of range.
  void check(const TissueNumbers& tissue) const;
};

/// A subtable of [tissue] in a tissue file.
struct TissueSection {
  std::string_view key;
  const char* title;  // for users
};
/// A tissue file has the text `indenter` and its `radius_mm` beside the numbers of this section.
inline constexpr std::string_view kSourceSection = "source";
inline constexpr std::array kTissueSections{TissueSection{"reach", "Reach of the dent"},
                                            TissueSection{"contact", "Contact"},
                                            TissueSection{kSourceSection, "Source"}};

/// Every number of a tissue, in the order of tissue files. CONTRIBUTING.md describes how to add one.
// clang-format off
inline constexpr auto kTissueFields = [] {
  using T = TissueNumbers;
  using R = FalloffRatios;
  using C = ContactParameters;
  return std::to_array<TissueField>({
    {"", "k1_N_per_m", "k1", kNewtonPerMetre, kAt<&T::k1>,
     "Stiffness k\u2081", "stiffness of the first layer's spring", {0.1, 0.1, 2000, 2}, kStiffnessRange},
    {"", "beta", "beta", kNoUnit, kAt<&T::beta>,
     "Stiffening \u03b2", "layer i is exp((i-1)/\u03b2) times as stiff", {0.01, 0.2, 20, 3}},
    {"", "q", "q", kNoUnit, kAt<&T::q>,
     "Layer ratio q", "limit of layer i: q^(i-1) times that of the first", {0.002, 0.1, 1.5, 3}},
    {"", "rest_length_mm", "rest_length", kInMillimetres, kAt<&T::rest_length>,
     "Rest length", "X_1o, of a first-layer spring", {0.05, 0.5, 100, 2}, kPositive, "rest_length_m"},
    {"", "max_length_mm", "max_length", kInMillimetres, kAt<&T::max_length>,
     "Longest length", "X_1max; minus the rest length: the first layer's limit in pull", {0.05, 0.5, 200, 2},
     kAboveRest, "max_length_m"},
    {"", "min_length_mm", "min_length", kInMillimetres, kAt<&T::min_length>,
     "Shortest length", "X_1min; rest length minus this: the first layer's limit in press", {0.05, 0, 100, 2},
     kBelowRest, "min_length_m"},
    {"", "t1_us", "t1", kInMicroseconds, kAt<&T::t1>,
     "Layer delay t\u2081", "delay of the first layer: bounds the number of layers", {0.05, 0.05, 200, 2},
     kPositive, "t1_s"},
    {"", "size_exponent", "size_exponent", kNoUnit, kAt<&T::size_exponent>,
     "Size exponent", "F(D) grows as (tool's tip radius / source.radius_mm)^this; ball 0.5 (Hertz), flat punch 1",
     {0.005, 0, 2, 3}, kSizeExponentRange, nullptr, true},
    {"reach", "contact_ratio", "contact_ratio", kNoUnit, kAtReach<&R::contact_ratio>,
     "Contact radius c", "R_1 = c R (D/R)^p", {0.005, 0.1, 5, 3}},
    {"reach", "first_bar_ratio", "first_bar_ratio", kNoUnit, kAtReach<&R::first_bar_ratio>,
     "First bar a", "first falloff ratio: R_2 = (1 + a) R_1", {0.005, 0.01, 5, 3}},
    {"reach", "bar_ratio", "bar_ratio", kNoUnit, kAtReach<&R::bar_ratio>,
     "Bar ratio s", "falloff ratio of each further step: s times the step before", {0.005, 1.01, 5, 3}, kAboveOne},
    {"reach", "weight_ratio", "weight_ratio", kNoUnit, kAtReach<&R::weight_ratio>,
     "Weight ratio g", "weight of each term: g times the one before", {0.002, 0.01, 0.99, 3}, kBelowOne},
    // Above 1 an indentation, whose slope is about D/R_1, would be steeper the shallower it is.
    {"reach", "depth_exponent", "depth_exponent", kNoUnit, kAtReach<&R::depth_exponent>,
     "Depth exponent p", "how R_1 grows with the depth; 1/2 as the square root", {0.002, 0.01, 1, 3},
     kAtMostOne, nullptr, true},
    {"contact", "friction", "friction", kNoUnit, kAtContact<&C::friction>,
     "Friction", "Coulomb's coefficient", {0.005, 0, 2, 3}, kFrictionRange},
    {"contact", "tangential_N_per_m", "tangential_stiffness", kNewtonPerMetre, kAtContact<&C::tangential_stiffness>,
     "Tangential stiffness", "k_t, of the friction spring", {1, 1, 20000, 0}, kTangentialRange, nullptr, false,
     [](const T& tissue) noexcept { return tissue.tangential_stiffness(); }, "10 k\u2081"},
    {"contact", "tangential_damping_N_s_per_m", "tangential_damping", kNewtonSecondPerMetre,
     kAtContact<&C::tangential_damping>,
     "Tangential damping", "c_t, beside the friction spring", {0.01, 0, 20, 2}, kDampingRange, nullptr, true},
    {"contact", "damping_N_s_per_m", "damping", kNewtonSecondPerMetre, kAtContact<&C::damping>,
     "Normal damping", "b, along the normal", {0.01, 0, 20, 2}, kDampingRange},
    {"contact", "reference_radius_mm", "reference_radius", kInMillimetres, kAtContact<&C::reference_radius>,
     "Reference radius", "R_ref, the size of the area that one contact stands for", kNoSlider,
     kPositive, "reference_radius_m"},
    {"contact", "grip_limit_N", "grip_limit", kNewton, kAtContact<&C::grip_limit>,
     "Grip limit", "pull force at which the jaws lose the tissue", {0.05, 0.1, 50, 2}},
    {kSourceSection, "max_depth_mm", "max_depth", kInMillimetres, kAt<&T::max_depth>,
     "Largest depth", "past this depth F(D) goes on by its tangent there", {0.1, 1, 60, 1},
     kPositive, "max_depth_m", true,
     [](const T&) noexcept { return std::numeric_limits<double>::infinity(); }, "none"},
  });
}();
// clang-format on

}  // namespace palpate::model

#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpate::model {

/// Direction of a contact. It selects the limit of the springs: X_1o - X_1min when pressed, X_1max - X_1o
/// when pulled [Zhang 2011, eq. 4].
enum class Direction { kPress, kPull };

/// Law of force over depth: the layered law of [Zhang 2011], or the smooth law, whose stiffness has no steps
/// (docs/model.md, "Beyond the paper").
enum class LawKind : std::uint32_t { kLayered, kSmooth };

/// [any] "layered" or "smooth", as in a tissue file.
[[nodiscard]] const char* to_string(LawKind law) noexcept;
/// [setup] The law with this name. @throws InputError that lists the valid names.
[[nodiscard]] LawKind parse_law(std::string_view text);

/// One term of the Prony series: at constant depth the force falls by the fraction `g` of the elastic force,
/// with the time constant `tau`.
struct RelaxationTerm {
  double g = 0.0;    // dimensionless, > 0; the sum over all terms is less than 1
  double tau = 0.0;  // [s]

  bool operator==(const RelaxationTerm&) const = default;
};

inline constexpr std::size_t kMaxRelaxationTerms = 3;

/// A Prony series of up to kMaxRelaxationTerms terms. It is plain data without memory on the heap.
class RelaxationTerms final {
 public:
  RelaxationTerms() = default;
  /// [setup] @throws ParameterError for more than kMaxRelaxationTerms terms.
  RelaxationTerms(std::initializer_list<RelaxationTerm> terms) {
    for (const RelaxationTerm& term : terms) push_back(term);
  }

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] const RelaxationTerm* data() const noexcept { return terms_.data(); }
  [[nodiscard]] const RelaxationTerm* begin() const noexcept { return terms_.data(); }
  [[nodiscard]] const RelaxationTerm* end() const noexcept { return terms_.data() + count_; }
  /// [any] @param index < size()
  [[nodiscard]] const RelaxationTerm& operator[](std::size_t index) const noexcept { return terms_[index]; }
  [[nodiscard]] RelaxationTerm& operator[](std::size_t index) noexcept { return terms_[index]; }

  /// [setup] Appends a term. @throws ParameterError when the series has kMaxRelaxationTerms terms already.
  void push_back(const RelaxationTerm& term);
  /// [any] Removes the last term. The series must not be empty.
  void pop_back() noexcept { terms_[--count_] = {}; }
  void clear() noexcept { *this = {}; }

  bool operator==(const RelaxationTerms&) const = default;

 private:
  std::array<RelaxationTerm, kMaxRelaxationTerms> terms_{};
  std::size_t count_ = 0;
};

/// Falloff ratios: extent and steepness of the displacement profile around a contact (docs/model.md,
/// section 3). All are dimensionless.
struct FalloffRatios {
  double contact_ratio = 1.1;     // c: R_1 = c R (D/R)^p
  double first_bar_ratio = 0.43;  // a
  double bar_ratio = 1.8;         // s > 1
  double weight_ratio = 0.58;     // g, in (0, 1)
  double depth_exponent = 0.5;    // p, in (0, 1]; 1/2: R_1 = c sqrt(R D)

  bool operator==(const FalloffRatios&) const = default;
};

/// Contact parameters of a tissue (docs/model.md, section 4).
struct ContactParameters {
  double friction = 0.2;                       // Coulomb coefficient, >= 0
  std::optional<double> tangential_stiffness;  // k_t [N/m]; empty: 10 k_1
  double tangential_damping = 0.0;             // c_t [N s/m], >= 0
  double damping = 0.5;                        // b [N s/m], >= 0
  double reference_radius = 10e-3;             // R_ref [m]
  double grip_limit = 8.0;                     // [N], force at which a grasp lets go

  bool operator==(const ContactParameters&) const = default;
};

/// One layer that a needle goes through (docs/needle.md). Layers follow the organ's surface inwards.
struct TissueLayer {
  std::string name;
  double thickness = std::numeric_limits<double>::infinity();  // [m], > 0; infinite only in the last layer
  double puncture_force = 0.0;                                 // of its membrane [N], >= 0
  double cutting_force = 0.0;                                  // on the tip that goes on [N], >= 0
  double friction = 0.0;                                       // on the shaft, whatever its length [N], >= 0
  double friction_per_length = 0.0;                            // on the shaft inside [N/m], >= 0
  double lateral_stiffness = 0.0;                              // per length of the shaft inside [N/m^2], >= 0
  double rate_exponent = 0.0;  // e: the cutting force grows as (1 + speed / (1 mm/s))^e, 0 to 1

  bool operator==(const TissueLayer&) const = default;
};

inline constexpr std::size_t kMaxTissueLayers = 8;

/// The indenter that the parameters were fitted with.
struct SourceParameters {
  std::string indenter;
  double radius = 0.0;  // [m]
};

/// Tissue parameters that a tick needs: spring law, relaxation, displacement profile and contact. SI units.
/// It is plain data of fixed size, so a running loop replaces the tissue with one copy. model/tissue_fields.h
/// lists every number.
struct TissueNumbers {
  double k1 = 0.0;             // stiffness of the first layer's spring [N/m]
  double beta = 0.0;           // eq. 3
  double q = 0.0;              // eq. 4
  double rest_length = 0.0;    // X_1o [m]
  double max_length = 0.0;     // X_1max [m]
  double min_length = 0.0;     // X_1min [m]
  double t1 = 0.0;             // delay of the first layer [s], eq. 6
  double size_exponent = 0.0;  // F(D) grows as the tool's tip radius over that of the source to this power
  LawKind law = LawKind::kLayered;
  RelaxationTerms relaxation;  // empty: purely elastic
  FalloffRatios reach;
  ContactParameters contact;
  // D_m [m], the deepest depth of the measurement: past it F(D) goes on by its tangent; empty: the whole law
  std::optional<double> max_depth;

  /// [any] L_1 [m], limit of the first layer: X_1max - X_1o when pulled, X_1o - X_1min when pressed.
  [[nodiscard]] double first_limit(Direction direction) const noexcept;
  /// [any] k_t [N/m], also when it has the default 10 k_1.
  [[nodiscard]] double tangential_stiffness() const noexcept;

  bool operator==(const TissueNumbers&) const = default;
};
static_assert(std::is_trivially_copyable_v<TissueNumbers>);

/// One tissue: its numbers, its name and the indenter of the measurement.
struct TissueParameters : TissueNumbers {
  std::string name;
  std::optional<SourceParameters> source;
  std::vector<TissueLayer> layers{};  // at most kMaxTissueLayers; empty: no needle enters

  /// [any] The parameters that a tick needs.
  [[nodiscard]] const TissueNumbers& numbers() const noexcept { return *this; }
};

/// [setup] Checks every field. @throws ParameterError that names the first invalid field by its key in a
/// tissue file (k1_N_per_m, rest_length_mm, contact.friction, ...), its value in that unit and the valid
/// range.
void validate(const TissueParameters& tissue);

/// [any] Factor of F(D) for a tool of this tip radius [m]: (tip_radius / source_radius)^size_exponent.
/// Without exponent 1, whatever the radii are.
[[nodiscard]] double size_factor(double size_exponent, double source_radius, double tip_radius) noexcept;

/// [setup] The law's tissue as a tool of this tip radius [m] meets it: its size_factor() multiplies k_1, and
/// so F(D), and no exponent is left. @param tissue a valid one
[[nodiscard]] TissueParameters for_tool(TissueParameters tissue, double tip_radius);

/// [setup] Checks only relaxation terms. @throws ParameterError as validate().
void validate_relaxation(std::span<const RelaxationTerm> terms);

/// [setup] Checks only layers. @throws ParameterError as validate().
void validate_layers(const std::vector<TissueLayer>& layers);

/// [any] The names of the built-in tissues (docs/tissues.md).
[[nodiscard]] std::span<const char* const> tissue_preset_names() noexcept;

/// [setup] The built-in tissue of this name. Only a measured one has a `source`; the others are illustrative.
/// @throws InputError that lists the names.
[[nodiscard]] TissueParameters tissue_preset(const std::string& name);

}  // namespace palpate::model

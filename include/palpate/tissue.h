#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpate::model {

/// Which limit of the springs counts: pressed (X_1o - X_1min) or pulled (X_1max - X_1o). [Zhang 2011, eq. 4]
enum class Direction { kPress, kPull };

/// How force goes with depth: in layers, as the paper has it, or with a stiffness that rises without jumps
/// (docs/model.md, "Beyond the paper").
enum class LawKind : std::uint32_t { kLayered, kSmooth };

/// [any] "layered" or "smooth", as a tissue file has it.
[[nodiscard]] const char* to_string(LawKind law) noexcept;
/// [setup] The law of that name. @throws InputError naming the two.
[[nodiscard]] LawKind parse_law(std::string_view text);

/// One way in which a held tissue lets go: the force falls by `g` of the elastic one, with time constant
/// `tau`.
struct RelaxationTerm {
  double g = 0.0;    // > 0; those of all terms sum to less than 1
  double tau = 0.0;  // [s]

  bool operator==(const RelaxationTerm&) const = default;
};

inline constexpr std::size_t kMaxRelaxationTerms = 3;

/// Up to kMaxRelaxationTerms terms, without memory of their own: a copy is a copy of plain data.
class RelaxationTerms final {
 public:
  RelaxationTerms() = default;
  /// [setup] @throws ParameterError for more than kMaxRelaxationTerms.
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

  /// [setup] @throws ParameterError when there are kMaxRelaxationTerms already.
  void push_back(const RelaxationTerm& term);
  /// [any] Takes the last term away; there must be one.
  void pop_back() noexcept { terms_[--count_] = {}; }
  void clear() noexcept { *this = {}; }

  bool operator==(const RelaxationTerms&) const = default;

 private:
  std::array<RelaxationTerm, kMaxRelaxationTerms> terms_{};
  std::size_t count_ = 0;
};

/// How the surface gives way around a contact (docs/model.md, section 3); all without unit.
struct FalloffRatios {
  double contact_ratio = 1.1;     // c: R_1 = c R (D/R)^p
  double first_bar_ratio = 0.43;  // a
  double bar_ratio = 1.8;         // s > 1
  double weight_ratio = 0.58;     // g, in (0, 1)
  double depth_exponent = 0.5;    // p, in (0, 1]; 1/2: R_1 = c sqrt(R D)

  bool operator==(const FalloffRatios&) const = default;
};

/// What the contact rules need of a tissue (docs/model.md, section 4).
struct ContactParameters {
  double friction = 0.2;                       // Coulomb coefficient, >= 0
  std::optional<double> tangential_stiffness;  // k_t [N/m]; 10 k_1 when not given
  double tangential_damping = 0.0;             // c_t [N s/m], >= 0
  double damping = 0.5;                        // b [N s/m], >= 0
  double reference_radius = 10e-3;             // R_ref [m]
  double grip_limit = 8.0;                     // [N]

  bool operator==(const ContactParameters&) const = default;
};

/// The indenter that the parameters were fitted with.
struct SourceParameters {
  std::string indenter;
  double radius = 0.0;  // [m]
};

/// All that a tick needs of one tissue: the springs' law, relaxation, reach and contact. SI units. Plain data
/// of fixed size: a loop that runs takes over another tissue with one copy. model/tissue_fields.h has a line
/// for each number.
struct TissueNumbers {
  double k1 = 0.0;           // stiffness of the first layer's spring [N/m]
  double beta = 0.0;         // eq. 3
  double q = 0.0;            // eq. 4
  double rest_length = 0.0;  // X_1o [m]
  double max_length = 0.0;   // X_1max [m]
  double min_length = 0.0;   // X_1min [m]
  double t1 = 0.0;           // delay of the first layer [s], eq. 6
  LawKind law = LawKind::kLayered;
  RelaxationTerms relaxation;  // none, or up to kMaxRelaxationTerms
  FalloffRatios reach;
  ContactParameters contact;

  /// [any] L_1 [m]: X_1max - X_1o when pulled, X_1o - X_1min when pressed.
  [[nodiscard]] double first_limit(Direction direction) const noexcept;
  /// [any] k_t [N/m].
  [[nodiscard]] double tangential_stiffness() const noexcept;

  bool operator==(const TissueNumbers&) const = default;
};
static_assert(std::is_trivially_copyable_v<TissueNumbers>);

/// One tissue: the layered springs' parameters and what belongs to them.
struct TissueParameters : TissueNumbers {
  std::string name;
  std::optional<SourceParameters> source;

  /// [any] The part that a tick needs.
  [[nodiscard]] const TissueNumbers& numbers() const noexcept { return *this; }
};

/// [setup] Checks every field. @throws ParameterError naming the first bad field as it stands in a tissue
/// file (k1_N_per_m, rest_length_mm, contact.friction, ...), its value in that unit and what would be right.
void validate(const TissueParameters& tissue);

/// [setup] Checks relaxation terms alone, as validate() does.
void validate_relaxation(std::span<const RelaxationTerm> terms);

/// [setup] A built-in tissue: "gallbladder", "heart", "liver" or "kidney". @throws InputError listing those
/// names.
[[nodiscard]] TissueParameters tissue_preset(const std::string& name);

}  // namespace palpate::model

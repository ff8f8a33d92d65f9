#include "palpate/model/tissue.h"

#include <array>
#include <cmath>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/base/units.h"

namespace palpate::model {
namespace {

void require_positive(const std::string& field, double value) {
  if (!std::isfinite(value) || !(value > 0.0)) throw ParameterError(field, value, "finite and > 0");
}

void require_not_negative(const std::string& field, double value) {
  if (!std::isfinite(value) || !(value >= 0.0)) throw ParameterError(field, value, "finite and >= 0");
}

// A length as the user typed it.
double mm(double metres) { return metres / kMillimetre; }

// 0 <= X_1min < X_1o < X_1max
void validate_lengths(const TissueParameters& tissue) {
  require_positive("rest_length_mm", mm(tissue.rest_length));
  if (!std::isfinite(tissue.max_length) || !(tissue.max_length > tissue.rest_length)) {
    throw ParameterError("max_length_mm", mm(tissue.max_length),
                         "finite and > rest_length_mm (" + shortest(mm(tissue.rest_length)) + " mm)");
  }
  if (!std::isfinite(tissue.min_length) || !(tissue.min_length >= 0.0) ||
      !(tissue.min_length < tissue.rest_length)) {
    throw ParameterError("min_length_mm", mm(tissue.min_length),
                         "finite, >= 0 and < rest_length_mm (" + shortest(mm(tissue.rest_length)) + " mm)");
  }
}

void validate_reach(const ReachParameters& reach) {
  require_positive("reach.contact_ratio", reach.contact_ratio);
  require_positive("reach.first_bar_ratio", reach.first_bar_ratio);
  if (!std::isfinite(reach.bar_ratio) || !(reach.bar_ratio > 1.0)) {
    throw ParameterError("reach.bar_ratio", reach.bar_ratio, "finite and > 1");
  }
  if (!(reach.weight_ratio > 0.0 && reach.weight_ratio < 1.0)) {
    throw ParameterError("reach.weight_ratio", reach.weight_ratio, "> 0 and < 1");
  }
  // Above 1 a dent, as steep as D/R_1, would be the steeper the shallower it is.
  if (!(reach.depth_exponent > 0.0 && reach.depth_exponent <= 1.0)) {
    throw ParameterError("reach.depth_exponent", reach.depth_exponent, "> 0 and <= 1");
  }
}

void validate_contact(const ContactParameters& contact) {
  require_not_negative("contact.friction", contact.friction);
  if (contact.tangential_stiffness) {
    require_positive("contact.tangential_N_per_m", *contact.tangential_stiffness);
  }
  require_not_negative("contact.damping_N_s_per_m", contact.damping);
  require_positive("contact.reference_radius_mm", mm(contact.reference_radius));
  require_positive("contact.grip_limit_N", contact.grip_limit);
}

// The law's own figures of one preset; everything else keeps its default.
struct Preset {
  const char* name;
  double k1_N_per_m;
  double beta;
  double q;
  double first_limit_mm;  // L_1, pressed and pulled alike
  double rest_length_mm;
  double t1_us;
};

// Where each figure comes from: docs/tissues.md. k1 and beta of gallbladder and heart are the paper's.
constexpr std::array kPresets{
    Preset{"gallbladder", 18.0, 1.6, 0.7, 8.0, 14.0, 1.0},
    Preset{"heart", 15.0, 2.0, 0.7, 8.0, 14.0, 1.0},
    Preset{"liver", 25.0, 2.5, 0.7, 8.0, 16.0, 1.0},
    Preset{"kidney", 40.0, 3.5, 0.7, 7.5, 15.0, 1.0},
};

}  // namespace

const char* to_string(LawKind law) noexcept { return law == LawKind::kSmooth ? "smooth" : "layered"; }

LawKind parse_law(std::string_view text) {
  if (text == "layered") return LawKind::kLayered;
  if (text == "smooth") return LawKind::kSmooth;
  throw InputError("law = \"" + std::string(text) + "\": must be layered or smooth");
}

double TissueParameters::first_limit(Direction direction) const noexcept {
  const double limit = direction == Direction::kPull ? max_length - rest_length : rest_length - min_length;
  // To a femtometre, so that 22 mm - 14 mm is 8 mm and not the 7.999999999999998 mm that the difference
  // leaves.
  constexpr double kPerMetre = 1e15;
  const double rounded = std::floor(limit * kPerMetre + 0.5) / kPerMetre;
  return rounded > 0.0 && std::isfinite(rounded) ? rounded : limit;
}

double TissueParameters::tangential_stiffness() const noexcept {
  constexpr double kOfFirstSpring =
      10.0;  // reaches the friction cone within 0.6 mm of travel (docs/model.md, section 4)
  return contact.tangential_stiffness.value_or(kOfFirstSpring * k1);
}

void validate(const TissueParameters& tissue) {
  require_positive("k1_N_per_m", tissue.k1);
  require_positive("beta", tissue.beta);
  require_positive("q", tissue.q);
  validate_lengths(tissue);
  require_positive("t1_us", tissue.t1 / kMicrosecond);
  validate_relaxation(tissue.relaxation);
  validate_reach(tissue.reach);
  validate_contact(tissue.contact);
  if (tissue.source) require_positive("source.radius_mm", mm(tissue.source->radius));
}

void validate_relaxation(std::span<const RelaxationTerm> terms) {
  if (terms.size() > kMostRelaxationTerms) {
    throw ParameterError("relaxation", static_cast<double>(terms.size()),
                         "at most " + std::to_string(kMostRelaxationTerms) + " terms");
  }
  double sum = 0.0;
  for (const RelaxationTerm& term : terms) {
    require_positive("relaxation.share", term.share);
    require_positive("relaxation.time_s", term.time);
    sum += term.share;
  }
  if (!(sum < 1.0)) {
    throw ParameterError("relaxation.share", sum,
                         "< 1 in sum, so that some force stays however long one holds");
  }
}

TissueParameters tissue_preset(const std::string& name) {
  std::string known;
  for (const Preset& preset : kPresets) {
    if (name == preset.name) {
      TissueParameters tissue;
      tissue.name = name;
      tissue.k1 = preset.k1_N_per_m;
      tissue.beta = preset.beta;
      tissue.q = preset.q;
      tissue.rest_length = preset.rest_length_mm * kMillimetre;
      tissue.max_length = (preset.rest_length_mm + preset.first_limit_mm) * kMillimetre;
      tissue.min_length = (preset.rest_length_mm - preset.first_limit_mm) * kMillimetre;
      tissue.t1 = preset.t1_us * kMicrosecond;
      return tissue;
    }
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  throw InputError("tissue = \"" + name + "\": no built-in tissue of that name; there are " + known);
}

}  // namespace palpate::model

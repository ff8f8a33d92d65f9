#include "core/model/tissue_fields.h"

#include <cmath>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::model {

std::string FieldRange::to_string(const std::string& rest_length) const {
  if (order == LengthOrder::kAboveRest) return "finite and > " + rest_length;
  if (order == LengthOrder::kBelowRest) return "finite, >= 0 and < " + rest_length;
  const std::string above = (low_allowed ? ">= " : "> ") + shortest(low);
  if (std::isinf(high)) return "finite and " + above;
  return above + " and " + (high_allowed ? "<= " : "< ") + shortest(high);
}

std::string TissueField::path() const { return section.empty() ? key : std::string(section) + "." + key; }

std::string TissueField::recorded_section() const {
  return section == kSourceSection ? std::string() : std::string(section);
}

void TissueField::check(const TissueNumbers& tissue) const {
  const std::optional<double> value = at.get(tissue);
  if (!value) return;
  const double rest = tissue.rest_length;
  const bool in_order = range.order == LengthOrder::kNone ||
                        (range.order == LengthOrder::kAboveRest ? *value > rest : *value < rest);
  if (range.contains(*value) && in_order) return;
  throw ParameterError(path(), *value / unit.si,
                       range.to_string("rest_length_mm (" + shortest(rest / kMillimetre) + " mm)"));
}

}  // namespace palpate::model

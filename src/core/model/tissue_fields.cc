#include "core/model/tissue_fields.h"

#include <cmath>

#include "palpate/error.h"

#include "core/base/text.h"

namespace palpate::model {

std::string FieldRange::in_words() const {
  const bool bounded = std::isfinite(high);
  const std::string above = (low_allowed ? ">= " : "> ") + shortest(low);
  if (!bounded) return "finite and " + above;
  return above + " and " + (high_allowed ? "<= " : "< ") + shortest(high);
}

std::string TissueField::path() const { return section.empty() ? key : std::string(section) + "." + key; }

void TissueField::check(const TissueNumbers& tissue) const {
  const std::optional<double> value = at.get(tissue);
  if (!value) return;
  const double rest = tissue.rest_length;
  const bool in_order =
      order == LengthOrder::kNone || (order == LengthOrder::kAboveRest ? *value > rest : *value < rest);
  if (range.contains(*value) && in_order) return;
  std::string want = range.in_words();
  if (order != LengthOrder::kNone) {
    const std::string rest_length = "rest_length_mm (" + shortest(rest / unit.si) + " mm)";
    want = order == LengthOrder::kAboveRest ? "finite and > " + rest_length
                                            : "finite, >= 0 and < " + rest_length;
  }
  throw ParameterError(path(), *value / unit.si, want);
}

}  // namespace palpate::model

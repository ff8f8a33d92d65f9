#include "palpate/error.h"

#include "core/base/text.h"

namespace palpate {

ParameterError::ParameterError(const std::string& field, double value, const std::string& want)
    : InputError(field + " = " + shortest(value) + ": must be " + want), field_(field) {}

}  // namespace palpate

#pragma once
#include <string>

namespace palpate::identify {

/// [setup] No result that is not finite may be printed or written. @param what of which quantity, for the
/// message @throws InputError
void require_finite_result(const std::string& what, double value);

}  // namespace palpate::identify

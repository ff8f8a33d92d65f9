#pragma once
#include <optional>
#include <string>

namespace palpate::session {

/// [setup] Checks that the loop may run on a core. @param core none: any core @param name the setting's name
/// in the error @throws ParameterError naming the setting and the cores that this program may use.
void require_usable_core(std::optional<int> core, const std::string& name);

}  // namespace palpate::session

#pragma once
#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] The rows of a specimen that a law without relaxation describes: the last whole loading of a loop,
/// without rows at its end in which the displacement or the force stands still. All rows where there is no
/// whole loading. A note names the rows that are left out.
[[nodiscard]] Specimen last_loading(const Specimen& specimen);

/// [setup] The last whole loading alone.
[[nodiscard]] Specimen whole_loading(const Specimen& specimen);

/// [setup] The rows that begin the measurement: those of the first loading; all without an unloading.
[[nodiscard]] Specimen first_loading(const Specimen& specimen);

}  // namespace palpate::identify

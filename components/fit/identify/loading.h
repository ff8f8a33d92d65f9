#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] Standard deviation of the noise of forces in the order of the rows: normalised median absolute
/// deviation of the second differences, scaled by 1/sqrt(6).
[[nodiscard]] double noise_of_rows(const std::vector<double>& force);

/// [setup] The rows of a specimen that a law without relaxation describes: the last whole loading of a loop,
/// without rows at its end in which the displacement or the force stands still. All rows where there is no
/// whole loading. A note names the rows that are left out.
[[nodiscard]] Specimen last_loading(const Specimen& specimen);

/// [setup] The last whole loading alone.
[[nodiscard]] Specimen whole_loading(const Specimen& specimen);

/// [setup] The rows that begin the measurement: those of the first loading; all without an unloading.
[[nodiscard]] Specimen first_loading(const Specimen& specimen);

/// [setup] The rows without those at the start, at most a tenth, that a jump of the force parts from the
/// rest. A note names them.
[[nodiscard]] Specimen leave_out_start(const Specimen& specimen);

/// [setup] A force that stays at the largest one while the displacement rises, or through many equal rows, is
/// that of a sensor at its limit. @param where file and specimen, for the message @throws InputError
void require_unsaturated(const Specimen& specimen, const std::string& where);

}  // namespace palpate::identify

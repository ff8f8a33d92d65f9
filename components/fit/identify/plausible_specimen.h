#pragma once
#include <string>
#include <vector>

#include "io/system/plausible.h"
#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] "must be at most 1000 N": the limit of the possible values that a value [SI] exceeds.
[[nodiscard]] std::string limit_text(const PlausibleRange& range, double value);

/// [setup] Counts times since 1970 from the specimen's first row, and rejects numbers that are in another
/// unit than their column says, by the table of plausible ranges (io/system/plausible.h). @param where file
/// and specimen, for the message @throws InputError with the unit that would make the numbers usual
void require_plausible(Specimen& specimen, const std::string& where);

/// [setup] Everything that a specimen must be, whether from a file or from a program: finite numbers,
/// increasing times, a curve that rises, plausible units, rows between shallow and deep. @param where file
/// and specimen, for the message @throws InputError
void check_specimen(Specimen& specimen, const std::string& where);

/// [setup] Whether the force does not rise out of its noise anywhere.
[[nodiscard]] bool is_flat(const Specimen& s);

/// [setup] One sentence for each range that is possible but unusual, with the unit that would make it usual.
[[nodiscard]] std::vector<std::string> unit_questions(const Specimen& specimen);

/// [setup] A question where the motion is slower or faster than usual, which matters to relaxation alone;
/// empty where it is not.
[[nodiscard]] std::string time_unit_question(const Specimen& specimen);

/// [setup] A question where the force of a loading rises ever more slowly, as the displacement over the force
/// of a tissue does; empty where it does not.
[[nodiscard]] std::string exchange_question(const Specimen& loading);

/// [setup] The radius of an indenter must be possible. @param name of the flag or column @throws InputError
void require_tip_radius(const std::string& name, double radius);

/// [setup] read_specimens() without its checks of whole specimens.
[[nodiscard]] std::vector<Specimen> read_rows(const std::filesystem::path& file);

}  // namespace palpate::identify

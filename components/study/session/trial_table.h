#pragma once
#include <string>
#include <vector>

#include "study/session/analysis.h"

namespace palpate::study {

/// A column of the table of trials.
struct TrialColumn {
  std::string name;
  std::string unit;  // empty: none
  std::string description;
};

/// [any] Columns of the table of trials, the same in CSV files and BIDS.
[[nodiscard]] const std::vector<TrialColumn>& trial_columns();

/// [setup] One trial's values, as text, for each column; empty: does not apply. The condition is the
/// participant's own code until unblinding. @throws InputError for an unknown task or code
[[nodiscard]] std::vector<std::string> trial_row(const Study& study, const Participant& person,
                                                 const TrialRecord& trial, const ArmNames& names);

/// [setup] All trials of all people who did not withdraw, practice and spoiled ones too: RFC 4180.
[[nodiscard]] std::string table_csv(const Study& study, std::span<const Participant> people,
                                    const ArmNames& names);

}  // namespace palpate::study

#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "science/tasks/ranks.h"

namespace palpate::identify {

struct ManyFits {
  std::vector<SpecimenFit> specimens;  // in their order
  PooledFit pooled;
  std::size_t resumed = 0;  // fits that were taken from the results file
};

/// [setup] Fits every specimen alone and all together, the work shared out among ranks: a specimen each
/// where there are enough of them, else the bootstrap of each. Every rank calls it alike and gets the same
/// bits, however many there are.
/// @param specimens of rank 0; what others give does not count
/// @param results_file rank 0 adds a line as each specimen is finished, and takes the fits that are in it
/// already; empty: none
/// @param progress called on rank 0
/// @throws InputError on every rank alike, as fit_specimen(), and when the file cannot be written.
[[nodiscard]] ManyFits fit_many(std::vector<Specimen> specimens, const Settings& settings,
                                tasks::Ranks& ranks, const std::string& results_file,
                                const Progress& progress);

}  // namespace palpate::identify

#pragma once
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "run/tasks/communicator.h"

namespace palpate::identify {

struct ManyFits {
  std::vector<SpecimenFit> specimens;  // in the order of the input
  PooledFit pooled;
  std::size_t resumed = 0;  // fits read from the results file
};

/// [setup] Fits each specimen alone, then all specimens together. With enough specimens, each rank fits whole
/// specimens; else all ranks share the bootstrap of each specimen. All ranks must make this call. The result
/// has the same bits for any number of ranks.
/// @param specimens used from rank 0 only
/// @param results_file rank 0 reads finished fits from it and appends a line per finished specimen; empty: no
/// file
/// @param progress called on rank 0
/// @throws InputError on all ranks: as fit_specimen(), or when the file cannot be written.
[[nodiscard]] ManyFits fit_many(std::vector<Specimen> specimens, const Settings& settings,
                                tasks::Communicator& ranks, const std::string& results_file,
                                const Progress& progress);

}  // namespace palpate::identify

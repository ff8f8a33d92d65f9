#pragma once
#include <filesystem>
#include <vector>

#include "view/report/page.h"

#include "fit/identify/sweep.h"

namespace palpate::report {

/// [setup] Adds a section with a figure per sweep: error over the fixed value, the confidence set, and the
/// other parameters. Writes sweep-1.svg and so on into `folder`. Adds nothing when there are no sweeps.
void write_sweeps(Page& page, const std::vector<identify::Sweep>& sweeps,
                  const std::filesystem::path& folder);

}  // namespace palpate::report

#pragma once
#include <filesystem>
#include <vector>

#include "science/identify/sweep.h"
#include "view/report/page.h"

namespace palpate::report {

/// [setup] A section with a picture of each sweep: error over the value that was held, the values that the
/// data leave, and where the other parameters go. Writes sweep-1.svg and on into `folder`. Nothing for no
/// sweeps.
void write_sweeps(Page& page, const std::vector<identify::Sweep>& sweeps,
                  const std::filesystem::path& folder);

}  // namespace palpate::report

#pragma once
#include <iosfwd>

#include "palpate/recording.h"
#include "run/palpation/score.h"

namespace palpate::app {

/// [setup] Scores a recording, with a progress bar. @throws InputError as scene::make_world()
[[nodiscard]] palpation::ScoredRecording score_of(const record::Recording& recording, bool no_cache);

/// [setup] Prints a score as text.
void print_score(std::ostream& out, const palpation::Score& score);

}  // namespace palpate::app

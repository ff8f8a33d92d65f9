#include "bench/measure/one_hand.h"

#include <string>

#include <unistd.h>

#include "io/system/clock.h"
#include "palpate/error.h"

namespace palpate::bench {

ScratchRecorder::ScratchRecorder(const scene::Scene& scene)
    : folder_("palpate-bench-" + std::to_string(getpid()) + "-"),
      recorder_(folder_.path() / "ticks.h5", scene, false) {
  recorder_.on_start(unix_ns());
}

ScratchRecorder::~ScratchRecorder() {
  try {
    recorder_.finish(haptics::LoopReport{});
  } catch (const InputError&) {
    // Errors of a disk that is too slow for ticks back to back do not concern the ticks.
  }
}

}  // namespace palpate::bench

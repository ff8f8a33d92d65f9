#include "bench/measure/one_hand.h"

#include <string>
#include <system_error>

#include <unistd.h>

#include "io/system/clock.h"
#include "palpate/error.h"

namespace palpate::bench {

namespace fs = std::filesystem;

ScratchRecorder::ScratchRecorder(const scene::Setup& setup)
    : file_(fs::temp_directory_path() / ("palpate-bench-" + std::to_string(getpid()) + ".h5")),
      recorder_(file_, setup, false) {
  recorder_.on_start(unix_ns());
}

ScratchRecorder::~ScratchRecorder() {
  try {
    recorder_.finish(haptics::LoopReport{});
  } catch (const InputError&) {
    // A disk that cannot keep up with ticks back to back says nothing about the ticks.
  }
  std::error_code ignored;
  fs::remove(file_, ignored);
}

}  // namespace palpate::bench

#include "bench/measure/one_hand.h"

#include <string>
#include <system_error>

#include <unistd.h>

#include "io/system/clock.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate::bench {

namespace fs = std::filesystem;

ScratchRecorder::ScratchRecorder(const scene::Setup& setup)
    : folder_(make_temporary_folder(fs::temp_directory_path() /
                                    ("palpate-bench-" + std::to_string(getpid()) + "-"))),
      recorder_(folder_ / "ticks.h5", setup, false) {
  recorder_.on_start(unix_ns());
}

ScratchRecorder::~ScratchRecorder() {
  try {
    recorder_.finish(haptics::LoopReport{});
  } catch (const InputError&) {
    // A disk that cannot keep up with ticks back to back says nothing about the ticks.
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

}  // namespace palpate::bench

#include "app/pictures.h"

#include "palpate/error.h"

namespace palpate::app {

bool has_pictures() noexcept { return false; }

void require_pictures(const std::string& flag) {
  throw InputError(
      flag +
      ": palpate for Windows draws no pictures and writes no reports; record the run (--record run.h5), and "
      "palpate view on Linux shows it");
}

void write_screenshot(const record::Recording& /*recording*/, const session::RunStatistics& /*statistics*/,
                      const std::filesystem::path& /*file*/, bool /*no_cache*/) {
  require_pictures("--screenshot");
}

}  // namespace palpate::app

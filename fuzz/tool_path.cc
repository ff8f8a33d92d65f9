// Tool paths from CSV. A valid path is finite at, between and beyond its rows.
#include "palpate/tool_path.h"

#include <cmath>

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".csv");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] {
    const scene::ToolPath path = scene::read_tool_path(file);
    for (const scene::PathRow& row : path.rows()) {
      for (const double time : {row.time, row.time + 1e-3, std::nextafter(row.time, 1e300)}) {
        const scene::PathRow at = path.at(time);
        fuzz::require(at.position.allFinite() && at.orientation.coeffs().allFinite(), "a path is finite");
      }
    }
  });
  return 0;
}

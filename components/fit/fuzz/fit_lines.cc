// Saved lines of a fit of many specimens. A valid line can be written and read again.
#include "run/tasks/record.h"

#include "fit/identify/fit_record.h"
#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".lines");
  for (const auto& [key, line] :
       tasks::read_record(input.hold({data, size}).string(), identify::check_line)) {
    if (line.find("points_swept") != std::string::npos)
      continue;  // check_line() has read the line of a sweep
    const identify::SpecimenFit fit = identify::parse_record_line(line);
    const identify::Curve& curve = fit.curve;
    fuzz::require(curve.low.size() == curve.fitted.size() && curve.high.size() == curve.fitted.size(),
                  "a band is as long as its curve");
    const std::string written = identify::record_line(key, fit);
    fuzz::require(identify::record_line(key, identify::parse_record_line(written)) == written,
                  "a fit that was read is read again when written", written);
  }
  return 0;
}

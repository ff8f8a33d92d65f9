#include "io/record/make_recorder.h"

#include "io/record/csv_recorder.h"
#include "io/record/recorder.h"

namespace palpate::record {

std::unique_ptr<RunRecorder> make_recorder(const std::filesystem::path& file, const scene::Scene& setup,
                                           bool waits) {
  if (file.extension() == ".csv") return std::make_unique<CsvRecorder>(file, setup, waits);
  return std::make_unique<Recorder>(file, setup, waits);
}

}  // namespace palpate::record

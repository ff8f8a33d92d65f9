#include "io/record/make_recorder.h"

#include "io/record/csv_recorder.h"
#include "io/record/recorder.h"

namespace palpate::record {

std::unique_ptr<RunRecorder> make_recorder(const std::filesystem::path& file, const scene::Scene& scene,
                                           bool waits) {
  if (file.extension() == ".csv") return std::make_unique<CsvRecorder>(file, scene, waits);
  return std::make_unique<Recorder>(file, scene, waits);
}

}  // namespace palpate::record

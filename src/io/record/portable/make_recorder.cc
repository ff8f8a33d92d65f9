// Recordings in a build without HDF5.
#include "io/record/make_recorder.h"

#include "io/record/csv_recorder.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::record {

std::unique_ptr<RunRecorder> make_recorder(const std::filesystem::path& file, const scene::Scene& scene,
                                           bool waits) {
  if (file.extension() == ".csv") return std::make_unique<CsvRecorder>(file, scene, waits);
  throw InputError(to_text(file) + ": this build of palpate has no HDF5, a recording must be a .csv file");
}

}  // namespace palpate::record

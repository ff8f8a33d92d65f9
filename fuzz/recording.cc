// Recordings: read, and repaired in place. HDF5 is built without sanitizers, so an error inside it shows only
// by a crash or by the use of its result.
#include "palpate/recording.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".h5");
  const std::filesystem::path& file = input.hold({data, size});
  fuzz::read_or_refuse(file.string(), [&] { (void)record::read_recording(file); });
  fuzz::read_or_refuse(file.string(), [&] { (void)record::repair_recording(file); });
  const std::filesystem::directory_iterator entries(input.folder());
  fuzz::require(std::distance(begin(entries), end(entries)) == 1,
                "a repair leaves no file of its own behind");
  return 0;
}

// Array files of the organ cache. The reader returns an empty optional for every invalid file.
#include "io/system/array_file.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".bin");
  const auto reader = ArrayFileReader::open(input.hold({data, size}), ContentHash{});
  if (!reader) return 0;
  (void)reader->get<double>("numbers");
  (void)reader->get<std::uint8_t>("bytes");
  return 0;
}

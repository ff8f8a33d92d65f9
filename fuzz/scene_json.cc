// The scene inside a recording. A valid scene can be written and read again.
#include "io/record/scene_json.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string text(data, data + size);
  fuzz::read_or_refuse("scene", [&] {
    const std::string written = record::scene_to_json(record::scene_from_json(text));
    const std::string again = record::scene_to_json(record::scene_from_json(written));
    fuzz::require(written == again, "a scene that was read is read again when written", written);
  });
  return 0;
}

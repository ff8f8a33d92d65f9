// Tissue files. A valid tissue can be written and read again.
#include "palpate/scene.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  static const fuzz::InputFile input(".toml");
  static const fuzz::InputFile written(".toml");
  const std::filesystem::path& file = input.hold({data, size});
  std::string text;
  fuzz::read_or_refuse(file.string(), [&] { text = scene::to_toml(scene::read_tissue_file(file)); });
  if (text.empty()) return 0;
  try {
    (void)scene::read_tissue_file(
        written.hold({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  } catch (const InputError& error) {
    fuzz::require(false, "a tissue that was read is read again when written", error.what() + ('\n' + text));
  }
  return 0;
}

// Study files and their plans, without the files that they name.
#include "study/session/study.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const palpate::fuzz::InputFile input(".toml");
  const std::filesystem::path& file = input.hold({data, size});
  palpate::fuzz::read_or_refuse(
      file.string(), [&] { (void)palpate::study::plan_sessions(palpate::study::load_study(file)); });
  return 0;
}

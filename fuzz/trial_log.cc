// Logs of study participants.
#include "science/experiment/trial_log.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const palpate::fuzz::InputFile input(".jsonl");
  const std::filesystem::path& file = input.hold({data, size});
  palpate::fuzz::read_or_refuse(file.string(), [&] { (void)palpate::experiment::read_log(file, "lock"); });
  return 0;
}

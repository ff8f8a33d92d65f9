// Logs of study participants.
#include "study/session/trial_log.h"

#include <algorithm>
#include <string_view>

#include "io/system/sha256.h"

#include "fuzz/input.h"

namespace {

/// The log with right macs, which no fuzzer finds. The rest of each line is kept, except "previous".
std::string with_macs(std::string_view log, const palpate::study::LogKey& key) {
  constexpr std::string_view kPrevious = "\"previous\":\"";
  std::string made;
  std::string mac = key.lock_hash;
  for (std::size_t end = log.find('\n'); end != std::string_view::npos; end = log.find('\n')) {
    std::string line(log.substr(0, end));
    log.remove_prefix(end + 1);
    const std::size_t at = line.find(kPrevious);
    const std::size_t quote = at == std::string::npos ? at : line.find('"', at + kPrevious.size());
    if (quote != std::string::npos) {
      line.replace(at + kPrevious.size(), quote - at - kPrevious.size(), mac);
    }
    line.resize(std::min(line.rfind(",\"mac\":\""), line.empty() ? 0 : line.size() - 1));
    mac = palpate::hmac_sha256(key.mac_key, line);
    made += line + ",\"mac\":\"" + mac + "\"}\n";
  }
  return made.append(log);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const palpate::fuzz::InputFile input(".jsonl");
  const palpate::study::LogKey key{"lock", "key"};
  const std::string log = with_macs({reinterpret_cast<const char*>(data), size}, key);
  const std::filesystem::path& file =
      input.hold({reinterpret_cast<const std::uint8_t*>(log.data()), log.size()});
  palpate::fuzz::read_or_refuse(file.string(), [&] { (void)palpate::study::read_log(file, key); });
  return 0;
}

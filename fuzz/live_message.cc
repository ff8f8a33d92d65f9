// Messages of clients of the live interface. A tissue from a valid message can be written and read again.
#include <nlohmann/json.hpp>

#include "net/live_messages.h"
#include "net/live_protocol.h"

#include "fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string text(data, data + size);
  net::LiveReference reference;
  std::optional<net::LiveCommand> command;
  try {
    command = net::read_live_message(text, reference);
  } catch (const net::LiveError& error) {
    fuzz::require(std::string(error.what()).find_first_of("\r\n") == std::string::npos,
                  "a refusal is one line", error.what());
    const auto answer = nlohmann::json::parse(net::error_text(reference, error));
    fuzz::require(answer["error"]["code"] == error.code(), "an error has its code", error.what());
    return 0;
  }
  (void)nlohmann::json::parse(net::answer_text(reference, nlohmann::ordered_json::object()));
  const auto* tissue = std::get_if<net::SetTissue>(&*command);
  if (tissue == nullptr || tissue->edit.preset) return 0;
  const model::TissueParameters made = net::edited(model::tissue_preset("heart"), tissue->edit);
  const std::string written =
      "{\"do\":\"set_tissue\",\"tissue\":" + net::text_of(net::tissue_json(made)) + "}";
  try {
    (void)net::read_live_message(written, reference);
  } catch (const InputError& error) {
    fuzz::require(false, "a tissue that was read is read again when written", written + "\n" + error.what());
  }
  return 0;
}

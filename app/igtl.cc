#include "app/igtl.h"

#include <fmt/core.h>

#include "core/base/text.h"

#include "app/messages.h"

namespace palpate::app {
IgtlService::IgtlService(const std::optional<std::string>& where) {
  if (!where) return;
  address_ = net::parse_igtl_address(*where);
  server_ = std::make_unique<net::IgtlServer>(address_);
}

void IgtlService::report_where() const {
  if (server_ == nullptr) return;
  const std::string port = std::to_string(address_.port);
  const bool local = address_.host.rfind("127.", 0) == 0;
  report_message(fmt::format(
      "OpenIGTLink: listening at {}:{}{}", address_.host, port,
      local ? ", for programs on this machine only (for other machines: --igtl 0.0.0.0:" + port + ")"
            : ": anyone who can reach it over the network can see the run; there is no password"));
}

std::optional<net::IgtlStatistics> IgtlService::finish() {
  if (server_ == nullptr) return std::nullopt;
  net::IgtlStatistics tally = server_->finish();
  server_.reset();
  std::string text = fmt::format("OpenIGTLink: {}, {} sent, {} skipped for slow clients",
                                 counted(tally.clients, "client", "clients"),
                                 counted(tally.frames, "frame", "frames"), tally.frames_left_out);
  if (tally.given_up > 0)
    text += fmt::format("; {} disconnected because they no longer received data", tally.given_up);
  if (tally.refused > 0)
    text += fmt::format("; {} refused because too many clients were connected", tally.refused);
  if (!tally.failure.empty()) text += "; the server ended early: " + tally.failure;
  report_message(text);
  return tally;
}

}  // namespace palpate::app

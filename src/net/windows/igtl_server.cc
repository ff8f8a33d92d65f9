// The OpenIGTLink server, in a program without OpenIGTLink: parse_igtl_address() refuses --igtl, so none is
// ever made.
#include "net/igtl_server.h"

namespace palpate::net {

IgtlClients::IgtlClients(const IgtlAddress& /*address*/, const Limits& limits)
    : limits_(limits), listener_(-1) {}

IgtlServer::IgtlServer(const IgtlAddress& address, const IgtlClients::Limits& limits)
    : clients_(address, limits), wake_(-1) {}

IgtlServer::~IgtlServer() = default;

IgtlStatistics IgtlServer::finish() { return {}; }

IgtlRun::IgtlRun(IgtlServer* server, const scene::Scene& /*scene*/) : server_(server) {}

IgtlRun::~IgtlRun() { (void)server_; }

}  // namespace palpate::net

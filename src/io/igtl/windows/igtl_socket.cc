#include "io/igtl/igtl_socket.h"

#include "palpate/error.h"

namespace palpate::net {

Descriptor::~Descriptor() = default;

IgtlAddress parse_igtl_address(const std::string& text, const std::string& who) {
  throw InputError(who + " " + text +
                   ": palpate for Windows does not speak OpenIGTLink; palpate serve shows the run");
}

}  // namespace palpate::net

#include "app/streams.h"

#include <cerrno>
#include <csignal>

#include <poll.h>
#include <unistd.h>

namespace palpate::app {

void prepare_streams() noexcept {}

std::vector<std::string> utf8_arguments(int argc, char** argv) { return {argv, argv + argc}; }

bool is_terminal(int descriptor) noexcept { return isatty(descriptor) == 1; }

int write_whole(int descriptor, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {  // another program has set the shared descriptor to O_NONBLOCK
      pollfd reader{descriptor, POLLOUT, 0};
      (void)poll(&reader, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

IgnoredBrokenPipes::IgnoredBrokenPipes() : before_(std::signal(SIGPIPE, SIG_IGN)) {}

IgnoredBrokenPipes::~IgnoredBrokenPipes() { std::signal(SIGPIPE, before_); }

}  // namespace palpate::app

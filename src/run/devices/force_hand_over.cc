#include "run/devices/force_hand_over.h"

#include "io/system/clock.h"
#include "run/devices/crash_stop.h"

namespace palpate::devices {

bool ForceHandover::write(const haptics::ForceCommand& command_D) noexcept {
  const bool finite = command_D.force.allFinite() && command_D.torque.allFinite();
  commands_.writable() = {finite ? command_D : haptics::ForceCommand{}, monotonic_ns()};
  commands_.publish();
  return finite;
}

void ForceHandover::stop() noexcept { stopped_ns_.store(monotonic_ns()); }

haptics::ForceCommand ForceHandover::wanted(std::int64_t now_ns, std::int64_t write_timeout_ns) noexcept {
  commands_.refresh();
  const Command& command = commands_.value();
  const bool stopped = command.written_ns <= stopped_ns_.load() || is_crashing();
  return stopped || now_ns - command.written_ns > write_timeout_ns ? haptics::ForceCommand{}
                                                                   : command.command_D;
}

}  // namespace palpate::devices

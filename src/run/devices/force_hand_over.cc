#include "run/devices/force_hand_over.h"

#include "io/system/clock.h"

namespace palpate::devices {

bool ForceHandover::write(const Vec3& force_D) noexcept {
  const bool finite = force_D.allFinite();
  commands_.writable() = {finite ? force_D : Vec3(Vec3::Zero()), monotonic_ns()};
  commands_.publish();
  return finite;
}

void ForceHandover::stop() noexcept { stopped_ns_.store(monotonic_ns()); }

Vec3 ForceHandover::wanted(std::int64_t now_ns, std::int64_t write_timeout_ns) noexcept {
  commands_.refresh();
  const Command& command = commands_.value();
  const bool stopped = command.written_ns <= stopped_ns_.load();
  return stopped || now_ns - command.written_ns > write_timeout_ns ? Vec3(Vec3::Zero()) : command.force_D;
}

}  // namespace palpate::devices

// Runs the loop for one second in real time. Prints its real-time settings and its lateness.
#include <iostream>
#include <string>

#include "palpate/scene.h"
#include "palpate/session.h"

namespace {

void show(const char* what, const palpate::haptics::Histogram& times) {
  std::cout << what << ": median " << 1e-3 * static_cast<double>(times.percentile(0.5))
            << " us, 99.9 % within " << 1e-3 * static_cast<double>(times.percentile(0.999)) << " us\n";
}

}  // namespace

int main() {
  auto session = palpate::session::Session::open(palpate::scene::load({}), {.duration_s = 1.0});
  const palpate::haptics::LoopReport report = session.run().loop;
  show("computing a tick", report.tick_time);
  show("a tick begins late by", report.lateness);
  std::cout << report.ticks << " ticks, " << report.missed_deadlines << " missed deadlines\n";
  for (const std::string& remark : report.remarks) std::cout << "note: " << remark << '\n';
  return report.ticks == session.ticks() ? 0 : 1;
}

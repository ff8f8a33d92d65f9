#pragma once
// RAII wrapper of a C-interface simulation, for tests.
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/system/test/own_cache.h"

#include "bindings/c/palpate.h"

namespace palpate::tests {

/// A struct of the interface with its size set and zeros otherwise.
template <typename Struct>
Struct fresh() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

/// Throws with the interface's message if a call fails.
inline void require(palpate_status status) {
  if (status != PALPATE_OK) throw std::runtime_error(palpate_last_error());
}

class Session final {
 public:
  explicit Session(palpate_options options = fresh<palpate_options>()) {
    require(palpate_open(&options, &simulation_));
    require(palpate_get_info(simulation_, &info));
    samples.assign(info.hands, fresh<palpate_sample>());
    results.assign(info.hands, fresh<palpate_result>());
  }
  ~Session() { palpate_close(simulation_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] palpate_simulation* get() const { return simulation_; }
  /// Closes the simulation. @return the status of palpate_close()
  palpate_status close() { return palpate_close(std::exchange(simulation_, nullptr)); }
  /// Computes one tick with the current samples.
  void tick() { require(palpate_tick(simulation_, samples.data(), results.data(), samples.size())); }
  /// Sets `samples` to the scripted samples of a tick.
  void script(std::uint64_t number) {
    for (std::uint32_t hand = 0; hand < info.hands; ++hand) {
      require(palpate_scripted_sample(simulation_, hand, number, &samples[hand]));
    }
  }
  /// Runs scripted ticks from `first` up to, but without, `last`.
  void run(std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t number = first; number < last; ++number) {
      script(number);
      tick();
    }
  }

  palpate_info info = fresh<palpate_info>();
  std::vector<palpate_sample> samples;
  std::vector<palpate_result> results;

 private:
  palpate_simulation* simulation_ = nullptr;
};

/// The built-in press without a hand.
inline palpate_options unheld() {
  palpate_options options = fresh<palpate_options>();
  options.no_hand = 1;
  return options;
}

/// The same options with a recording of every tick. @param file must outlive them
inline palpate_options recorded(palpate_options options, const std::string& file) {
  options.record_file = file.c_str();
  options.record_waits = 1;
  return options;
}

}  // namespace palpate::tests

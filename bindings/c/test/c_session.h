#pragma once
// A simulation of the C interface for tests, closed at the end of the test.
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings/c/palpate.h"

namespace palpate::tests {

/// A struct of the interface with its size set and all else zero.
template <typename Struct>
Struct fresh() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

/// Throws with the interface's own message when a call fails that a test takes for granted.
inline void require(palpate_status status) {
  if (status != PALPATE_OK) throw std::runtime_error(palpate_last_error());
}

class Session final {
 public:
  explicit Session(palpate_options options = fresh<palpate_options>()) {
    options.no_cache = 1;
    require(palpate_open(&options, &simulation_));
    require(palpate_get_info(simulation_, &info));
    samples.assign(info.hands, fresh<palpate_sample>());
    results.assign(info.hands, fresh<palpate_result>());
  }
  ~Session() { palpate_close(simulation_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] palpate_simulation* get() const { return simulation_; }
  /// Closes it now. @return what palpate_close() says
  palpate_status close() { return palpate_close(std::exchange(simulation_, nullptr)); }
  /// One tick with the samples as they stand.
  void tick() { require(palpate_tick(simulation_, samples.data(), results.data(), samples.size())); }
  /// Takes the scripted samples of a tick into `samples`.
  void script(std::uint64_t number) {
    for (std::uint32_t hand = 0; hand < info.hands; ++hand) {
      require(palpate_scripted_sample(simulation_, hand, number, &samples[hand]));
    }
  }
  /// Ticks `first` up to, not including, `last`, scripted.
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

/// The built-in press with samples that nobody's hand gives.
inline palpate_options unheld() {
  palpate_options options = fresh<palpate_options>();
  options.no_hand = 1;
  return options;
}

}  // namespace palpate::tests

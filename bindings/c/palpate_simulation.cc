// Functions of palpate.h for a simulation.
#include <cstddef>
#include <memory>
#include <string>

#include "core/haptics/gate.h"
#include "palpate/scene.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"

using palpate::c_interface::guarded;
using palpate::c_interface::kForked;
using palpate::c_interface::refuse;
using palpate::c_interface::require_given;
using palpate::c_interface::require_size;
using palpate::c_interface::require_usable;
using palpate::c_interface::UseError;

namespace {

static_assert(PALPATE_MAX_HANDS == palpate::kMaxHands);
static_assert(PALPATE_ENERGY_DAMPED == palpate::haptics::kEnergyDamped);
static_assert(PALPATE_DUTY_HIGH == palpate::haptics::kDutyHigh);
static_assert(PALPATE_DUTY_LIMITED == palpate::haptics::kDutyLimited);
static_assert(PALPATE_JUMP == palpate::contact::kJump);
static_assert(PALPATE_EXTRAPOLATED == palpate::contact::kExtrapolated);

/// Whether every sample and result has the library's size.
bool sizes_are_right(const palpate_sample* samples, const palpate_result* results,
                     std::size_t hands) noexcept {
  for (std::size_t hand = 0; hand < hands; ++hand) {
    if (samples[hand].struct_size != sizeof(palpate_sample)) return false;
    if (results[hand].struct_size != sizeof(palpate_result)) return false;
  }
  return true;
}

}  // namespace

extern "C" {

palpate_status palpate_open(const palpate_options* options, palpate_simulation** simulation) {
  return guarded([&] {
    require_given(simulation, "simulation");
    *simulation = nullptr;
    require_given(options, "options");
    require_size(options->struct_size, sizeof *options, "palpate_options");
    *simulation =
        std::make_unique<palpate_simulation>(palpate::c_interface::load(*options), *options).release();
  });
}

palpate_status palpate_close(palpate_simulation* simulation) {
  const std::unique_ptr<palpate_simulation, palpate::c_interface::FreeOwn> owned(simulation);
  return guarded([&] {
    if (owned && owned->is_own()) owned->finish_recording();
  });
}

palpate_status palpate_get_info(const palpate_simulation* simulation, palpate_info* info) {
  return guarded([&] {
    require_usable(simulation);
    require_given(info, "info");
    require_size(info->struct_size, sizeof *info, "palpate_info");
    *info = simulation->info();
  });
}

const char* palpate_name(const palpate_simulation* simulation) {
  return simulation == nullptr ? "" : simulation->scene().name.c_str();
}

const char* palpate_remark(const palpate_simulation* simulation, size_t index) {
  if (simulation == nullptr) return nullptr;
  const palpate::scene::Scene& scene = simulation->scene();
  if (index < scene.repairs.size()) return scene.repairs[index].c_str();
  const std::size_t after = index - scene.repairs.size();
  return after < scene.remarks.size() ? scene.remarks[after].c_str() : nullptr;
}

palpate_status palpate_tick(palpate_simulation* simulation, const palpate_sample* samples,
                            palpate_result* results, size_t hands) {
  if (simulation == nullptr || samples == nullptr || results == nullptr) {
    return refuse(PALPATE_ERROR_USE,
                  "palpate_tick: simulation, samples and results must be given, one is null");
  }
  if (!simulation->is_own()) return refuse(PALPATE_ERROR_USE, kForked);
  if (hands != simulation->hands()) {
    return refuse(PALPATE_ERROR_USE, "palpate_tick: hands must be palpate_info.hands");
  }
  if (!sizes_are_right(samples, results, hands)) {
    return refuse(PALPATE_ERROR_USE,
                  "palpate_tick: struct_size must be sizeof the struct, in every sample and every result");
  }
  simulation->tick(samples, results);
  return PALPATE_OK;
}

palpate_status palpate_reset_fault(palpate_simulation* simulation, uint32_t hand_bits) {
  if (simulation == nullptr) {
    return refuse(PALPATE_ERROR_USE, "palpate_reset_fault: simulation: is null, must be given");
  }
  if (!simulation->is_own()) return refuse(PALPATE_ERROR_USE, kForked);
  simulation->reset_faults(hand_bits);
  return PALPATE_OK;
}

palpate_status palpate_restart(palpate_simulation* simulation) {
  return guarded([&] {
    require_usable(simulation);
    if (simulation->recording()) {
      throw UseError("palpate_restart: not while recording; close the simulation and open it again");
    }
    simulation->restart();
  });
}

palpate_status palpate_scripted_sample(palpate_simulation* simulation, uint32_t hand, uint64_t tick,
                                       palpate_sample* sample) {
  if (simulation == nullptr || sample == nullptr) {
    return refuse(PALPATE_ERROR_USE, "palpate_scripted_sample: simulation and sample must be given");
  }
  if (!simulation->is_own()) return refuse(PALPATE_ERROR_USE, kForked);
  if (hand >= simulation->hands()) {
    return refuse(PALPATE_ERROR_USE, "palpate_scripted_sample: hand must be less than palpate_info.hands");
  }
  if (sample->struct_size != sizeof *sample) {
    return refuse(PALPATE_ERROR_USE, "palpate_scripted_sample: struct_size must be sizeof the sample");
  }
  simulation->scripted_sample(hand, tick, *sample);
  return PALPATE_OK;
}

}  // extern "C"

// Functions of palpate.h for a simulation.
#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "core/haptics/gate.h"
#include "palpate/scene.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/c/struct_size.h"

using palpate::c_interface::give;
using palpate::c_interface::guarded;
using palpate::c_interface::is_known_size;
using palpate::c_interface::kForked;
using palpate::c_interface::refuse;
using palpate::c_interface::require_given;
using palpate::c_interface::require_size;
using palpate::c_interface::require_usable;
using palpate::c_interface::taken;
using palpate::c_interface::UseError;

namespace {

static_assert(PALPATE_MAX_HANDS == palpate::kMaxHands);
static_assert(PALPATE_ENERGY_DAMPED == palpate::haptics::kEnergyDamped);
static_assert(PALPATE_DUTY_HIGH == palpate::haptics::kDutyHigh);
static_assert(PALPATE_DUTY_LIMITED == palpate::haptics::kDutyLimited);
static_assert(PALPATE_JUMP == palpate::contact::kJump);
static_assert(PALPATE_EXTRAPOLATED == palpate::contact::kExtrapolated);
static_assert(PALPATE_AT_HUB == palpate::contact::kAtHub);

/// The caller's struct of a hand. In an array of an older header's structs each has that header's size.
template <typename Struct>
Struct* of_hand(Struct* structs, std::size_t hand) noexcept {
  using Byte = std::conditional_t<std::is_const_v<Struct>, const std::byte, std::byte>;
  return reinterpret_cast<Struct*>(reinterpret_cast<Byte*>(structs) + hand * structs->struct_size);
}

/// Whether the structs of all hands have one size, which is known.
template <typename Struct>
bool sizes_are_right(const Struct* structs, std::size_t hands) noexcept {
  if (!is_known_size<Struct>(structs->struct_size)) return false;
  for (std::size_t hand = 1; hand < hands; ++hand) {
    if (of_hand(structs, hand)->struct_size != structs->struct_size) return false;
  }
  return true;
}

/// A sample with what an older header's struct may lack.
palpate_sample sample_of(const palpate_sample* given) noexcept {
  palpate_sample rest{};
  rest.orientation[0] = 1.0;
  return taken(given, rest);
}

}  // namespace

extern "C" {

palpate_status palpate_open(const palpate_options* options, palpate_simulation** simulation) {
  return guarded([&] {
    require_given(simulation, "simulation");
    *simulation = nullptr;
    require_given(options, "options");
    require_size(*options, "palpate_options");
    const palpate_options whole = taken(options);
    *simulation = std::make_unique<palpate_simulation>(
                      palpate::c_interface::load(whole, palpate::c_interface::request_of(whole)), whole)
                      .release();
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
    require_size(*info, "palpate_info");
    give(simulation->info(), info);
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
  if (!sizes_are_right(samples, hands) || !sizes_are_right(results, hands)) {
    return refuse(PALPATE_ERROR_USE,
                  "palpate_tick: struct_size must be sizeof the struct, in every sample and every result");
  }
  std::array<palpate_sample, PALPATE_MAX_HANDS> own_samples;
  std::array<palpate_result, PALPATE_MAX_HANDS> own_results{};
  for (std::size_t hand = 0; hand < hands; ++hand) own_samples[hand] = sample_of(of_hand(samples, hand));
  simulation->tick(own_samples.data(), own_results.data());
  for (std::size_t hand = 0; hand < hands; ++hand) give(own_results[hand], of_hand(results, hand));
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
  if (!is_known_size<palpate_sample>(sample->struct_size)) {
    return refuse(PALPATE_ERROR_USE, "palpate_scripted_sample: struct_size must be sizeof the sample");
  }
  palpate_sample whole{};
  simulation->scripted_sample(hand, tick, whole);
  give(whole, sample);
  return PALPATE_OK;
}

}  // extern "C"

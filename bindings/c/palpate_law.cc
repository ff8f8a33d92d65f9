// Functions of palpate.h for the force law and the touch noise.
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

#include "bindings/c/errors.h"
#include "bindings/c/float_environment.h"
#include "bindings/c/struct_size.h"

/// Force law of a tissue in one direction.
struct palpate_law {
  std::variant<palpate::model::LayeredSpringLaw, palpate::model::SmoothSpringLaw> law;
};

namespace {

using palpate::c_interface::DefaultFloatEnvironment;
using palpate::c_interface::guarded;
using palpate::c_interface::refuse;
using palpate::c_interface::require_given;
using palpate::model::LayeredSpringLaw;
using palpate::model::SmoothSpringLaw;

palpate::model::Direction direction_of(std::string_view word) {
  if (word == "press") return palpate::model::Direction::kPress;
  if (word == "pull") return palpate::model::Direction::kPull;
  throw palpate::InputError("direction = \"" + std::string(word) + "\": must be press or pull");
}

std::unique_ptr<palpate_law> make_law(const char* tissue_name, const char* direction_word, double rate) {
  if (!(rate > 1e-300) || !std::isfinite(rate)) {
    throw palpate::ParameterError("rate", rate, "finite and > 1e-300 (Hz)");
  }
  const auto tissue = palpate::scene::load_tissue(tissue_name);
  const palpate::model::Direction direction = direction_of(direction_word);
  if (tissue.law == palpate::model::LawKind::kSmooth) {
    return std::make_unique<palpate_law>(palpate_law{SmoothSpringLaw(tissue, direction, 1.0 / rate)});
  }
  return std::make_unique<palpate_law>(palpate_law{LayeredSpringLaw(tissue, direction, 1.0 / rate)});
}

/// Evaluates a law and fills the response; `ask` must accept both laws.
template <typename Ask>
palpate_status answer(const palpate_law* law, double asked, palpate_response* response,
                      const Ask& ask) noexcept {
  if (law == nullptr || response == nullptr) {
    return refuse(PALPATE_ERROR_USE, "palpate_law: law and response must be given, one is null");
  }
  if (!palpate::c_interface::is_known_size<palpate_response>(response->struct_size)) {
    return refuse(PALPATE_ERROR_USE, "palpate_response.struct_size: must be sizeof the struct");
  }
  if (!(asked >= 0.0) || !std::isfinite(asked)) {
    return refuse(PALPATE_ERROR_INPUT, "palpate_law: depth or force must be finite and >= 0");
  }
  const DefaultFloatEnvironment environment;
  const auto* layered = std::get_if<LayeredSpringLaw>(&law->law);
  const LayeredSpringLaw::LayerState state =
      layered != nullptr ? ask(*layered) : ask(*std::get_if<SmoothSpringLaw>(&law->law));
  palpate_response whole{};
  whole.depth = state.depth;
  whole.force = state.force;
  whole.stiffness = state.stiffness;
  whole.cutoff_layer = state.cutoff_layer;
  whole.saturated = state.saturated ? 1 : 0;
  palpate::c_interface::give(whole, response);
  return PALPATE_OK;
}

}  // namespace

extern "C" {

palpate_status palpate_law_open(const char* tissue, const char* direction, double rate, palpate_law** law) {
  return guarded([&] {
    require_given(law, "law");
    *law = nullptr;
    require_given(tissue, "tissue");
    require_given(direction, "direction");
    *law = make_law(tissue, direction, rate).release();
  });
}

void palpate_law_close(palpate_law* law) { std::unique_ptr<palpate_law>{law}.reset(); }

palpate_status palpate_law_force_at(const palpate_law* law, double depth, palpate_response* response) {
  return answer(law, depth, response, [depth](const auto& one) { return one.deformation_at(depth); });
}

palpate_status palpate_law_depth_under(const palpate_law* law, double force, palpate_response* response) {
  return answer(law, force, response, [force](const auto& one) { return one.deformation_under(force); });
}

palpate_status palpate_noise_sample(double gain, double threshold, uint64_t seed, uint32_t hand,
                                    uint64_t tick, double distance, double* force) {
  return guarded([&] {
    require_given(force, "force");
    if (!(distance >= 0.0)) throw palpate::ParameterError("distance", distance, "a number >= 0 (m)");
    palpate::noise::NoiseSettings settings;
    settings.gain = gain;
    settings.threshold = threshold;
    settings.seed = seed;
    const DefaultFloatEnvironment environment;
    const palpate::noise::TouchNoise noise(settings, settings.rate_Hz);
    palpate::noise::TouchNoise::State state;
    *force = noise.force(state, true, hand, tick, distance);
  });
}

}  // extern "C"

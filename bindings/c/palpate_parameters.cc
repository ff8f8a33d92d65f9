// Functions of palpate.h that change the tissue and the touch noise of a simulation.
#include <algorithm>
#include <array>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

#include "core/model/tissue_fields.h"
#include "palpate/parameter_updates.h"
#include "palpate/scene.h"

#include "bindings/c/errors.h"
#include "bindings/c/float_environment.h"
#include "bindings/c/simulation.h"

using palpate::c_interface::DefaultFloatEnvironment;
using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::require_usable;
using palpate::model::kTissueFields;
using palpate::model::TissueField;
using palpate::model::TissueParameters;

namespace {

using FieldNames = std::array<std::string, kTissueFields.size()>;

/// The names of kTissueFields in its order.
const FieldNames& field_names() {
  static const FieldNames kNames = [] {
    FieldNames names;
    std::transform(kTissueFields.begin(), kTissueFields.end(), names.begin(),
                   [](const TissueField& field) { return field.path(); });
    return names;
  }();
  return kNames;
}

/// @throws InputError that lists the names if there is no such field.
const TissueField& tissue_field(std::string_view name) {
  const FieldNames& names = field_names();
  const auto* found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return kTissueFields[static_cast<std::size_t>(found - names.begin())];
  std::string message = "field = \"" + std::string(name.substr(0, 80)) + "\": must be one of";
  for (const std::string& known : names) message += (&known == names.data() ? " " : ", ") + known;
  throw palpate::InputError(message);
}

}  // namespace

extern "C" {

palpate_status palpate_set_tissue(palpate_simulation* simulation, const char* tissue) {
  return guarded([&] {
    require_usable(simulation);
    require_given(tissue, "tissue");
    const DefaultFloatEnvironment environment;
    const TissueParameters loaded = palpate::scene::load_tissue(tissue);
    const std::lock_guard one_at_a_time(simulation->tissue_callers());
    (void)simulation->updates().offer(loaded);
  });
}

const char* palpate_tissue_field(size_t index) {
  const char* name = nullptr;
  (void)guarded([&] {
    if (index < kTissueFields.size()) name = field_names()[index].c_str();
  });
  return name;
}

palpate_status palpate_set_tissue_value(palpate_simulation* simulation, const char* field, double value) {
  return guarded([&] {
    require_usable(simulation);
    require_given(field, "field");
    const TissueField& number = tissue_field(field);
    const DefaultFloatEnvironment environment;
    const std::lock_guard one_at_a_time(simulation->tissue_callers());
    TissueParameters tissue = simulation->updates().tissue();
    number.at.set(tissue, value * number.unit.si);
    (void)simulation->updates().offer(tissue);
  });
}

palpate_status palpate_get_tissue_value(const palpate_simulation* simulation, const char* field,
                                        double* value) {
  return guarded([&] {
    require_usable(simulation);
    require_given(field, "field");
    require_given(value, "value");
    const TissueField& number = tissue_field(field);
    *value = number.in_force(simulation->updates().tissue()) / number.unit.si;
  });
}

palpate_status palpate_set_noise(palpate_simulation* simulation, int32_t enabled, double gain,
                                 double threshold) {
  return guarded([&] {
    require_usable(simulation);
    const DefaultFloatEnvironment environment;
    (void)simulation->updates().offer(palpate::haptics::LiveNoise{enabled != 0, gain, threshold});
  });
}

palpate_status palpate_get_noise(const palpate_simulation* simulation, int32_t* enabled, double* gain,
                                 double* threshold) {
  return guarded([&] {
    require_usable(simulation);
    require_given(enabled, "enabled");
    require_given(gain, "gain");
    require_given(threshold, "threshold");
    const palpate::haptics::LiveNoise noise = simulation->updates().noise();
    *enabled = noise.enabled ? 1 : 0;
    *gain = noise.gain;
    *threshold = noise.threshold;
  });
}

}  // extern "C"

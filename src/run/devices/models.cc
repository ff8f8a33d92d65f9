#include "run/devices/models.h"

#include <string>

#include "core/base/text.h"

namespace palpate::devices {
namespace {

struct Model {
  std::string_view part;  // part of the model's name, in lower case
  double max_force;       // N
  double max_stiffness;   // N/m; 0: unknown
  bool torque;
};

// Forces and stiffness are from CHAI3D 3.3's tables, those of the Inverse3 from its documentation.
// docs/devices.md shows this table.
constexpr Model kModels[] = {
    {"omega", 12.0, 5000.0, false},
    {"delta", 20.0, 5000.0, false},
    {"sigma", 20.0, 4000.0, true},
    {"lambda", 20.0, 8000.0, true},
    {"falcon", 8.0, 3000.0, false},
    {"touch x", 7.9, 1000.0, false},
    {"phantom desktop", 7.9, 1000.0, false},
    {"phantom omni", 3.3, 700.0, false},
    {"touch", 3.3, 400.0, false},
    {"inverse3", 10.0, 0.0, false},
};

}  // namespace

haptics::DeviceAbilities abilities_of_model(std::string_view name) {
  const std::string lower = lower_case(name);
  haptics::DeviceAbilities abilities;
  abilities.model = name;
  for (const Model& model : kModels) {
    if (lower.find(model.part) == std::string::npos) continue;
    abilities.max_force = model.max_force;
    if (model.max_stiffness > 0.0) abilities.max_stiffness = model.max_stiffness;
    abilities.torque = model.torque;
    break;
  }
  return abilities;
}

}  // namespace palpate::devices

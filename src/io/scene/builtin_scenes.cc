#include "io/scene/builtin_scenes.h"

#include <array>
#include <string>

namespace palpate::scene {
namespace {

// A constant kText_NAME for each file, made by CMake.
#include "scene_texts.inc"

constexpr std::array<BuiltinScene, 8> kBuiltinScenes = {{
    {"press", "Press", "Curved forceps press a gallbladder: feel how it stiffens with depth.",
     "examples/press.toml", kText_press},
    {"pull", "Pull", "Grasp a heart between the jaws, lift it and feel it pull back.", "examples/pull.toml",
     kText_pull},
    {"find-the-lump", "Lump search", "Three nodules hide in a liver: find them by touch and mark them.",
     "examples/find-the-lump.toml", kText_find_the_lump},
    {"beating-heart", "Beating heart", "A heart beats and moves with the breath under your forceps.",
     "examples/beating-heart.toml", kText_beating_heart},
    {"bimanual", "Two hands", "Two instruments press one gallbladder, 30 mm from each other.",
     "examples/bimanual.toml", kText_bimanual},
    {"gallstone", "Gallstone", "A stone lies under the surface of a gallbladder: press above it.",
     "examples/gallstone.toml", kText_gallstone},
    {"heart-plaque", "Plaque",
     "A ball finds a hard plaque and a vessel that pulses, under a heart's surface.",
     "examples/heart-plaque.toml", kText_heart_plaque},
    {"insert", "Needle", "A needle goes through skin, fat and muscle: feel each layer give way.",
     "examples/insert.toml", kText_insert},
}};

}  // namespace

std::span<const BuiltinScene> builtin_scenes() noexcept { return kBuiltinScenes; }

Overrides request_of(const BuiltinScene& builtin, const std::string& device_kind) {
  Overrides request;
  request.scene_text = {std::string(builtin.toml), {}};
  const bool has_several_hands = builtin.toml.find("[[tool]]") != std::string_view::npos;
  if (has_several_hands) {  // --device is for one hand
    request.settings = {{"device.kind", device_kind}};
  } else {
    request.device = device_kind;
  }
  return request;
}

}  // namespace palpate::scene

#pragma once
#include <optional>
#include <string>

#include "palpate/scene.h"
#include "palpate/tissue.h"

#include "app/cli.h"

namespace palpate::app {

/// [setup] Adds the flags that select and override a scene, e.g. --organ, to a command. @param request
/// outlives the parse
void add_scene_flags(CLI::App& command, scene::Overrides& request);

/// [setup] Adds those of them that describe organ, tool and rate: all but --task, --device, --seed and the
/// flags of the noise and the device's fit.
void add_organ_and_tool_flags(CLI::App& command, scene::Overrides& request);

/// The force law that the flags of a command select.
struct LawFlags {
  std::string tissue;                 // built-in name or tissue file
  std::optional<model::LawKind> law;  // nullopt: the law of the tissue file
  model::Direction direction = model::Direction::kPress;
  double rate_Hz = 1000.0;

  /// [setup] Loads the tissue and applies --law to it. @throws InputError
  [[nodiscard]] model::TissueParameters load() const;
};

/// [setup] Adds --tissue, --law, --direction and --rate-Hz to a command.
void add_law_flags(CLI::App& command, LawFlags& flags);

}  // namespace palpate::app

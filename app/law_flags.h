#pragma once
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "palpate/tissue.h"

namespace palpate::app {

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

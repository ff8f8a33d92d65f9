#pragma once
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "palpate/tissue.h"

namespace palpate::app {

/// The force law that a command is about, as its flags say.
struct LawFlags {
  std::string tissue;                 // name or file
  std::optional<model::LawKind> law;  // nothing: the tissue's
  model::Direction direction = model::Direction::kPress;
  double rate_Hz = 1000.0;

  /// [setup] The tissue with the law that was asked for. @throws InputError
  [[nodiscard]] model::TissueParameters load() const;
};

/// [setup] Gives a command --tissue, --law, --direction and --rate-Hz.
void add_law_flags(CLI::App& command, LawFlags& flags);

}  // namespace palpate::app

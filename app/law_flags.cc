#include "app/law_flags.h"

#include <utility>
#include <vector>

#include "palpate/scene.h"

#include "app/numbers.h"

namespace palpate::app {

model::TissueParameters LawFlags::load() const {
  model::TissueParameters parameters = scene::load_tissue(tissue);
  if (law) parameters.law = *law;
  return parameters;
}

void add_law_flags(CLI::App& command, LawFlags& flags) {
  using Laws = std::vector<std::pair<std::string, model::LawKind>>;
  using Directions = std::vector<std::pair<std::string, model::Direction>>;
  command
      .add_option("--tissue", flags.tissue,
                  "a built-in tissue (gallbladder, heart, liver, kidney) or a tissue file")
      ->required();
  add_choice(command, "--law", flags.law,
             Laws{{"layered", model::LawKind::kLayered}, {"smooth", model::LawKind::kSmooth}},
             "layered (the paper's) or smooth (no steps in stiffness); default: the law of the tissue");
  add_choice(command, "--direction", flags.direction,
             Directions{{"press", model::Direction::kPress}, {"pull", model::Direction::kPull}},
             "press or pull (default press)");
  command.add_option_function<std::string>(
      "--rate-Hz",
      [&flags](const std::string& text) {
        constexpr double kLeast = 1e-300;  // Hz; the period of a lower rate is not finite
        flags.rate_Hz = parse_positive("--rate-Hz", text);
        if (flags.rate_Hz < kLeast) throw InputError("--rate-Hz " + text + ": must be > 1e-300");
      },
      "loop rate, which limits the number of layers (default 1000)");
}

}  // namespace palpate::app

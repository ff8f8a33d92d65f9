#include "app/scene_flags.h"

#include <utility>
#include <vector>

#include "app/numbers.h"

namespace palpate::app {

void add_organ_and_tool_flags(CLI::App& command, scene::Overrides& request) {
  command.add_option("--organ", request.organ, "built-in organ or mesh file");
  command.add_option("--organ-unit", request.organ_unit, "unit of the organ's file: mm, cm, m or in");
  command.add_option("--organ-frame", request.organ_frame,
                     "axes of the organ's file: ras or lps (default: as its header says, else ras); "
                     "OpenIGTLink clients get ras");
  command
      .add_option("--organ-motion", request.organ_motion,
                  "breathing, heartbeat or none, instead of the scene's; repeat the flag for both")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option(
          "--organ-support", request.organ_support,
          "what holds the organ, so that all of it gives way: bed:X,Y,Z[,SHARE] (direction towards the "
          "bed), faces:X,Y,Z (held faces look away from it), at:X,Y,Z,RADIUS (mm), or none; repeat "
          "the flag to add up")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option(
          "--inclusion", request.inclusions,
          "nodule, stone, plaque, vessel, cyst or none, under the place that the default path presses, "
          "instead of the scene's; repeat the flag for several")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--tissue", request.tissue, "built-in tissue or tissue file");
  command.add_option("--tool", request.tools, "built-in tool or mesh file; repeat the flag for each jaw")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--tool-unit", request.tool_unit, "unit of the tool's files");
  command.add_option("--rate-Hz", request.rate_Hz, "haptic ticks per second");
}

void add_scene_flags(CLI::App& command, scene::Overrides& request) {
  command.add_option("SCENE", request.scene, "scene file (.toml); default: the gallbladder press");
  command.add_option("--task", request.task, "press, pull, palpate (find hidden lumps) or insert (a needle)");
  add_organ_and_tool_flags(command, request);
  command.add_option("--device", request.device,
                     "KIND[:PATH]: scripted, scripted:path.csv, emulated, replay:rec.h5, "
                     "mouse, gamepad, forcedimension, haply, touch, igtl:PORT/NAME, ros, ros:/topic "
                     "(`palpate devices` lists the available ones)");
  command.add_option("--seed", request.seed, "seed of the touch noise");
  command.add_flag("--no-noise", request.no_noise, "run without the touch noise");
  command.add_flag("--fit-device", request.fit_device,
                   "scale the force so that the tissue is not stiffer than the device can render stably");
}

model::TissueParameters LawFlags::load() const {
  model::TissueParameters parameters = scene::load_tissue(tissue);
  if (law) parameters.law = *law;
  return parameters;
}

void add_law_flags(CLI::App& command, LawFlags& flags) {
  using Laws = std::vector<std::pair<std::string, model::LawKind>>;
  using Directions = std::vector<std::pair<std::string, model::Direction>>;
  command
      .add_option(
          "--tissue", flags.tissue,
          "a built-in tissue (gallbladder, heart, liver, kidney: illustrative; liver-ex-vivo, heart-muscle: "
          "measured) or a tissue file")
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

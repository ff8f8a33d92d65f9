// `palpate model`: evaluates the force law alone, from force to depth or from depth to force.
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/numbers.h"
#include "app/output.h"
#include "app/scene_flags.h"

namespace palpate::app {
namespace {

using model::LayeredSpringLaw;

struct ModelFlags {
  LawFlags law;
  std::string forces;
  std::string depths;
  bool as_json = false;
};

/// One requested force or depth, and the state of the layers that the law computes for it.
struct Answer {
  double requested = 0.0;  // N or mm
  LayeredSpringLaw::LayerState state;
};

struct Account {
  model::TissueParameters tissue;
  std::string direction;  // press or pull
  double rate_Hz = 0.0;
  bool by_force = false;
  int layers_allowed = 0;
  std::vector<Answer> answers;
};

/// Evaluates `law` at all requested forces [N] or depths [mm] and adds the states to `account`.
template <typename Law>
void answer(const Law& law, const std::vector<double>& requested, Account& account) {
  account.layers_allowed = law.layers_allowed();
  for (const double value : requested) {
    account.answers.push_back(
        {value, account.by_force ? law.deformation_under(value) : law.deformation_at(value * kMillimetre)});
  }
}

Account compute(const ModelFlags& flags) {
  Account account;
  account.direction = flags.law.direction == model::Direction::kPull ? "pull" : "press";
  account.rate_Hz = flags.law.rate_Hz;
  account.by_force = !flags.forces.empty();
  const std::vector<double> requested = account.by_force
                                            ? parse_not_negative_list("--force-N", flags.forces)
                                            : parse_not_negative_list("--depth-mm", flags.depths);
  account.tissue = flags.law.load();
  const double period = 1.0 / account.rate_Hz;
  if (account.tissue.law == model::LawKind::kSmooth) {
    answer(model::SmoothSpringLaw(account.tissue, flags.law.direction, period), requested, account);
  } else {
    answer(LayeredSpringLaw(account.tissue, flags.law.direction, period), requested, account);
  }
  return account;
}

std::vector<double> layer_deformation_mm(const LayeredSpringLaw::LayerState& state) {
  std::vector<double> deformation;
  for (int i = 0; i < state.cutoff_layer; ++i) {
    deformation.push_back(state.deformation[static_cast<std::size_t>(i)] / kMillimetre);
  }
  return deformation;
}

std::string note(const model::TissueParameters& tissue, const LayeredSpringLaw::LayerState& state) {
  if (state.saturated) return "  saturated: all layers are at their largest deformation";
  if (!state.extrapolated) return "";
  return "  past " + shortest(*tissue.max_depth / kMillimetre) +
         " mm, the max_depth_mm of this tissue: the tangent stays";
}

void print_json(const Account& account) {
  nlohmann::ordered_json json;
  json["tissue"] = account.tissue.name;
  json["law"] = model::to_string(account.tissue.law);
  json["direction"] = account.direction;
  json["rate_Hz"] = account.rate_Hz;
  json["layers_allowed"] = account.layers_allowed;
  json["results"] = nlohmann::ordered_json::array();
  for (const Answer& answer : account.answers) {
    nlohmann::ordered_json result;
    result[account.by_force ? "requested_force_N" : "requested_depth_mm"] = answer.requested;
    result["force_N"] = answer.state.force;
    result["depth_mm"] = answer.state.depth / kMillimetre;
    result["cutoff_layer"] = answer.state.cutoff_layer;
    result["saturated"] = answer.state.saturated;
    result["extrapolated"] = answer.state.extrapolated;
    result["tangent_stiffness_N_per_m"] = answer.state.stiffness;
    result["layer_deformation_mm"] = layer_deformation_mm(answer.state);
    json["results"].push_back(result);
  }
  std::cout << json_text(json) << '\n';
}

void print_table(const Account& account) {
  constexpr int kDigits = 6;        // --json has all
  constexpr int kNumberWidth = 14;  // a sign, 6 digits, a point, an exponent and a space
  constexpr int kLayerWidth = 7;
  std::cout << account.tissue.name << ", " << model::to_string(account.tissue.law) << " law, "
            << account.direction << " at " << shortest(account.rate_Hz) << " Hz: " << account.layers_allowed
            << " layers allowed\n";
  const auto number = [](const std::string& text) -> std::ostream& {
    return std::cout << std::setw(kNumberWidth) << text;
  };
  number(account.by_force ? "requested N" : "requested mm");
  number("force N");
  number("depth mm");
  number("tangent N/m");
  std::cout << std::setw(kLayerWidth) << "layer"
            << "  deformation of one spring in each layer, mm\n";
  for (const Answer& answer : account.answers) {
    number(brief(answer.requested, kDigits));
    number(brief(answer.state.force, kDigits));
    number(brief(answer.state.depth / kMillimetre, kDigits));
    number(brief(answer.state.stiffness, kDigits));
    std::cout << std::setw(kLayerWidth) << answer.state.cutoff_layer << ' ';
    for (const double deformation : layer_deformation_mm(answer.state))
      std::cout << ' ' << brief(deformation, kDigits);
    std::cout << note(account.tissue, answer.state) << '\n';
  }
}

}  // namespace

void add_model(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ModelFlags>();
  CLI::App* command =
      program.add_subcommand("model", "Evaluate the force law of a tissue: force to depth or depth to force");
  add_law_flags(*command, flags->law);
  CLI::Option_group* wanted = command->add_option_group("requested", "exactly one of these");
  wanted->add_option("--force-N", flags->forces, "forces in newtons, separated by commas");
  wanted->add_option("--depth-mm", flags->depths, "depths in millimetres, separated by commas");
  wanted->require_option(1);
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Example:\n  palpate model --tissue gallbladder --direction press --rate-Hz 1000 --depth-mm 5,10,15\n"
      "  palpate model --tissue heart --direction pull --law smooth --force-N 0.1,0.5\n"
      "Relaxation is not included: these are the forces before the tissue relaxes.");
  command->callback([flags, &exit_code] {
    const Account account = compute(*flags);
    if (flags->as_json) {
      print_json(account);
    } else {
      print_table(account);
    }
    exit_code = kDone;
  });
}

}  // namespace palpate::app

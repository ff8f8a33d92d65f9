#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "study/session/power.h"

namespace palpate::study {
namespace {

constexpr const char* kAssumptions =
    "Assumed: JNDs of 8 to 22 %, lapse rates of 0 to 4 %, effects that differ between people by 10 % (sd of\n"
    "ln JND ratio), people who answer as the fitted functions say, and nobody lost. The observer sr counts "
    "the\n"
    "samples above its threshold; its own noise threshold and the weak force are measured with their "
    "errors.\n"
    "No pooled effect size of touch noise is known for what a hand feels (for posture: Hedges g 0.31 to "
    "0.66), so\n"
    "the effects are assumptions too.\n";

bool of_jnd(const PowerRow& row) { return row.effect.starts_with("jnd"); }

}  // namespace

std::string power_text(const Study& study, const Power& power) {
  std::string text =
      fmt::format("{}: power of the registered analysis, {} simulated groups\n", study.name, power.groups);
  std::string effect;
  for (const PowerRow& row : power.rows) {
    if (row.effect != effect) {
      effect = row.effect;
      text += fmt::format("{}: {}\n  {:>6} {:>15} {:>9} {:>18} {:>12}\n", row.effect, row.analysis, "people",
                          "power", "effect", "width of 95 %", "hours");
    }
    const std::string mean_effect = of_jnd(row) ? fmt::format("x {:.3f}", std::exp(row.mean_effect))
                                                : fmt::format("{:+.2f}", row.mean_effect);
    const std::string width =
        of_jnd(row) ? fmt::format("x/: {:.2f}", std::exp(0.5 * row.width)) : fmt::format("{:.2f}", row.width);
    text += fmt::format("  {:>6} {:>6.2f} +- {:<5.2f} {:>9} {:>18} {:>12.0f}\n", row.participants, row.power,
                        row.error, mean_effect, width, row.participants * power.hours_per_person);
  }
  return text +
         "power: mean and standard error of the simulation. effect: mean estimate; of sr the rise of d'.\n"
         "width: an interval of the JND ratio is the estimate divided and multiplied by this factor.\n"
         "hours: planned time of all sessions of all people.\n" +
         kAssumptions;
}

std::string power_json(const Study& study, const Power& power) {
  using Json = nlohmann::ordered_json;
  Json json = {{"study", study.name},
               {"groups", power.groups},
               {"hours_per_person", power.hours_per_person},
               {"assumptions", kAssumptions},
               {"rows", Json::array()}};
  for (const PowerRow& row : power.rows) {
    json["rows"].push_back({{"effect", row.effect},
                            {"analysis", row.analysis},
                            {"participants", row.participants},
                            {"power", row.power},
                            {"standard_error", row.error},
                            {"mean_effect", row.mean_effect},
                            {"interval_width", row.width}});
  }
  return json.dump(2) + '\n';
}

}  // namespace palpate::study

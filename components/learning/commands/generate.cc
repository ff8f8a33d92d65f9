// `palpate generate`: writes episodes for learning.
#include "learning/environment/generate.h"

#include <iostream>
#include <memory>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "palpate/units.h"

#include "app/commands.h"
#include "app/components.h"
#include "app/numbers.h"
#include "app/output.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/scene_flags.h"
#include "app/session.h"

namespace palpate::app {
namespace {

using learning::GenerateRequest;
using learning::GenerateSummary;

struct GenerateFlags {
  GenerateRequest request;
  std::string task = "press";
  std::string policy = "scripted";
  bool no_cache = false;
  bool as_json = false;
};

/// Parses "LOW:HIGH", or one number for both.
learning::Range parse_range(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.find(':');
  const double low = parse_number(flag, text.substr(0, colon), Numbers::kNotNegative);
  if (colon == std::string::npos) return {low, low};
  return {low, parse_number(flag, text.substr(colon + 1), Numbers::kNotNegative)};
}

void check_generate_files(const GenerateRequest& request) {
  if (request.creates_folder) {
    require_writable_folder(request.out.parent_path(), "--out");
  } else {
    require_regular_file(request.out, "--out");
  }
  const scene::Scene scene = scene::load(learning::with_defaults(request.settings.task, request.scene));
  require_no_overwrite(std::vector<NamedFile>{{"--out", request.out}}, sources_of(scene));
}

int generate_episodes(GenerateFlags& flags) {
  GenerateRequest& request = flags.request;
  request.settings.task = learning::parse_task(flags.task);
  request.policy = learning::parse_policy(flags.policy);
  request.scene.no_noise = true;  // unless --noise-gain-N-m sets it
  const std::unique_ptr<tasks::Communicator> ranks = tasks::make_communicator();
  const OrganPreparation preparation(flags.no_cache);
  request.preparation = preparation.how();
  request.creates_folder = !request.out.has_extension() && !file_exists(request.out);
  if (request.creates_folder || folder_exists(request.out)) request.out /= "episodes.h5";
  tasks::on_rank_zero(*ranks, [&] { check_generate_files(request); });
  GenerateSummary summary;
  {
    Progress bar("generate");
    summary = learning::generate(request, *ranks,
                                 [&bar](double share, const std::string& what) { bar.update(share, what); });
  }
  if (ranks->rank() != 0) return kDone;
  if (flags.as_json) {
    const nlohmann::ordered_json json = {
        {"out", request.out.string()},       {"task", flags.task},     {"policy", flags.policy},
        {"episodes", request.episodes},      {"steps", summary.steps}, {"terminated", summary.terminated},
        {"mean_reward", summary.mean_reward}};
    std::cout << json_text(json) << '\n';
    return kDone;
  }
  const bool search = request.settings.task == learning::Task::kSearch;
  std::cout << fmt::format("{}: {} of {}, {}, mean reward of a step {}{}\n", request.out.string(),
                           counted(request.episodes, "episode", "episodes"), flags.task,
                           counted(summary.steps, "step", "steps"), brief(summary.mean_reward),
                           search ? fmt::format(", {} lumps found", summary.terminated) : std::string());
  return kDone;
}

void add_generate(CLI::App& program, const std::string& /*command_line*/, int& exit_code) {
  auto flags = std::make_shared<GenerateFlags>();
  GenerateRequest& request = flags->request;
  learning::Settings& settings = request.settings;
  CLI::App* command = add_component_command(program, "generate");
  command->add_option(
      "SCENE", request.scene.scene,
      "scene file (.toml); default: a ball of 5 mm over the liver, in insert a needle over a vein");
  command->add_option(
      "--task", flags->task,
      "press (reach a force), hold (on a moving organ), search (a hidden lump) or insert (a needle into a "
      "layer); default press");
  command->add_option("--policy", flags->policy,
                      "scripted (a force controller; in a search a raster of presses and marks) or random (a "
                      "walk); default scripted");
  add_whole(*command, "--episodes", request.episodes, "number of episodes (default 100)");
  add_whole(*command, "--steps", settings.steps, "steps after which an episode is truncated (default 500)");
  add_whole(*command, "--ticks", settings.ticks, "haptic ticks per step (default 10)");
  add_whole(*command, "--seed", request.seed, "seed of all random numbers (default 1)");
  command
      ->add_option("--out", request.out,
                   "file to write, .h5 (HDF5) or .npz (NumPy), or folder, which gets episodes.h5")
      ->required();
  const auto add_range = [command](const char* flag, auto& range, const char* help) {
    command->add_option_function<std::string>(
        flag, [&range, flag](const std::string& text) { range = parse_range(flag, text); }, help);
  };
  add_range("--stiffness-factor", settings.stiffness_factor,
            "LOW:HIGH, drawn for each episode: factor of the tissue's k1 (default 1)");
  add_range("--noise-gain-N-m", settings.noise_gain,
            "LOW:HIGH, drawn for each episode: gain of the touch noise (default: no noise)");
  add_number(*command, "--start-offset-mm", settings.start_offset, Numbers::kNotNegative,
             "largest offset of the start along x and y, drawn for each episode (default 0)", kMillimetre);
  add_number(*command, "--tolerance-mm", settings.tolerance, Numbers::kPositive,
             "in a search: largest horizontal distance of a mark that finds the lump (default 10)",
             kMillimetre);
  add_whole(*command, "--surface-points", settings.surface_points,
            "also observe the displacements of so many points of the surface (default 0)");
  add_organ_and_tool_flags(*command, request.scene);
  command->add_flag("--no-cache", flags->no_cache, kNoCacheHelp);
  add_jobs(*command);
  command->add_flag("--json", flags->as_json, "one JSON document");
  command->footer(
      "Examples:\n"
      "  palpate generate --episodes 200 --out press.npz\n"
      "  palpate generate --task hold --policy random --stiffness-factor 0.5:2 --noise-gain-N-m 0:5e-5 "
      "--out hold.h5\n"
      "  palpate generate scene.toml --episodes 1000 --out episodes\n"
      "  mpirun -n 8 palpate generate --task search --steps 6000 --out search.h5\n"
      "The file has arrays with a row per step (observations, actions, rewards, terminals, timeouts) and "
      "with a\n"
      "row per episode (episode_starts, seeds, parameters, final_observations); the text metadata is JSON "
      "with\n"
      "names, units and the arguments with which palpate.Env replays each seed bit for bit. The same flags "
      "give\n"
      "the same bytes on any number of processes.");
  command->callback([flags, &exit_code] { exit_code = generate_episodes(*flags); });
}

}  // namespace

}  // namespace palpate::app

int main(int argc, char** argv) {
  return palpate::app::run_component_program(argc, argv, palpate::app::add_generate);
}

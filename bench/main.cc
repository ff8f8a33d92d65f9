// The program palpate-bench, which `palpate bench` executes: measures ticks, preparation, many hands, the
// parts of a tick, and installed peers on this machine.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "io/record/machine.h"
#include "io/system/output_file.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/touch_noise.h"

#include "app/components.h"
#include "app/program.h"
#include "app/progress.h"
#include "app/session.h"
#include "bench/measure/account.h"
#include "bench/measure/bench_scene.h"
#include "bench/measure/hands.h"
#include "bench/measure/loop_comparison.h"
#include "bench/measure/peers.h"
#include "bench/measure/pictures.h"
#include "bench/measure/ticks.h"

namespace palpate::bench {
namespace {

constexpr std::size_t kFine = 100'000;      // triangles
constexpr std::size_t kFinest = 1'000'000;  // triangles
constexpr double kPeerSeconds = 4.0;
constexpr double kLoopRate = 10'000.0;  // Hz
constexpr std::size_t kMaxHandsOfOption = 100'000;

/// The measurements selected by flags; without flags all.
struct Plan {
  bool quick = false;
  bool full = false;
  bool ticks = false;
  bool parts = false;
  bool preparation = false;
  bool peers = false;
  bool hand_capacity = false;
  std::size_t hands = 0;
  bool loop = false;
  bool pictures = false;
  haptics::Waiting waiting = haptics::Waiting::kSleep;  // for hands and loop
  bool json = false;
  std::filesystem::path csv;

  void complete() {
    hand_capacity = hand_capacity || hands > 0;
    if (!(ticks || parts || preparation || peers || hand_capacity || loop || pictures)) {
      ticks = parts = preparation = true;
      peers = hand_capacity = !quick;
      loop = pictures = full;
    }
    ticks = ticks || peers;
  }
};

/// A scene to measure; 0 triangles: as built in.
struct Subject {
  std::string task;
  std::size_t organ_triangles = 0;
  std::size_t tool_triangles = 0;
};

std::vector<Subject> subjects_of(const Plan& plan) {
  if (!plan.ticks && !plan.preparation) return {};
  std::vector<Subject> subjects;
  for (const std::size_t organ : {std::size_t{0}, kFine, kFinest}) {
    if ((organ > 0 && plan.quick) || (organ == kFinest && !plan.full)) continue;
    for (const char* task : {"press", "pull"}) subjects.push_back({task, organ, 0});
  }
  if (plan.ticks && !plan.quick) subjects.push_back({"press", 0, kFine});
  return subjects;
}

std::vector<Subject> pictures_of(const Plan& plan) {
  if (!plan.pictures) return {};
  return {{"press", 0, 0}, {"pull", 0, 0}, {"press", kFine, 0}, {"press", kFinest, 0}};
}

/// Runs the measurements of a plan one after the other.
class Bench final {
 public:
  Bench(Plan plan, std::string command_line)
      : plan_(std::move(plan)), subjects_(subjects_of(plan_)), pictures_(pictures_of(plan_)) {
    account_.machine = record::machine_description();
    account_.build = "palpate " + record::palpate_version() + ", " + record::compiler_version();
    account_.command = std::move(command_line);
    account_.polled = plan_.waiting == haptics::Waiting::kPoll;
    steps_ = static_cast<double>(subjects_.size()) + (plan_.hand_capacity ? 2.0 : 0.0) +
             (plan_.loop ? 2.0 : 0.0) + static_cast<double>(pictures_.size()) + 1.0;
  }

  Account run() {
    account_.clock_ns = clock_cost_ns();
    if (plan_.peers) {
      peers_.emplace(peers_library());
      account_.remarks = peers_->missing();
    }
    for (const Subject& subject : subjects_) measure(subject);
    if (plan_.parts) measure_parts();
    if (plan_.hand_capacity) measure_hands();
    if (plan_.loop) {
      for (const char* task : {"press", "pull"}) measure_loop(task);
    }
    for (const Subject& subject : pictures_) measure_pictures(subject);
    return std::move(account_);
  }

 private:
  /// Shows the progress `share` of the current step.
  void show(double share, const std::string& what) { bar_.update((done_ + share) / steps_, what); }

  void measure(const Subject& subject) {
    show(0.0, "preparing the " + subject.task + " scene");
    const scene::Scene scene =
        bench::bench_scene(subject.task, subject.organ_triangles, subject.tool_triangles);
    const Prepared prepared = prepare(scene);
    const std::string name = scene.name + ", " + std::to_string(scene.organ.triangles.size()) + " triangles";
    if (plan_.preparation && subject.tool_triangles == 0) account_.preparation.push_back(prepared.account);
    if (plan_.ticks) {
      const scene::ToolPath path = hand_path(scene);
      show(0.3, "ticks of " + name);
      account_.ticks.push_back(time_ticks(scene, prepared.world, path, plan_.quick ? 3 : 5));
      if (subject.tool_triangles == 0) {
        const std::vector<PathPoint> way = run_path(scene, prepared.world, path);
        account_.nearest.push_back(time_nearest(scene, way));
        if (plan_.peers) ask_peers(scene, way, name);
      }
    }
    done_ += 1.0;
  }

  void ask_peers(const scene::Scene& scene, const std::vector<PathPoint>& way, const std::string& name) {
    const auto ratio = [](double theirs, double own) { return own > 0.0 ? theirs / own : 0.0; };
    const TickAccount& tick = account_.ticks.back();
    const double nearest_us = account_.nearest.back().times.p50_us;
    for (const PalpatePeer& peer : peers_->all()) {
      show(0.6, std::string(peer.name) + " on " + name);
      PeerAccount theirs = measure_peer(peer, {scene, way, kPeerSeconds});
      const bool point = peer.one_point != 0;
      theirs.ratio = ratio(theirs.contact.p50_us, point ? nearest_us : tick.contact.p50_us);
      theirs.approach_ratio = ratio(theirs.approach.p50_us, point ? nearest_us : tick.approach.p50_us);
      account_.peers.push_back(std::move(theirs));
    }
  }

  void measure_parts() {
    show(0.0, "law and noise");
    const model::LayeredSpringLaw law(model::tissue_preset("gallbladder"), model::Direction::kPress, 1e-3);
    constexpr double kDeepest = 20e-3;  // m, in the fourth layer
    constexpr double kSpread = 1e-4;    // step that spreads ten thousand calls over all depths
    const double largest = law.force_at(kDeepest).force;
    account_.law_ns = median_call_ns(
        [&](std::uint64_t i) { return law.force_at(kDeepest * kSpread * static_cast<double>(i)).force; });
    account_.inverse_ns = median_call_ns([&](std::uint64_t i) {
      return law.deformation_under(largest * kSpread * static_cast<double>(i)).depth;
    });
    account_.noise_ns = median_call_ns([](std::uint64_t i) { return noise::unit_sample(1, 0, i); });
    done_ += 1.0;
  }

  void measure_hands() {
    const scene::Scene scene = bench_scene("press", 0, 0);
    const Prepared prepared = prepare(scene);
    const scene::ToolPath path = hand_path(scene);
    account_.hands =
        hand_capacity(scene, prepared.world, path, plan_.waiting,
                      [this](double share, const std::string& what) { show(1.5 * share, what); });
    if (plan_.hands > 0) {
      show(1.5, std::to_string(plan_.hands) + " hands");
      account_.hands->asked = run_hands(scene, prepared.world, path, plan_.waiting, plan_.hands);
    }
    done_ += 2.0;
  }

  void measure_loop(const std::string& task) {
    scene::Overrides request;
    request.task = task;
    request.rate_Hz = kLoopRate;
    const scene::Scene scene = scene::load(request);
    const Prepared prepared = prepare(scene);
    account_.loops.push_back(
        compare_with_empty_loop(scene, prepared.world, scene::default_path(scene, 0), plan_.waiting,
                                [this](double share, const std::string& what) { show(share, what); }));
    done_ += 1.0;
  }

  void measure_pictures(const Subject& subject) {
    show(0.0, "pictures of the " + subject.task + " scene");
    try {
      for (const render::Quality quality : {render::Quality::kBalanced, render::Quality::kFast})
        account_.pictures.push_back(time_pictures(subject.task, subject.organ_triangles, quality));
    } catch (const std::runtime_error& error) {
      account_.remarks.emplace_back(error.what());
    }
    done_ += 1.0;
  }

  Plan plan_;
  std::vector<Subject> subjects_;
  std::vector<Subject> pictures_;
  Account account_;
  std::optional<Peers> peers_;
  app::Progress bar_{"bench", app::WithoutTerminal::kSteps};
  double steps_ = 1.0;
  double done_ = 0.0;
};

void add_flags(CLI::App& command, Plan& flags) {
  auto* quick = command.add_flag("--quick", flags.quick, "the built-in scenes and the parts only: seconds");
  command.add_flag("--full", flags.full, "also organs of a million triangles and the 10 kHz loop: minutes")
      ->excludes(quick);
  command.add_flag("--ticks", flags.ticks, "only whole ticks (several of these options add up)");
  command.add_flag("--parts", flags.parts, "only the law both ways and the noise");
  command.add_flag("--preparation", flags.preparation, "only what is done before the first tick");
  command
      .add_option(
          "--hands", flags.hands,
          "only hands: how many each core carries inside 80 % of a 1 ms period in 99.9 % of 10,000 "
          "periods, all cores at once (found by halving: a minute or two), and N of them on all cores")
      ->check(CLI::Range(std::size_t{1}, kMaxHandsOfOption))
      ->type_name("N");
  command.add_flag_callback(
      "--poll", [&flags] { flags.waiting = haptics::Waiting::kPoll; },
      "with hands and the 10 kHz loop: their threads keep asking for the time between periods, as "
      "`palpate run --poll`; else they sleep");
  command.add_flag("--peers", flags.peers, "only ticks beside other libraries: Bullet, FCL, Embree");
  command.add_flag("--loop", flags.loop, "only the 10 kHz loop against an empty one");
  command.add_flag("--pictures", flags.pictures,
                   "only moving pictures: deformation and whole frames, organs to a million triangles");
  command.add_flag("--json", flags.json, "one JSON document");
  command.add_option("--csv", flags.csv, "also write every figure to this file");
  command.footer(
      "Example:\n  palpate bench --json > bench.json\n  palpate bench --hands 150 --poll\n"
      "  palpate bench --full --csv bench.csv");
}

/// [setup] Runs the selected measurements, writes the CSV file and prints the account. @throws InputError
/// when the file cannot be written, before anything is measured.
void run(Plan plan, std::string command_line) {
  plan.complete();
  if (!plan.csv.empty()) app::require_writable_file(plan.csv, "--csv");
  const Account account = Bench(plan, std::move(command_line)).run();
  if (!plan.csv.empty()) write_output(plan.csv, to_csv(account), "--csv");
  std::cout << (plan.json ? to_json(account) : to_text(account));
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  using namespace palpate;
  return app::run_program(argc, argv,
                          [](CLI::App& program, const std::string& command_line, int& /*exit_code*/) {
                            CLI::App* command = app::add_component_command(program, "bench");
                            const auto plan = std::make_shared<bench::Plan>();
                            bench::add_flags(*command, *plan);
                            command->callback([plan, command_line] { bench::run(*plan, command_line); });
                          });
}

#include "learning/environment/generate.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/record/scene_json.h"
#include "palpate/error.h"
#include "palpate/version.h"
#include "run/tasks/for_each_task.h"

#include "learning/environment/episode_file.h"

namespace palpate::learning {
namespace {

using Json = nlohmann::ordered_json;

enum Column : std::size_t {
  kObservations,
  kActions,
  kRewards,
  kTerminals,
  kTimeouts,
  kFinalObservations,
  kSeeds,
  kParameters,
  kColumns,
  kEpisodeStarts = kColumns,  // known only when the episodes are in order
};

/// The rows of one episode, as the bytes of each array.
using Episode = std::array<std::string, kColumns>;

template <typename Value>
void add_bytes(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void add_numbers(std::string& bytes, std::span<const double> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

std::string packed(const Episode& episode) {
  std::string bytes;
  for (const std::string& column : episode) {
    add_bytes(bytes, std::uint64_t{column.size()});
    bytes += column;
  }
  return bytes;
}

Episode unpacked(const std::string& bytes) {
  Episode episode;
  std::size_t at = 0;
  for (std::string& column : episode) {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + at, sizeof size);
    column = bytes.substr(at + sizeof size, size);
    at += sizeof size + size;
  }
  return episode;
}

/// Seed of an episode, below 2^53: any reader's numbers hold it.
std::uint64_t seed_of(std::uint64_t seed, std::uint64_t episode) {
  constexpr std::uint32_t kSeedPart = 2;  // of the random numbers
  return Random(seed, static_cast<std::uint32_t>(episode), kSeedPart).below(std::size_t{1} << 53U);
}

Episode run_episode(Environment& environment, PolicyKind kind, std::uint64_t seed) {
  Episode episode;
  StepResult last = environment.reset(seed);
  add_bytes(episode[kSeeds], static_cast<std::int64_t>(seed));
  add_numbers(episode[kParameters], environment.parameters());
  const std::unique_ptr<Policy> policy = make_policy(kind, environment, seed);
  std::vector<double> action(environment.action_channels().size());
  while (!last.terminated && !last.truncated) {
    policy->act(last, action);
    add_numbers(episode[kObservations], environment.observation());
    add_numbers(episode[kActions], action);
    last = environment.step(action);
    add_bytes(episode[kRewards], last.reward);
    add_bytes(episode[kTerminals], last.terminated);
    add_bytes(episode[kTimeouts], last.truncated);
  }
  add_numbers(episode[kFinalObservations], environment.observation());
  return episode;
}

std::vector<ArraySpec> specs_of(const Environment& environment) {
  const std::size_t seen = environment.observation_channels().size();
  return {{"observations", Element::kNumber, seen},
          {"actions", Element::kNumber, environment.action_channels().size()},
          {"rewards"},
          {"terminals", Element::kTruth},
          {"timeouts", Element::kTruth},
          {"final_observations", Element::kNumber, seen},
          {"seeds", Element::kWhole},
          {"parameters", Element::kNumber, environment.parameter_channels().size()},
          {"episode_starts", Element::kWhole}};
}

Json channels_json(std::span<const Channel> channels) {
  Json json = {{"names", Json::array()}, {"units", Json::array()}};
  for (const Channel& channel : channels) {
    json["names"].push_back(channel.name);
    json["units"].push_back(channel.unit);
  }
  return json;
}

/// The arguments with which palpate.Env makes this environment again.
Json arguments_json(const scene::Overrides& scene, const Environment& environment) {
  const Settings& settings = environment.settings();
  const auto pair = [](const Range& range) { return Json::array({range.low, range.high}); };
  Json json = {
      {"task", to_string(settings.task)},
      {"seconds", static_cast<double>(settings.steps * settings.ticks) / environment.scene().rate_Hz},
      {"ticks", settings.ticks},
      {"tolerance", settings.tolerance},
      {"surface_points", settings.surface_points},
      {"stiffness_factor", pair(settings.stiffness_factor)},
      {"start_offset", settings.start_offset}};
  if (settings.noise_gain) json["noise_gain"] = pair(*settings.noise_gain);
  const auto add = [&json](const char* name, const auto& value) {
    if (value) json[name] = *value;
  };
  const auto add_list = [&json](const char* name, const std::vector<std::string>& values) {
    if (!values.empty()) json[name] = values;
  };
  if (scene.scene) json["scene"] = scene.scene->string();
  add("organ", scene.organ);
  add("organ_unit", scene.organ_unit);
  add("tissue", scene.tissue);
  add("tool_unit", scene.tool_unit);
  add("rate_Hz", scene.rate_Hz);
  add_list("organ_motion", scene.organ_motion);
  add_list("inclusions", scene.inclusions);
  if (scene.inclusions == std::vector<std::string>{"none"}) json["inclusions"] = Json::array();
  add_list("tool", scene.tools);
  return json;
}

std::string metadata_of(const GenerateRequest& request, const Environment& environment) {
  const Json json = {{"palpate_version", kVersion},
                     {"policy", to_string(request.policy)},
                     {"seed", request.seed},
                     {"arguments", arguments_json(request.scene, environment)},
                     {"observations", channels_json(environment.observation_channels())},
                     {"actions", channels_json(environment.action_channels())},
                     {"parameters", channels_json(environment.parameter_channels())},
                     {"scene", Json::parse(record::scene_to_json(environment.scene()))}};  // its own JSON
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// Bytes of a longest episode, roughly.
std::uint64_t largest_episode(const Settings& settings) {
  constexpr std::uint64_t kNumbers = 16;  // observation, action, reward, and the two truths
  return 8 * (settings.steps + 1) * (kNumbers + settings.surface_points);
}

void check(const GenerateRequest& request) {
  constexpr std::uint64_t kMaxEpisodes = 10'000'000;
  if (request.episodes < 1 || request.episodes > kMaxEpisodes) {
    throw InputError(fmt::format("episodes = {}: must be 1 to {}", request.episodes, kMaxEpisodes));
  }
  if (!EpisodeFile::is_npz(request.out)) return;
  const std::uint64_t most = EpisodeFile::kMaxNpzBytes / 2 / largest_episode(request.settings);
  if (request.episodes > most) {
    throw InputError(
        fmt::format("{}: may get more than the 4 GiB of an .npz file: write a .h5 file, or at most "
                    "{} episodes of these steps",
                    request.out.string(), most));
  }
}

/// Rank 0's part: appends episodes in order.
class Output final {
 public:
  Output(const GenerateRequest& request, const Environment& environment)
      : file_(request.out, specs_of(environment)), metadata_(metadata_of(request, environment)) {}

  void append(const Episode& episode) {
    std::string start;
    add_bytes(start, static_cast<std::int64_t>(summary_.steps));
    file_.append(kEpisodeStarts, start);
    for (std::size_t i = 0; i < kColumns; ++i) file_.append(i, episode[i]);
    std::vector<double> rewards(episode[kRewards].size() / sizeof(double));
    std::memcpy(rewards.data(), episode[kRewards].data(), episode[kRewards].size());
    for (const double reward : rewards) sum_ += reward;
    summary_.steps += rewards.size();
    summary_.terminated += episode[kTerminals].back() != 0 ? 1 : 0;
  }

  [[nodiscard]] GenerateSummary finish() {
    file_.finish(metadata_);
    summary_.mean_reward = sum_ / static_cast<double>(summary_.steps);
    return summary_;
  }

 private:
  EpisodeFile file_;
  std::string metadata_;
  GenerateSummary summary_;
  double sum_ = 0.0;
};

/// Environments of one request: as many as threads run episodes at once. An episode does not depend on those
/// before it in its environment.
class Environments final {
 public:
  explicit Environments(const GenerateRequest& request) : request_(request) {}

  [[nodiscard]] std::unique_ptr<Environment> take() {
    const std::lock_guard lock(mutex_);  // also while the organ is prepared
    if (!idle_.empty()) {
      std::unique_ptr<Environment> one = std::move(idle_.back());
      idle_.pop_back();
      return one;
    }
    if (!model_) {
      const scene::Overrides scene = with_defaults(request_.settings.task, request_.scene);
      model_ = std::make_unique<Environment>(scene::load(scene), request_.settings, request_.preparation);
    }
    return std::make_unique<Environment>(model_->another());
  }

  void give_back(std::unique_ptr<Environment> one) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(one));
  }

 private:
  const GenerateRequest& request_;
  std::mutex mutex_;
  std::unique_ptr<Environment> model_;  // its organ is everyone's
  std::vector<std::unique_ptr<Environment>> idle_;
};

}  // namespace

GenerateSummary generate(const GenerateRequest& request, tasks::Communicator& ranks,
                         const Progress& progress) {
  constexpr std::uint64_t kBatch = 64U << 20U;  // bytes of episodes that are in memory at a time
  Environments environments(request);
  std::optional<Output> output;
  tasks::on_rank_zero(ranks, [&] {
    check(request);
    std::unique_ptr<Environment> environment = environments.take();
    std::error_code error;  // of a folder: opening the file reports it
    if (request.creates_folder) std::filesystem::create_directories(request.out.parent_path(), error);
    output.emplace(request, *environment);
    environments.give_back(std::move(environment));
  });
  const std::uint64_t batch = std::clamp<std::uint64_t>(kBatch / largest_episode(request.settings), 1, 1000);
  GenerateSummary summary;
  for (std::uint64_t first = 0; first < request.episodes; first += batch) {
    tasks::Tasks work;
    work.count = std::min(batch, request.episodes - first);
    work.on_threads = true;
    work.run = [&](std::size_t i) {
      std::unique_ptr<Environment> environment = environments.take();
      std::string result =
          packed(run_episode(*environment, request.policy, seed_of(request.seed, first + i)));
      environments.give_back(std::move(environment));
      return result;
    };
    std::uint64_t done = first;
    work.done = [&](std::size_t) {
      ++done;
      progress(static_cast<double>(done) / static_cast<double>(request.episodes),
               fmt::format("{} of {} episodes", done, request.episodes));
    };
    const std::vector<std::string> results = tasks::for_each_task(&ranks, work).results;
    tasks::on_rank_zero(ranks, [&] {
      for (const std::string& result : results) output->append(unpacked(result));
    });
  }
  tasks::on_rank_zero(ranks, [&] { summary = output->finish(); });
  return summary;
}

}  // namespace palpate::learning

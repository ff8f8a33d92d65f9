// Environments for learning. palpate/env.py gives them Gymnasium's form.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/error.h"

#include "bindings/c/float_environment.h"
#include "bindings/python/binding.h"
#include "bindings/python/on_threads.h"
#include "bindings/python/scene_arguments.h"
#include "learning/environment/environment.h"

namespace palpate::python {
namespace {

using learning::Channel;
using learning::Environment;
using learning::StepResult;
using Pair = std::pair<double, double>;

/// Serializes all calls, so that several Python threads may use one environment.
class SharedEnvironment final {
 public:
  explicit SharedEnvironment(Environment environment) : environment_(std::move(environment)) {}

  [[nodiscard]] const Environment& get() const noexcept { return environment_; }

  /// Calls `use` without Python's lock. @return the result and the observation after it
  template <typename Use>
  std::pair<StepResult, std::vector<double>> with(const Use& use) {
    const py::gil_scoped_release others_may_run;
    const std::lock_guard lock(mutex_);
    const c_interface::DefaultFloatEnvironment environment;
    const StepResult result = use(environment_);
    return {result, {environment_.observation().begin(), environment_.observation().end()}};
  }

 private:
  std::mutex mutex_;
  Environment environment_;
};

/// Settings of an environment as Python gives them.
struct SettingArguments {
  std::string task;
  double seconds;
  std::uint64_t ticks;
  double tolerance;
  std::uint64_t surface_points;
  Pair stiffness;
  std::optional<Pair> noise;
  double offset;
  bool cache;
};

Environment make_environment(SceneArguments arguments, const SettingArguments& given) {
  learning::Settings settings;
  settings.task = learning::parse_task(given.task);
  settings.ticks = given.ticks;
  settings.tolerance = given.tolerance;
  settings.surface_points = given.surface_points;
  settings.stiffness_factor = {given.stiffness.first, given.stiffness.second};
  if (given.noise) settings.noise_gain = {given.noise->first, given.noise->second};
  settings.start_offset = given.offset;
  arguments.request = learning::with_defaults(settings.task, std::move(arguments.request));
  scene::Scene scene = arguments.load(given.cache);
  const double steps = std::round(given.seconds * scene.rate_Hz /
                                  static_cast<double>(std::max<std::uint64_t>(given.ticks, 1)));
  if (!(steps >= 1.0 && steps <= 1e6)) throw ParameterError("seconds", given.seconds, "1 to 1000000 steps");
  settings.steps = static_cast<std::uint64_t>(steps);
  return Environment(std::move(scene), settings, preparation_of(given.cache));
}

std::unique_ptr<SharedEnvironment> open_environment(SceneArguments arguments, const std::string& task,
                                                    double seconds, std::uint64_t ticks, double tolerance,
                                                    std::uint64_t surface_points, const Pair& stiffness,
                                                    const std::optional<Pair>& noise, double offset,
                                                    bool cache) {
  const py::gil_scoped_release others_may_run;
  return std::make_unique<SharedEnvironment>(
      make_environment(std::move(arguments),
                       {task, seconds, ticks, tolerance, surface_points, stiffness, noise, offset, cache}));
}

/// A space as plain data.
py::dict space_of(std::span<const Channel> channels) {
  std::vector<std::string> names, units;
  std::vector<double> low, high;
  for (const Channel& channel : channels) {
    names.push_back(channel.name);
    units.push_back(channel.unit);
    low.push_back(channel.low);
    high.push_back(channel.high);
  }
  py::dict space;
  space["names"] = names;
  space["units"] = units;
  space["low"] = array_of(low);
  space["high"] = array_of(high);
  space["shape"] = py::make_tuple(channels.size());
  space["dtype"] = "float64";
  return space;
}

py::dict info_of_step(const StepResult& result) {
  py::dict info;
  info["tissue_force"] = result.tissue_force;
  info["tick"] = result.tick;
  info["fault"] = result.fault;
  return info;
}

py::tuple reset_environment(SharedEnvironment& shared, std::optional<std::uint64_t> seed) {
  const auto [result, seen] = shared.with([seed](Environment& own) { return own.reset(seed); });
  return py::make_tuple(array_of(seen), info_of_step(result));
}

py::tuple step_environment(SharedEnvironment& shared, const Numbers& action) {
  const std::span<const double> values(action.data(), static_cast<std::size_t>(action.size()));
  const auto [result, seen] = shared.with([values](Environment& own) { return own.step(values); });
  return py::make_tuple(array_of(seen), result.reward, result.terminated, result.truncated,
                        info_of_step(result));
}

py::dict drawn_parameters(const SharedEnvironment& shared) {
  py::dict values;
  const Environment& own = shared.get();
  for (std::size_t i = 0; i < own.parameters().size(); ++i)
    values[own.parameter_channels()[i].name.c_str()] = own.parameters()[i];
  return values;
}

/// Environments that share one organ and step at once. Serializes all calls.
class VectorEnvironment final {
 public:
  VectorEnvironment(Environment first, std::size_t count, std::optional<std::size_t> jobs)
      : threads_(threads_for(jobs, count)) {
    environments_.push_back(std::move(first));
    while (environments_.size() < count) environments_.push_back(environments_.front().another());
  }

  [[nodiscard]] const Environment& first() const noexcept { return environments_.front(); }

  /// Starts an episode in every environment; number i gets seed + i. @return observations, info
  py::tuple reset(std::optional<std::uint64_t> seed) {
    const Arrays arrays(environments_.size(), observation_size());
    const Out out(arrays);
    {
      const py::gil_scoped_release others_may_run;
      run([&](std::size_t i) {
        const StepResult result = environments_[i].reset(seed ? std::optional(*seed + i) : std::nullopt);
        out.put(i, result, environments_[i].observation());
      });
    }
    return py::make_tuple(arrays.seen, arrays.info());
  }

  /// A step in every environment; an episode that ends is followed by the next one's start. @return
  /// observations, rewards, terminated, truncated, info
  py::tuple step(const Numbers& actions) {
    check(actions);
    const Arrays arrays(environments_.size(), observation_size());
    const Out out(arrays);
    Numbers last(std::vector<py::ssize_t>{arrays.seen.shape(0), arrays.seen.shape(1)});
    double* last_seen = last.mutable_data();
    const double* from = actions.data();
    const std::size_t size = first().action_channels().size();
    {
      const py::gil_scoped_release others_may_run;
      run([&](std::size_t i) {
        Environment& own = environments_[i];
        const StepResult result = own.step({from + i * size, size});
        out.put(i, result, own.observation());
        std::copy(own.observation().begin(), own.observation().end(),
                  last_seen + i * own.observation().size());
        if (!result.terminated && !result.truncated) return;
        (void)own.reset(std::nullopt);
        out.put_observation(i, own.observation());
      });
    }
    py::dict info = arrays.info();
    info["final_observation"] = last;
    return py::make_tuple(arrays.seen, arrays.reward, arrays.terminated, arrays.truncated, info);
  }

  /// What each environment's episode drew, by name.
  py::dict parameters() const {
    py::dict all;
    for (std::size_t i = 0; i < first().parameter_channels().size(); ++i) {
      py::array_t<double> values(static_cast<py::ssize_t>(environments_.size()));
      double* to = values.mutable_data();
      for (const Environment& one : environments_) {
        *to++ = i < one.parameters().size() ? one.parameters()[i] : std::numeric_limits<double>::quiet_NaN();
      }
      all[first().parameter_channels()[i].name.c_str()] = values;
    }
    return all;
  }

 private:
  /// Results of all environments.
  struct Arrays {
    Arrays(std::size_t count, std::size_t size)
        : seen({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(size)}),
          reward(static_cast<py::ssize_t>(count)),
          tissue_force(reward.size()),
          terminated(reward.size()),
          truncated(reward.size()),
          tick(reward.size()),
          fault(reward.size()) {}

    [[nodiscard]] py::dict info() const {
      py::dict values;
      values["tissue_force"] = tissue_force;
      values["tick"] = tick;
      values["fault"] = fault;
      return values;
    }

    py::array_t<double> seen, reward, tissue_force;
    py::array_t<bool> terminated, truncated;
    py::array_t<std::uint64_t> tick;
    py::array_t<std::uint32_t> fault;
  };

  /// Where to write them without Python's lock.
  struct Out {
    explicit Out(Arrays arrays)
        : size(static_cast<std::size_t>(arrays.seen.shape(1))),
          seen(arrays.seen.mutable_data()),
          reward(arrays.reward.mutable_data()),
          tissue_force(arrays.tissue_force.mutable_data()),
          terminated(arrays.terminated.mutable_data()),
          truncated(arrays.truncated.mutable_data()),
          tick(arrays.tick.mutable_data()),
          fault(arrays.fault.mutable_data()) {}

    void put_observation(std::size_t i, std::span<const double> observation) const {
      std::copy(observation.begin(), observation.end(), seen + i * size);
    }
    void put(std::size_t i, const StepResult& result, std::span<const double> observation) const {
      put_observation(i, observation);
      reward[i] = result.reward;
      tissue_force[i] = result.tissue_force;
      terminated[i] = result.terminated;
      truncated[i] = result.truncated;
      tick[i] = result.tick;
      fault[i] = result.fault;
    }

    std::size_t size;
    double *seen, *reward, *tissue_force;
    bool *terminated, *truncated;
    std::uint64_t* tick;
    std::uint32_t* fault;
  };

  [[nodiscard]] std::size_t observation_size() const noexcept {
    return first().observation_channels().size();
  }

  template <typename Act>
  void run(const Act& act) {
    const std::lock_guard lock(mutex_);
    on_threads(threads_, environments_.size(), [&](std::size_t, std::size_t i) { act(i); });
  }

  /// @throws InputError before any environment steps
  void check(const Numbers& actions) const {
    const auto size = static_cast<py::ssize_t>(first().action_channels().size());
    const auto count = static_cast<py::ssize_t>(environments_.size());
    if (actions.ndim() != 2 || actions.shape(0) != count || actions.shape(1) != size) {
      throw InputError(fmt::format("actions: must have shape ({}, {})", count, size));
    }
    for (py::ssize_t i = 0; i < actions.size(); ++i) {
      const double value = actions.data()[i];
      if (std::isfinite(value)) continue;
      throw InputError(
          fmt::format("actions[{}, {}] = {}: must be finite", i / size, i % size, shortest(value)));
    }
  }

  std::mutex mutex_;
  std::size_t threads_;
  std::vector<Environment> environments_;
};

std::unique_ptr<VectorEnvironment> open_environments(SceneArguments arguments, const std::string& task,
                                                     double seconds, std::uint64_t ticks, double tolerance,
                                                     std::uint64_t surface_points, const Pair& stiffness,
                                                     const std::optional<Pair>& noise, double offset,
                                                     bool cache, std::size_t count,
                                                     std::optional<std::size_t> jobs) {
  constexpr std::size_t kMost = 100'000;
  if (count < 1 || count > kMost) {
    throw InputError(fmt::format("num_envs = {}: must be 1 to {}", count, kMost));
  }
  const py::gil_scoped_release others_may_run;
  return std::make_unique<VectorEnvironment>(
      make_environment(std::move(arguments),
                       {task, seconds, ticks, tolerance, surface_points, stiffness, noise, offset, cache}),
      count, jobs);
}

}  // namespace

}  // namespace palpate::python

PYBIND11_MODULE(_learning, module) {
  using namespace palpate::python;
  namespace py = pybind11;
  const auto settings =
      std::make_tuple(py::arg("learning_task"), py::arg("seconds"), py::arg("ticks"), py::arg("tolerance"),
                      py::arg("surface_points"), py::arg("stiffness_factor"), py::arg("noise_gain"),
                      py::arg("start_offset"), py::arg("cache") = true);
  py::class_<SharedEnvironment> environment(module, "_Environment");
  py::class_<VectorEnvironment> environments(module, "_VectorEnvironment");
  std::apply(
      [&](const auto&... arguments) {
        environment.def(py::init(of_a_scene<std::string, double, std::uint64_t, double, std::uint64_t, Pair,
                                            std::optional<Pair>, double, bool>(&open_environment)),
                        arguments...);
        environments.def(
            py::init(of_a_scene<std::string, double, std::uint64_t, double, std::uint64_t, Pair,
                                std::optional<Pair>, double, bool, std::size_t, std::optional<std::size_t>>(
                &open_environments)),
            arguments..., py::arg("num_envs"), py::arg("jobs"));
      },
      std::tuple_cat(scene_arguments(), settings));
  environment.def("reset", &reset_environment, py::arg("seed"))
      .def("step", &step_environment, py::arg("action"))
      .def_property_readonly("parameters", &drawn_parameters)
      .def_property_readonly(
          "action_space", [](const SharedEnvironment& own) { return space_of(own.get().action_channels()); })
      .def_property_readonly("observation_space", [](const SharedEnvironment& own) {
        return space_of(own.get().observation_channels());
      });
  environments.def("reset", &VectorEnvironment::reset, py::arg("seed"))
      .def("step", &VectorEnvironment::step, py::arg("actions"))
      .def_property_readonly("parameters", &VectorEnvironment::parameters)
      .def_property_readonly(
          "action_space",
          [](const VectorEnvironment& own) { return space_of(own.first().action_channels()); })
      .def_property_readonly("observation_space", [](const VectorEnvironment& own) {
        return space_of(own.first().observation_channels());
      });
}

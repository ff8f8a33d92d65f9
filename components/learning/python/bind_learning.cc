// Environments for learning. palpate/env.py gives them Gymnasium's form.
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"

#include "bindings/c/float_environment.h"
#include "bindings/python/binding.h"
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
  SharedEnvironment(scene::Scene scene, const learning::Settings& settings, const contact::Preparation& how)
      : environment_(std::move(scene), settings, how) {}

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

std::unique_ptr<SharedEnvironment> open_environment(SceneArguments arguments, const std::string& task,
                                                    double seconds, std::uint64_t ticks, double tolerance,
                                                    std::uint64_t surface_points, const Pair& stiffness,
                                                    const std::optional<Pair>& noise, double offset,
                                                    bool cache) {
  const py::gil_scoped_release others_may_run;
  learning::Settings settings;
  settings.task = learning::parse_task(task);
  settings.ticks = ticks;
  settings.tolerance = tolerance;
  settings.surface_points = surface_points;
  settings.stiffness_factor = {stiffness.first, stiffness.second};
  if (noise) settings.noise_gain = {noise->first, noise->second};
  settings.start_offset = offset;
  arguments.request = learning::with_defaults(settings.task, std::move(arguments.request));
  scene::Scene scene = arguments.load();
  const double steps =
      std::round(seconds * scene.rate_Hz / static_cast<double>(std::max<std::uint64_t>(ticks, 1)));
  if (!(steps >= 1.0 && steps <= 1e6)) throw ParameterError("seconds", seconds, "1 to 1000000 steps");
  settings.steps = static_cast<std::uint64_t>(steps);
  return std::make_unique<SharedEnvironment>(std::move(scene), settings, preparation_of(cache));
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

}  // namespace

}  // namespace palpate::python

PYBIND11_MODULE(_learning, module) {
  using namespace palpate::python;
  namespace py = pybind11;
  py::class_<SharedEnvironment> environment(module, "_Environment");
  std::apply(
      [&](const auto&... scene) {
        environment.def(py::init(of_a_scene<std::string, double, std::uint64_t, double, std::uint64_t, Pair,
                                            std::optional<Pair>, double, bool>(&open_environment)),
                        scene..., py::arg("learning_task"), py::arg("seconds"), py::arg("ticks"),
                        py::arg("tolerance"), py::arg("surface_points"), py::arg("stiffness_factor"),
                        py::arg("noise_gain"), py::arg("start_offset"), py::arg("cache") = true);
      },
      scene_arguments());
  environment.def("reset", &reset_environment, py::arg("seed"))
      .def("step", &step_environment, py::arg("action"))
      .def_property_readonly("parameters", &drawn_parameters)
      .def_property_readonly(
          "action_space", [](const SharedEnvironment& own) { return space_of(own.get().action_channels()); })
      .def_property_readonly("observation_space", [](const SharedEnvironment& own) {
        return space_of(own.get().observation_channels());
      });
}

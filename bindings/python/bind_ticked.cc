// A simulation that Python itself ticks, with samples of its own: the C interface's, as arrays.
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"

#include "bindings/c/palpate.h"
#include "bindings/c/simulation.h"
#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using Samples = py::array_t<palpate_sample, py::array::c_style | py::array::forcecast>;

/// One tick or one look at a time, whatever threads Python has.
class TickedSimulation final {
 public:
  TickedSimulation(const SceneArguments& arguments, const palpate_options& options, bool cache)
      : simulation_(std::make_unique<palpate_simulation>(
            c_interface::load(arguments.load(), preparation_of(cache), options.no_hand != 0), options)) {}
  ~TickedSimulation() = default;
  TickedSimulation(const TickedSimulation&) = delete;
  TickedSimulation& operator=(const TickedSimulation&) = delete;

  /// Runs `use` on the simulation. @throws std::logic_error when it is closed.
  template <typename Use>
  auto with(const Use& use) {
    const std::lock_guard lock(mutex_);
    if (!simulation_) throw std::logic_error("the simulation is closed");
    return use(*simulation_);
  }

  void close() {
    const std::lock_guard lock(mutex_);
    const std::unique_ptr<palpate_simulation> owned = std::move(simulation_);
    if (owned) owned->finish_recording();
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<palpate_simulation> simulation_;
};

std::unique_ptr<TickedSimulation> ticked_open(const SceneArguments& arguments,
                                              const std::optional<fs::path>& record, bool record_waits,
                                              bool no_hand, double surface_edge, bool cache) {
  const py::gil_scoped_release others_may_run;
  check_surface_edge(surface_edge);
  const std::string file = record ? record->string() : std::string();
  palpate_options options{};
  options.struct_size = sizeof options;
  options.record_file = record ? file.c_str() : nullptr;
  options.record_waits = record_waits ? 1 : 0;
  options.no_hand = no_hand ? 1 : 0;
  options.surface_edge = surface_edge;
  return std::make_unique<TickedSimulation>(arguments, options, cache);
}

palpate_info info_of(TickedSimulation& ticked) {
  return ticked.with([](palpate_simulation& simulation) { return simulation.info(); });
}

/// One sample a hand, still, at the device's origin.
py::array_t<palpate_sample> samples_at_rest(TickedSimulation& ticked) {
  palpate_sample still{};
  still.struct_size = sizeof still;
  still.orientation[0] = 1.0;
  py::array_t<palpate_sample> samples(static_cast<py::ssize_t>(info_of(ticked).hands));
  std::fill_n(samples.mutable_data(), samples.size(), still);
  return samples;
}

py::array_t<palpate_sample> scripted_samples(TickedSimulation& ticked, std::uint64_t tick) {
  py::array_t<palpate_sample> samples = samples_at_rest(ticked);
  palpate_sample* to = samples.mutable_data();
  ticked.with([&](palpate_simulation& simulation) {
    for (std::size_t hand = 0; hand < simulation.hands(); ++hand)
      simulation.scripted_sample(hand, tick, to[hand]);
  });
  return samples;
}

/// As many ticks as the samples are for.
py::array_t<palpate_result> tick(TickedSimulation& ticked, const py::array& given) {
  // Its fields count, not where they lie: numpy.stack() packs them closer.
  if (!given.dtype().attr("names").equal(py::dtype::of<palpate_sample>().attr("names"))) {
    throw InputError("samples: must be an array of the type that samples() gives");
  }
  const Samples samples(given);  // without gaps
  const auto hands = static_cast<py::ssize_t>(info_of(ticked).hands);
  const bool fits =
      (samples.ndim() == 1 || samples.ndim() == 2) && samples.shape(samples.ndim() - 1) == hands;
  if (!fits) {
    throw InputError("samples: must have one entry a hand (" + std::to_string(hands) +
                     "), or a row of those for each of several ticks");
  }
  palpate_result empty{};
  empty.struct_size = sizeof empty;
  py::array_t<palpate_result> results(
      std::vector<py::ssize_t>(samples.shape(), samples.shape() + samples.ndim()));
  palpate_result* to = results.mutable_data();
  std::fill_n(to, results.size(), empty);
  const palpate_sample* from = samples.data();
  const py::ssize_t ticks = samples.size() / hands;
  const py::gil_scoped_release others_may_run;
  ticked.with([&](palpate_simulation& simulation) {
    for (py::ssize_t i = 0; i < ticks; ++i) simulation.tick(from + i * hands, to + i * hands);
  });
  return results;
}

void restart(TickedSimulation& ticked) {
  ticked.with([](palpate_simulation& simulation) {
    if (simulation.recording()) {
      throw std::logic_error("restart: not while recording; close the simulation and make another one");
    }
    simulation.restart();
  });
}

void ticked_reset_fault(TickedSimulation& ticked, std::optional<std::size_t> hand) {
  ticked.with([&](palpate_simulation& simulation) {
    if (!hand) return simulation.reset_faults(~0U);
    if (*hand >= simulation.hands()) {
      throw InputError("hand = " + std::to_string(*hand) + ": must be less than the " +
                       std::to_string(simulation.hands()) + " hands");
    }
    simulation.reset_faults(1U << *hand);
  });
}

Surface surface_now(TickedSimulation& ticked) {
  return ticked.with([](palpate_simulation& simulation) {
    palpate_picture picture{};
    picture.struct_size = sizeof picture;
    simulation.update_surface(picture);
    Surface surface;
    surface.tick = picture.tick;
    surface.mesh.vertices = simulation.vertices();
    surface.mesh.triangles = simulation.rest_surface().triangles;
    const double* p = picture.organ_position;
    const double* q = picture.organ_orientation;
    surface.organ_W.position = Vec3(p[0], p[1], p[2]);
    surface.organ_W.rotation = Quat(q[0], q[1], q[2], q[3]);
    return surface;
  });
}

std::vector<std::string> ticked_remarks_of(TickedSimulation& ticked) {
  return ticked.with([](palpate_simulation& simulation) {
    std::vector<std::string> remarks = simulation.setup().repairs;
    const std::vector<std::string>& more = simulation.setup().remarks;
    remarks.insert(remarks.end(), more.begin(), more.end());
    return remarks;
  });
}

constexpr const char* kAbout =
    "A simulation that the program around it ticks at its own rate with samples of its own device: the C "
    "interface (palpate.h) as arrays. It reads no clock, so it may run faster or slower than in life; the "
    "same "
    "samples give the same results bit for bit.";

constexpr const char* kAboutOpening =
    "Prepares the organ; the scene is given as to simulate(), its device only says how the samples are "
    "mapped "
    "into the world. no_hand: nobody holds the device, and all force is there at once; False: the force "
    "waits "
    "until the hand has been still outside the tissue and rises by a ramp, and the passivity controller "
    "acts. "
    "Never True with a device that can push. record: HDF5 file to write; record_waits: tick() waits for the "
    "disk, else rows may be lost and close() says so. surface_edge: as of Simulation. Raises InputError.";

constexpr const char* kAboutTick =
    "The next haptic tick, or as many as there are rows of samples: one sample of every hand in, one result "
    "of "
    "every hand out, in arrays of the same shape. Their fields are those of palpate_sample and "
    "palpate_result "
    "in palpate.h, SI; device_force, device_torque and gripper_force are what to give to the device. A bad "
    "sample is no error but a fault of its hand. Raises InputError for a wrong number of hands, RuntimeError "
    "when closed.";

}  // namespace

void bind_ticked(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(palpate_sample, position, orientation, velocity, gripper, age, buttons, fault);
  PYBIND11_NUMPY_DTYPE(palpate_result, tick, time, device_force, device_torque, gripper_force, force, torque,
                       tissue_force, noise_force, friction, distance, depth, contact, normal, tool_position,
                       tool_orientation, gripper, energy, engagement, phase, cutoff_layer, saturated, status,
                       fault);
  const py::none none;
  const py::call_guard<py::gil_scoped_release> others_may_run;
  py::class_<TickedSimulation> ticked(module, "TickedSimulation", kAbout);
  std::apply(
      [&](const auto&... scene) {
        ticked.def(py::init(of_a_scene<std::optional<fs::path>, bool, bool, double, bool>(&ticked_open)),
                   scene..., py::arg("record") = none, py::arg("record_waits") = true,
                   py::arg("no_hand") = false, py::arg("surface_edge") = 0.0, py::arg("cache") = true,
                   kAboutOpening);
      },
      scene_arguments());
  ticked
      .def("samples", &samples_at_rest,
           "An array of samples for tick(), one a hand: still, at the device's origin, gripper closed.")
      .def("scripted_samples", &scripted_samples, py::arg("tick"),
           "What scripted devices would give at a tick: the scene's own path or recording, else from above "
           "the "
           "organ's middle onto it and back. Held hands wait a second before they go.")
      .def("tick", &tick, py::arg("samples"), kAboutTick)
      .def("reset_fault", &ticked_reset_fault, py::arg("hand") = none,
           "Clears the latched fault of one hand, or of all, at the next tick.")
      .def("restart", &restart, others_may_run, "Back to before tick 0. Raises RuntimeError while recording.")
      .def("surface", &surface_now, others_may_run, "The organ's visible surface at the newest tick.")
      .def(
          "close", &TickedSimulation::close, others_may_run,
          "Ends the recording and frees all; again: nothing happens. Raises InputError when rows are missing "
          "from the recording.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__",
           [](TickedSimulation& self, const py::object&, const py::object&, const py::object&) {
             const py::gil_scoped_release released;
             self.close();
           })
      .def_property_readonly("hand_count", [](TickedSimulation& self) { return info_of(self).hands; })
      .def_property_readonly("rate_Hz", [](TickedSimulation& self) { return info_of(self).rate; })
      .def_property_readonly(
          "scripted_ticks", [](TickedSimulation& self) { return info_of(self).scripted_ticks; },
          "Ticks until scripted_samples() has nothing more to say.")
      .def_property_readonly(
          "max_force", [](TickedSimulation& self) { return info_of(self).max_force; },
          "N, no larger one is ever given.")
      .def_property_readonly("remarks", &ticked_remarks_of,
                             "What a user should be told of the scene: repairs to meshes, warnings.");
}

}  // namespace palpate::python

// Simulations that Python ticks with its own samples: the C interface with arrays.
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/error.h"

#include "bindings/c/palpate.h"
#include "bindings/c/simulation.h"
#include "bindings/python/docs.h"
#include "bindings/python/inclusion_argument.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using Samples = py::array_t<palpate_sample, py::array::c_style | py::array::forcecast>;

/// Serializes all calls, so that several Python threads may use one simulation.
class TickedSimulation final {
 public:
  TickedSimulation(const SceneArguments& arguments, const palpate_options& options, bool cache)
      : simulation_(new palpate_simulation(
            c_interface::load(arguments.load(cache), preparation_of(cache), options.no_hand != 0), options)) {
  }
  ~TickedSimulation() = default;
  TickedSimulation(const TickedSimulation&) = delete;
  TickedSimulation& operator=(const TickedSimulation&) = delete;

  /// Calls `use` with the simulation. @throws std::logic_error if it is closed
  template <typename Use>
  auto with(const Use& use) {
    if (!process_.is_current()) throw std::logic_error(c_interface::kForked);
    const std::lock_guard lock(mutex_);
    if (!simulation_) throw std::logic_error("the simulation is closed");
    return use(*simulation_);
  }

  void close() {
    if (!process_.is_current()) return;  // it is the parent's
    const std::lock_guard lock(mutex_);
    const auto owned = std::move(simulation_);
    if (owned) owned->finish_recording();
  }

 private:
  OwnProcess process_;
  std::mutex mutex_;
  std::unique_ptr<palpate_simulation, c_interface::FreeOwn> simulation_;
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

/// One sample per hand: at rest at the origin of the device frame.
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

/// Computes one tick per row of samples.
py::array_t<palpate_result> tick(TickedSimulation& ticked, const py::array& given) {
  require_unmasked(given);
  // Compares the field names, not the offsets, because numpy.stack() removes padding.
  if (!given.dtype().attr("names").equal(py::dtype::of<palpate_sample>().attr("names"))) {
    throw InputError("samples: must be an array of the type that samples() gives");
  }
  const Samples samples(given);  // contiguous copy
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

std::vector<std::string> ticked_set_inclusion(TickedSimulation& ticked,
                                              const std::variant<std::size_t, std::string>& which,
                                              const std::optional<Numbers>& position,
                                              std::optional<double> ratio) {
  return ticked.with([&](palpate_simulation& simulation) {
    const std::size_t index = inclusion_index(simulation.scene(), which);
    const model::Inclusion now = simulation.updates().inclusions()[index];
    return simulation.updates().offer(live_inclusion(index, now, position, ratio)).warnings;
  });
}

std::vector<scene::InclusionTable> ticked_inclusions(TickedSimulation& ticked) {
  return ticked.with([](palpate_simulation& simulation) {
    return inclusion_tables(simulation.scene(), simulation.updates().inclusions());
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
  return ticked.with([](palpate_simulation& simulation) { return remarks_of(simulation.scene()); });
}

constexpr const char* kAbout =
    "A simulation that your program ticks with samples of its own devices: the C interface (palpate.h) with "
    "arrays. It reads no clock, so it may run faster or slower than real time. The same samples give the "
    "same results bit for bit.";

constexpr const char* kAboutOpening =
    "Prepares the organ. The arguments of the scene are those of simulate(); its device only maps samples to "
    "the world frame. no_hand: if True, no hand holds the device and the full force applies at once; use it "
    "only if no device can push. If False, the force starts by a ramp after the hand was still outside the "
    "tissue, and the passivity controller acts. record: HDF5 file to write; record_waits: if True, tick() "
    "waits for the disk; if False, rows may be lost, which close() reports. surface_edge: as in Simulation. "
    "Raises InputError.";

constexpr const char* kAboutTick =
    "Computes the next haptic tick from one sample per hand, or one tick per row of samples. Returns the "
    "results in an array of the same shape. The fields are those of palpate_sample and palpate_result in "
    "palpate.h, in SI units. Write device_force, device_torque and gripper_force to the device. A bad sample "
    "is not an error; it latches a fault of its hand. Raises InputError for a wrong number of hands, "
    "RuntimeError if the simulation is closed.";

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
           "An array for tick() with one sample per hand: at rest at the origin of the device frame, gripper "
           "closed.")
      .def("scripted_samples", &scripted_samples, py::arg("tick"),
           "Samples of scripted devices at a tick. They follow the scene's path or recording; without one, "
           "the tool moves from above the middle of the organ into it and back. A held hand waits one second "
           "first.")
      .def("tick", &tick, py::arg("samples"), kAboutTick)
      .def("set_inclusion", &ticked_set_inclusion, py::arg("inclusion"), py::kw_only(),
           py::arg("position") = none, py::arg("stiffness_ratio") = none,
           "Moves an inclusion (its name or number from 0) to `position` (m, organ frame) and sets its "
           "stiffness ratio at the next tick; None keeps a value. Returns the warnings of the stability "
           "check. Raises InputError, ParameterError.")
      .def("reset_fault", &ticked_reset_fault, py::arg("hand") = none,
           "Clears the latched fault of one hand, or of all hands, at the next tick.")
      .def("restart", &restart, others_may_run,
           "Resets the state to that before tick 0. Raises RuntimeError while recording.")
      .def("surface", &surface_now, others_may_run, "The organ's visible surface at the newest tick.")
      .def("close", &TickedSimulation::close, others_may_run,
           "Closes the recording and frees everything; a second call does nothing. Raises InputError if rows "
           "are missing from the recording.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__",
           [](TickedSimulation& self, const py::object&, const py::object&, const py::object&) {
             const py::gil_scoped_release released;
             self.close();
           })
      .def_property_readonly("inclusions", &ticked_inclusions,
                             "The inclusions of the last set_inclusion(), or of the scene: a list of "
                             "Inclusion.")
      .def_property_readonly("hand_count", [](TickedSimulation& self) { return info_of(self).hands; })
      .def_property_readonly("rate_Hz", [](TickedSimulation& self) { return info_of(self).rate; })
      .def_property_readonly(
          "scripted_ticks", [](TickedSimulation& self) { return info_of(self).scripted_ticks; },
          "Number of ticks with a scripted motion.")
      .def_property_readonly(
          "max_force", [](TickedSimulation& self) { return info_of(self).max_force; },
          "Largest force of a result in N.")
      .def_property_readonly("remarks", &ticked_remarks_of,
                             "Remarks on the scene for the user: mesh repairs and warnings.");
}

}  // namespace palpate::python

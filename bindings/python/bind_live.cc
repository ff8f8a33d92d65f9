// Simulations in real time.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/haptics/tick_fields.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"

#include "bindings/python/docs.h"
#include "bindings/python/inclusion_argument.h"
#include "bindings/python/live_simulation.h"
#include "bindings/python/scene_arguments.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::TickRow;
using Live = std::shared_ptr<LiveSimulation>;

/// One hand at the newest tick.
struct HandState {
  TickRow row;
  std::string fault;
};

/// State of a simulation at its newest tick.
struct NewestState {
  std::uint64_t change = 0;
  bool running = false;
  std::vector<HandState> hands;
};

Live open(const SceneArguments& arguments, std::optional<double> duration_s, std::optional<fs::path> record,
          std::optional<int> core, double keep_s, double surface_edge, bool cache, bool poll) {
  const py::gil_scoped_release others_may_run;
  const haptics::Waiting waiting = poll ? haptics::Waiting::kPoll : haptics::Waiting::kSleep;
  const LiveSimulation::Options options{duration_s, std::move(record), {core, waiting},
                                        keep_s,     surface_edge,      cache};
  const auto free_own = [](LiveSimulation* live) {
    if (live->is_own()) delete live;
  };
  return Live(new LiveSimulation(arguments.load(cache), options), free_own);
}

/// After the end, throws once if the run failed or its recording is incomplete.
void raise_failure(LiveSimulation& live) {
  const std::string failure = live.take_failure();
  if (!failure.empty()) throw InputError(failure);
}

/// Starts the run, and registers a finalizer that stops it when the program exits, even if a reference cycle
/// keeps the object.
void start(const py::object& self) {
  const Live live = self.cast<Live>();
  {
    const py::gil_scoped_release others_may_run;
    live->start();
  }
  const auto stop_at_exit = [kept = std::weak_ptr<LiveSimulation>(live)] {
    if (const Live alive = kept.lock()) alive->stop();
  };
  py::module_::import("weakref").attr("finalize")(self, py::cpp_function(stop_at_exit));
  raise_failure(*live);
}

void stop(LiveSimulation& live) {
  {
    const py::gil_scoped_release others_may_run;
    live.stop();
  }
  raise_failure(live);
}

/// Waits in short intervals, so that Ctrl-C is handled.
bool wait(LiveSimulation& live, std::optional<double> timeout_s) {
  if (timeout_s && !(*timeout_s >= 0.0)) throw ParameterError("timeout_s", *timeout_s, ">= 0");
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kTurn{50};
  const auto begun = Clock::now();
  for (;;) {
    const std::chrono::duration<double> waited = Clock::now() - begun;
    const double left = timeout_s ? *timeout_s - waited.count() : 1.0;
    const bool running = live.running();  // read before the wait: a run that ends meanwhile counts as ended
    bool ended = false;
    {
      const py::gil_scoped_release others_may_run;
      const auto turn = std::chrono::milliseconds(
          static_cast<std::int64_t>(std::ceil(1e3 * std::max(0.0, std::min(left, 1.0)))));
      ended = live.ended_within(std::min(turn, kTurn));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (ended) {
      raise_failure(live);
      return true;
    }
    if (left <= 0.0 || !running) return false;
  }
}

void leave(LiveSimulation& live, const py::object& type, const py::object& /*value*/,
           const py::object& /*trace*/) {
  {
    const py::gil_scoped_release others_may_run;
    live.stop();
  }
  if (type.is_none()) raise_failure(live);  // an exception from the block has priority
}

std::optional<NewestState> state_of(LiveSimulation& live) {
  NewestState state;
  state.change = live.change();
  state.running = live.running();
  for (const TickRow& row : live.newest()) state.hands.push_back({row, live.describe_fault(row)});
  if (state.hands.empty()) return std::nullopt;
  return state;
}

std::vector<std::string> set_noise(LiveSimulation& live, std::optional<bool> enabled,
                                   std::optional<double> gain, std::optional<double> threshold,
                                   std::uint64_t not_before_tick) {
  haptics::LiveNoise noise = live.changes().noise();
  if (enabled) noise.enabled = *enabled;
  if (gain) noise.gain = *gain;
  if (threshold) noise.threshold = *threshold;
  return live.changes().offer(noise, not_before_tick).warnings;
}

void set_stimulus(LiveSimulation& live, double force_N, double ramp_ms, std::uint32_t interval,
                  std::uint64_t not_before_tick) {
  (void)live.changes().offer(haptics::LiveStimulus{force_N, 1e-3 * ramp_ms, interval}, not_before_tick);
}

std::vector<std::string> set_inclusion(LiveSimulation& live,
                                       const std::variant<std::size_t, std::string>& which,
                                       const std::optional<Numbers>& position, std::optional<double> ratio,
                                       std::uint64_t not_before_tick) {
  const std::size_t index = inclusion_index(live.scene(), which);
  const model::Inclusion now = live.changes().inclusions()[index];
  return live.changes().offer(live_inclusion(index, now, position, ratio), not_before_tick).warnings;
}

void reset_fault(LiveSimulation& live, std::optional<std::size_t> hand) {
  if (!hand) return live.reset_faults(~0U);
  if (*hand >= live.hands()) {
    throw InputError("hand = " + std::to_string(*hand) + ": must be less than the " +
                     std::to_string(live.hands()) + " hands");
  }
  live.reset_faults(1U << *hand);
}

py::list faults_of(const haptics::LoopReport& loop) {
  py::list faults;
  for (const haptics::FaultSeen& seen : loop.faults) {
    py::dict fault;
    fault["tick"] = seen.tick;
    fault["hand"] = seen.hand;
    fault["fault"] = haptics::describe(seen.fault);
    fault["reset_tick"] = seen.reset_tick == haptics::FaultSeen::kNotReset
                              ? py::object(py::none())
                              : py::object(py::int_(seen.reset_tick));
    faults.append(fault);
  }
  return faults;
}

py::dict report_of(LiveSimulation& live) {
  const session::RunResult outcome = live.result();
  const haptics::LoopReport& loop = outcome.loop;
  py::dict report;
  report["ticks"] = loop.ticks;
  report["stopped_early"] = loop.stopped_early;
  report["faults"] = faults_of(loop);
  report["missed_deadlines"] = loop.missed_deadlines;
  report["longest_gap_ns"] = loop.longest_gap_ns;
  report["tick_p50_ns"] = loop.tick_time.percentile(0.5);
  report["tick_p99_ns"] = loop.tick_time.percentile(0.99);
  report["late_p50_ns"] = loop.lateness.percentile(0.5);
  report["late_p99_ns"] = loop.lateness.percentile(0.99);
  report["realtime_priority"] = loop.realtime_priority;
  report["memory_locked"] = loop.memory_locked;
  report["polled"] = loop.polled;
  report["watchdog_stops"] = loop.watchdog_stops;
  report["remarks"] = loop.remarks;
  report["fault_recording"] = outcome.fault_recording.string();
  return report;
}

std::string phase_of(const HandState& hand) {
  return contact::kPhaseNames[std::min<std::size_t>(hand.row.phase, contact::kPhaseNames.size() - 1)];
}

/// The components of a hand's vector or quaternion, all doubles.
py::array_t<double> components_of(const HandState& hand, const haptics::TickField& field) {
  std::array<double, 4> numbers{};
  std::memcpy(numbers.data(), reinterpret_cast<const std::byte*>(&hand.row) + field.offset,
              field.size() * sizeof(double));
  return array_of(std::span(numbers.data(), field.size()));
}

/// Binds a value of a hand's row, so that its signature has the type.
void bind_value(py::class_<HandState>& state, const haptics::TickField& field) {
  if (field.size() > 1) {
    state.def_property_readonly(
        field.attribute, [field](const HandState& hand) { return components_of(hand, field); },
        field.meaning);
  } else if (field.type == haptics::ColumnType::kF64) {
    state.def_property_readonly(
        field.attribute,
        [field](const HandState& hand) {
          return with_number(hand.row, field.type, field.offset,
                             [](auto number) { return static_cast<double>(number); });
        },
        field.meaning);
  } else {
    state.def_property_readonly(
        field.attribute,
        [field](const HandState& hand) -> py::int_ {
          return with_number(hand.row, field.type, field.offset,
                             [](auto number) { return py::int_(py::cast(number)); });
        },
        field.meaning);
  }
}

void bind_hand_state(py::module_& module) {
  py::class_<HandState> state(module, "HandState",
                              "One hand at one tick: its row of a recording in SI units, world frame.");
  for (const haptics::TickField& field : haptics::kTickFields) {
    if (field.attribute != nullptr) bind_value(state, field);
  }
  state.def_property_readonly("phase", &phase_of, "approach, press or pull.")
      .def_property_readonly(
          "saturated", [](const HandState& hand) { return hand.row.saturated != 0; },
          "Whether the tool is past the last layer, where the force stays constant.")
      .def_readonly("fault", &HandState::fault,
                    "Why the hand's force is zero, with the device's own message; empty: no fault.");
}

void bind_state(py::module_& module) {
  py::class_<NewestState>(module, "State", "State of a simulation at its newest tick.")
      .def_property_readonly(
          "tick", [](const NewestState& state) { return state.hands.front().row.tick; },
          "Number of the tick, from 0.")
      .def_property_readonly(
          "time", [](const NewestState& state) { return state.hands.front().row.time; }, "s, tick / rate.")
      .def_readonly("change", &NewestState::change,
                    "Number of the last parameter update that a tick has used; 0: none.")
      .def_readonly("running", &NewestState::running, "Whether the run has not ended.")
      .def_readonly("hands", &NewestState::hands, "A list with one HandState per hand.");
}

py::class_<LiveSimulation, Live> bind_simulation(py::module_& module) {
  py::class_<LiveSimulation, Live> simulation(module, "Simulation", doc("LiveSimulation"));
  const py::none none;
  std::apply(
      [&](const auto&... scene) {
        simulation.def(
            py::init(of_a_scene<std::optional<double>, std::optional<fs::path>, std::optional<int>, double,
                                double, bool, bool>(&open)),
            scene..., py::arg("duration_s") = none, py::arg("record") = none, py::arg("core") = none,
            py::arg("keep_s") = 600.0, py::arg("surface_edge") = 0.0, py::arg("cache") = true,
            py::arg("poll") = false,
            "Opens the devices and prepares the organ. The arguments of the scene are those of simulate(). "
            "duration_s: None runs until the paths of the devices end; record: HDF5 file to write; core: "
            "processor core for the loop; keep_s: time span of rows() in seconds; surface_edge: longest edge "
            "of surface() in metres, 0 keeps the organ's mesh; poll: the loop polls the clock between ticks "
            "instead of sleeping, which occupies one core and starts ticks with less delay. Raises "
            "InputError.");
      },
      scene_arguments());
  return simulation;
}

void bind_control(py::class_<LiveSimulation, Live>& simulation) {
  const py::none none;
  const py::call_guard<py::gil_scoped_release> others_may_run;
  simulation.def("start", &start, doc("LiveSimulation::start"))
      .def("stop", &stop,
           (std::string(doc("LiveSimulation::stop")) + " Raises InputError once if the run failed or its "
                                                       "recording is incomplete.")
               .c_str())
      .def("wait", &wait, py::arg("timeout_s") = none,
           "Waits until the run ends by itself, at most timeout_s seconds. Ctrl-C interrupts it. Returns "
           "whether the run has ended, and False before start(). Raises the errors of stop().")
      .def("__enter__",
           [](const py::object& self) {
             start(self);
             return self;
           })
      .def("__exit__", &leave, py::arg("type"), py::arg("value"), py::arg("trace"))
      .def(
          "set_tissue",
          [](LiveSimulation& live, const TissueArgument& tissue, std::uint64_t not_before_tick) {
            return live.changes().offer(tissue_of(tissue), not_before_tick).warnings;
          },
          py::arg("tissue"), py::kw_only(), py::arg("not_before_tick") = 0, others_may_run,
          "Changes the tissue (a Tissue, a built-in name or a tissue file) at the first tick that is not "
          "before not_before_tick, which the recording states; a later change waits behind it. Returns the "
          "warnings of the stability check. Raises ParameterError for an invalid value, and InputError if "
          "the reference radius differs from the run's or if 32 changes are waiting; then nothing changes.")
      .def(
          "set_noise", &set_noise, py::arg("enabled") = none, py::arg("gain") = none,
          py::arg("threshold") = none, py::kw_only(), py::arg("not_before_tick") = 0,
          "Switches the touch noise on or off and sets gain (N m) and threshold (m); None keeps a value. The "
          "noise crossfades within 50 ms. Returns and raises as set_tissue() does.")
      .def("set_inclusion", &set_inclusion, py::arg("inclusion"), py::kw_only(), py::arg("position") = none,
           py::arg("stiffness_ratio") = none, py::arg("not_before_tick") = 0,
           "Moves an inclusion (its name or number from 0) to `position` (m, organ frame) and sets its "
           "stiffness ratio; None keeps a value. Returns and raises as set_tissue() does; InputError for a "
           "position that is not inside the organ.")
      .def("set_stimulus", &set_stimulus, py::arg("force_N"), py::kw_only(), py::arg("ramp_ms") = 50.0,
           py::arg("interval") = 0, py::arg("not_before_tick") = 0,
           "Ramps a commanded force to force_N (positive away from the tissue) within ramp_ms, on every hand "
           "along the direction of the touch noise. interval: number of the stimulus interval that begins, 1 "
           "or 2; 0 ends it. Raises as set_tissue() does.")
      .def("reset_fault", &reset_fault, py::arg("hand") = none,
           "Clears the latched fault of one hand, or of all hands, at the next tick. The force of a held "
           "device starts again by a ramp, after the hand was still outside the tissue.");
}

}  // namespace

void bind_live(py::module_& module) {
  bind_hand_state(module);
  bind_state(module);
  auto simulation = bind_simulation(module);
  bind_control(simulation);
  const py::call_guard<py::gil_scoped_release> others_may_run;
  simulation
      .def("state", &state_of, others_may_run, "The State at the newest tick; None before the first tick.")
      .def("surface", &LiveSimulation::surface, others_may_run, doc("LiveSimulation::surface"))
      .def(
          "rows",
          [](LiveSimulation& live) {
            std::vector<TickRow> rows;
            {
              const py::gil_scoped_release others_may_run;
              rows = live.rows();
            }
            return adopt(std::move(rows), row_type());
          },
          "The rows of the last keep_s seconds, in the array type of simulate().")
      .def_property_readonly("rows_missing", &LiveSimulation::rows_missing,
                             doc("LiveSimulation::rows_missing"))
      .def_property_readonly("running", &LiveSimulation::running, doc("LiveSimulation::running"))
      .def("report", &report_of,
           "Summary of the ended run, a dictionary: ticks, faults, missed_deadlines, computing times and "
           "lateness of ticks (ns), remarks, and, after a fault without a recording, the file with the last "
           "ticks. Raises RuntimeError before the end.")
      .def_property_readonly(
          "tissue", [](LiveSimulation& live) { return live.changes().tissue(); },
          "The tissue of the last set_tissue(), or of the scene.")
      .def_property_readonly(
          "noise",
          [](LiveSimulation& live) {
            const haptics::LiveNoise noise = live.changes().noise();
            py::dict parts;
            parts["enabled"] = noise.enabled;
            parts["gain"] = noise.gain;
            parts["threshold"] = noise.threshold;
            return parts;
          },
          "The touch noise of the last set_noise(), or of the scene: enabled, gain (N m), threshold (m).")
      .def_property_readonly(
          "inclusions",
          [](LiveSimulation& live) { return inclusion_tables(live.scene(), live.changes().inclusions()); },
          "The inclusions of the last set_inclusion(), or of the scene: a list of Inclusion.")
      .def_property_readonly("name", [](const LiveSimulation& live) { return live.scene().name; })
      .def_property_readonly("rate_Hz", [](const LiveSimulation& live) { return live.scene().rate_Hz; })
      .def_property_readonly("hand_count", &LiveSimulation::hands)
      .def_property_readonly("organ", [](const LiveSimulation& live) { return live.scene().organ; })
      .def_property_readonly(
          "remarks", [](const LiveSimulation& live) { return remarks_of(live.scene()); },
          "Remarks on the scene for the user: mesh repairs and warnings.");
}

}  // namespace palpate::python

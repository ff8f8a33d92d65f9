// Whole runs as arrays of rows: simulated here, or read from a recording.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/base/error.h"
#include "palpate/devices/devices.h"
#include "palpate/haptics/loop.h"
#include "palpate/record/assemble.h"
#include "palpate/record/recorder.h"
#include "palpate/record/recording.h"
#include "palpate/record/replay.h"

#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::TickRow;
using record::Recording;

/// Keeps all rows of a run, in memory taken before it, and hands them on.
class RowKeeper final : public haptics::TickSink {
 public:
  RowKeeper(std::size_t expected, haptics::TickSink* next) : next_(next) { rows.reserve(expected); }
  void begin(std::int64_t started_unix_ns) noexcept override {
    if (next_ != nullptr) next_->begin(started_unix_ns);
  }
  void put(const TickRow& row) noexcept override {
    rows.push_back(row);
    if (next_ != nullptr) next_->put(row);
  }
  std::vector<TickRow> rows;

 private:
  haptics::TickSink* next_;
};

/// The devices of a scene, none of which is a real one: this loop keeps no time.
std::vector<std::unique_ptr<haptics::Device>> open_devices(const scene::Setup& setup) {
  std::vector<std::unique_ptr<haptics::Device>> devices;
  for (std::size_t hand = 0; hand < setup.devices.size(); ++hand) {
    const std::string& kind = setup.devices[hand].kind;
    if (kind != "scripted" && kind != "replay" && kind != "emulated") {
      throw InputError("device kind = \"" + kind +
                       "\": must be scripted, replay or emulated, as the run is offline");
    }
    devices.push_back(devices::open_device(setup, hand));
  }
  return devices;
}

std::uint64_t ticks_of(const std::vector<std::unique_ptr<haptics::Device>>& devices, double rate_Hz,
                       std::optional<double> duration_s) {
  constexpr double kMostTicks = 1e9;  // a million seconds; the memory is gone long before
  if (duration_s) {
    const double ticks = std::round(*duration_s * rate_Hz);
    if (!(*duration_s > 0.0) || !(ticks <= kMostTicks)) {
      throw ParameterError("duration_s", *duration_s,
                           "> 0 and at most " + std::to_string(kMostTicks / rate_Hz));
    }
    return static_cast<std::uint64_t>(ticks);
  }
  std::uint64_t last = 0;
  for (const auto& device : devices) last = std::max(last, device->last_tick(rate_Hz));
  return last;
}

/// The rows of a scene's run, as fast as possible.
std::vector<TickRow> run(const SceneWish& wish, std::optional<double> duration_s,
                         const std::optional<fs::path>& recording, bool cache) {
  const scene::Setup setup = wish.load();
  const haptics::SimulationWorld world = record::assemble(setup, preparation_of(cache));
  const auto devices = open_devices(setup);
  const std::uint64_t ticks = ticks_of(devices, setup.rate_Hz, duration_s);
  std::optional<record::Recorder> recorder;
  if (recording) recorder.emplace(*recording, setup, true);
  RowKeeper rows(ticks * setup.tools.size(), recorder ? &*recorder : nullptr);
  haptics::SimulationState state(world);
  std::vector<haptics::Device*> plain;
  for (const auto& device : devices) plain.push_back(device.get());
  const haptics::LoopReport report =
      haptics::run_loop(world, state, plain, &rows, {.ticks = ticks, .offline = true});
  if (recorder) recorder->finish(report);
  return std::move(rows.rows);
}

py::array simulate(const SceneWish& wish, std::optional<double> duration_s,
                   const std::optional<fs::path>& record, bool cache) {
  std::vector<TickRow> rows;
  {
    const py::gil_scoped_release others_may_run;
    rows = run(wish, duration_s, record, cache);
  }
  return adopt(std::move(rows), row_type());
}

Recording read(const fs::path& file) {
  const py::gil_scoped_release others_may_run;
  return record::read_recording(file);
}

std::string replay_difference(const Recording& recording) {
  const py::gil_scoped_release others_may_run;
  return record::replay(recording).first_difference;
}

/// A pandas table; phase and fault become words.
py::object frame_of(const py::object& rows) {
  const py::module_ pandas = py::module_::import("pandas");
  const auto words = [&](const char* column, const std::vector<std::string>& names) {
    return pandas.attr("Categorical").attr("from_codes")(rows[column], py::arg("categories") = names);
  };
  std::vector<std::string> faults;
  for (std::uint8_t fault = 0; fault <= static_cast<std::uint8_t>(haptics::Fault::kForceOff); ++fault) {
    faults.emplace_back(haptics::name_of(static_cast<haptics::Fault>(fault)));
  }
  const py::object frame = pandas.attr("DataFrame")(rows);
  frame["phase"] = words("phase", {"approach", "press", "pull"});
  frame["fault"] = words("fault", faults);
  return frame;
}

void bind_recording(py::module_& module) {
  py::class_<Recording>(module, "Recording", doc("Recording"))
      .def_property_readonly(
          "rows",
          [](const py::object& self) {
            const auto& recording = self.cast<const Recording&>();
            return py::array(row_type(), {static_cast<py::ssize_t>(recording.rows.size())},
                             {static_cast<py::ssize_t>(sizeof(TickRow))}, recording.rows.data(), self);
          },
          "One a tick and hand, in a structured array with the columns of `palpate export`; phase and fault "
          "are numbers.")
      .def_property_readonly("name", [](const Recording& recording) { return recording.setup.name; })
      .def_property_readonly("rate_Hz", [](const Recording& recording) { return recording.setup.rate_Hz; })
      .def_property_readonly("seed", [](const Recording& recording) { return recording.setup.seed; })
      .def_property_readonly("organ", [](const Recording& recording) { return recording.setup.organ; })
      .def_property_readonly("tissue", [](const Recording& recording) { return recording.setup.tissue; })
      .def_property_readonly("remarks", [](const Recording& recording) { return recording.setup.remarks; })
      .def_property_readonly(
          "version", [](const Recording& recording) { return recording.facts.version; },
          doc("RunFacts::version"))
      .def_property_readonly(
          "machine", [](const Recording& recording) { return recording.facts.machine; },
          doc("RunFacts::machine"))
      .def_property_readonly(
          "started_unix_ns", [](const Recording& recording) { return recording.facts.started_unix_ns; },
          doc("RunFacts::started_unix_ns"))
      .def_property_readonly("offline", [](const Recording& recording) { return recording.facts.offline; })
      .def_property_readonly(
          "complete", [](const Recording& recording) { return recording.facts.complete; },
          doc("RunFacts::complete"))
      .def_property_readonly("missed_deadlines",
                             [](const Recording& recording) { return recording.facts.missed_deadlines; })
      .def(
          "to_pandas", [](const py::object& self) { return frame_of(self.attr("rows")); },
          "to_pandas() of the rows.")
      .def(
          "surface", &surface_of, py::arg("tick"), py::arg("surface_edge") = 0.0, py::arg("cache") = true,
          py::call_guard<py::gil_scoped_release>(),
          "The organ's visible surface at a tick, for which the ticks before are run again. surface_edge: as "
          "of Simulation. Raises InputError.")
      .def("replay_difference", &replay_difference,
           "Runs the recording's ticks again; the first difference in words, empty when every bit is the "
           "same.");
  module.def("read_recording", &read, py::arg("file"), doc("read_recording"));
}

}  // namespace

void bind_runs(py::module_& module) {
  const py::none none;
  std::apply(
      [&](const auto&... scene) {
        module.def("simulate", of_a_scene<std::optional<double>, std::optional<fs::path>, bool>(&simulate),
                   scene..., py::arg("duration_s") = none, py::arg("record") = none, py::arg("cache") = true,
                   "Runs a scene as fast as possible, as `palpate run --offline` does, and returns its rows: "
                   "one a tick and hand, in a structured array with the columns of `palpate export` (phase "
                   "and fault are numbers). Arguments override the scene as the flags of that name do; "
                   "tissue may be a Tissue, tool a list of jaws; record: also write this HDF5 file. Raises "
                   "InputError.");
      },
      scene_arguments());
  bind_recording(module);
  module.def("to_pandas", &frame_of, py::arg("rows"),
             "The rows of a run, from simulate(), Simulation.rows() or Recording.rows, as a pandas DataFrame "
             "in which phase and fault are words. Raises ImportError without pandas.");
}

}  // namespace palpate::python

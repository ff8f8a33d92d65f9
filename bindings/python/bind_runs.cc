// Whole runs as arrays of rows: simulated here, or read from a recording.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/session.h"

#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::TickRow;
using record::Recording;

/// Keeps all rows of a run, in memory taken before it.
class RowKeeper final : public haptics::TickObserver {
 public:
  explicit RowKeeper(std::size_t expected) { rows.reserve(expected); }
  void on_row(const TickRow& row) noexcept override { rows.push_back(row); }
  std::vector<TickRow> rows;
};

/// @throws InputError for a real device: this loop keeps no time.
void require_no_real_device(const scene::Scene& setup) {
  for (const scene::DeviceSetup& device : setup.devices) {
    if (device.kind == "scripted" || device.kind == "replay" || device.kind == "emulated") continue;
    throw InputError("device kind = \"" + device.kind +
                     "\": must be scripted, replay or emulated, as the run is offline");
  }
}

/// The rows of a scene's run, as fast as possible.
std::vector<TickRow> run(const SceneArguments& arguments, std::optional<double> duration_s,
                         const std::optional<fs::path>& recording, bool cache) {
  constexpr double kMaxTicks = 1e9;  // a million seconds; the memory is gone long before
  scene::Scene setup = arguments.load();
  require_no_real_device(setup);
  if (duration_s) (void)session::ticks_in(*duration_s, setup.rate_Hz, "duration_s", kMaxTicks);
  session::SessionOptions options;
  options.duration_s = duration_s;
  options.preparation = preparation_of(cache);
  session::Session session(std::move(setup), std::move(options));
  RowKeeper keeper(session.ticks() * session.hands());
  (void)session.run({.recording = recording.value_or(fs::path()), .offline = true, .keep_fault = false},
                    {&keeper});
  return std::move(keeper.rows);
}

py::array simulate(const SceneArguments& arguments, std::optional<double> duration_s,
                   const std::optional<fs::path>& record, bool cache) {
  std::vector<TickRow> rows;
  {
    const py::gil_scoped_release others_may_run;
    rows = run(arguments, duration_s, record, cache);
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

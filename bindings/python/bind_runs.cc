// Runs as arrays of rows: simulated, or read from a recording.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "io/scene/device_kinds.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "palpate/session.h"
#include "palpate/tool_contact.h"
#include "run/realtime/machine_checks.h"

#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"
#include "bindings/python/surface.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using haptics::TickRow;
using record::Recording;

/// Keeps all rows of a run in preallocated memory.
class RowKeeper final : public haptics::TickObserver {
 public:
  explicit RowKeeper(std::size_t expected) { rows.reserve(expected); }
  void on_row(const TickRow& row) noexcept override { rows.push_back(row); }
  std::vector<TickRow> rows;
};

/// @throws InputError for a real device, because this loop does not run in real time.
void require_no_real_device(const scene::Scene& scene) {
  for (const scene::DeviceSetup& device : scene.devices) {
    if (device.kind == "scripted" || device.kind == "replay" || device.kind == "emulated") continue;
    throw InputError("device kind = \"" + device.kind +
                     "\": must be scripted, replay or emulated, as the run is offline");
  }
}

/// Runs a scene as fast as possible. @return its rows
std::vector<TickRow> run(const SceneArguments& arguments, std::optional<double> duration_s,
                         const std::optional<fs::path>& recording, bool cache) {
  constexpr double kMaxTicks = 1e9;  // 1e6 s at 1 kHz; memory ends long before
  scene::Scene scene = arguments.load(cache);
  require_no_real_device(scene);
  if (duration_s) (void)session::ticks_in(*duration_s, scene.rate_Hz, "duration_s", kMaxTicks);
  session::SessionOptions options;
  options.duration_s = duration_s;
  options.preparation = preparation_of(cache);
  session::Session session(std::move(scene), std::move(options));
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

std::size_t export_recording(const Recording& recording, const fs::path& file) {
  record::export_csv(recording, file);
  if (!recording.changes.empty()) record::export_changes_csv(recording, record::changes_csv_path(file));
  return recording.rows.size();
}

/// A pandas table with the names of phases and faults.
py::object frame_of(const py::object& rows) {
  const py::module_ pandas = py::module_::import("pandas");
  const auto categories = [&](const char* column, const std::vector<std::string>& names) {
    return pandas.attr("Categorical").attr("from_codes")(rows[column], py::arg("categories") = names);
  };
  std::vector<std::string> faults;
  for (std::uint8_t fault = 0; fault <= static_cast<std::uint8_t>(haptics::kLastFault); ++fault) {
    faults.emplace_back(haptics::name_of(static_cast<haptics::Fault>(fault)));
  }
  const py::object frame = pandas.attr("DataFrame")(rows);
  frame["phase"] = categories("phase", {contact::kPhaseNames.begin(), contact::kPhaseNames.end()});
  frame["fault"] = categories("fault", faults);
  return frame;
}

/// What `palpate doctor` finds without a measurement: name, verdict, state, remedy.
std::vector<std::tuple<std::string, std::string, std::string, std::string>> machine_checks() {
  std::vector<std::tuple<std::string, std::string, std::string, std::string>> rows;
  for (const realtime::MachineCheck& check : realtime::check_machine()) {
    const char* verdict = check.verdict == realtime::Verdict::kGood  ? "good"
                          : check.verdict == realtime::Verdict::kBad ? "bad"
                                                                     : "unknown";
    rows.emplace_back(check.name, verdict, check.found, check.advice);
  }
  return rows;
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
          "One row per tick and hand, in a structured array with the columns of `palpate export`; phase and "
          "fault are numbers.")
      .def_property_readonly("name", [](const Recording& recording) { return recording.scene.name; })
      .def_property_readonly("rate_Hz", [](const Recording& recording) { return recording.scene.rate_Hz; })
      .def_property_readonly("seed", [](const Recording& recording) { return recording.scene.seed; })
      .def_property_readonly("organ", [](const Recording& recording) { return recording.scene.organ; })
      .def_property_readonly("tissue", [](const Recording& recording) { return recording.scene.tissue; })
      .def_property_readonly("remarks", [](const Recording& recording) { return recording.scene.remarks; })
      .def_property_readonly(
          "version", [](const Recording& recording) { return recording.facts.version; },
          doc("RunFacts::version"))
      .def_property_readonly(
          "machine", [](const Recording& recording) { return recording.facts.machine; },
          doc("RunFacts::machine"))
      .def_property_readonly(
          "hand_count", [](const Recording& recording) { return recording.scene.tools.size(); },
          "Number of hands.")
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
          "The rows as a pandas DataFrame, by to_pandas().")
      .def("export_csv", &export_recording, py::arg("file"), py::call_guard<py::gil_scoped_release>(),
           "Writes the rows as CSV, as `palpate export` does, and changes of tissue or noise beside it. "
           "Returns the number of rows. Raises InputError that names the file.")
      .def("surface", &surface_of, py::arg("tick"), py::arg("surface_edge") = 0.0, py::arg("cache") = true,
           py::call_guard<py::gil_scoped_release>(),
           "The organ's visible surface at a tick, computed by a replay up to that tick. surface_edge: as in "
           "Simulation. Raises InputError.")
      .def("replay_difference", &replay_difference,
           "Replays the recording. Returns a description of the first difference, empty if all rows are "
           "equal bit for bit.");
  module.def("read_recording", &read, py::arg("file"), doc("read_recording"));
}

}  // namespace

void bind_runs(py::module_& module) {
  const py::none none;
  std::apply(
      [&](const auto&... scene) {
        module.def(
            "simulate", of_a_scene<std::optional<double>, std::optional<fs::path>, bool>(&simulate), scene...,
            py::arg("duration_s") = none, py::arg("record") = none, py::arg("cache") = true,
            "Runs a scene as fast as possible, as `palpate run --offline` does. Returns one row per tick and "
            "hand, in a structured array with the columns of `palpate export` (phase and fault are numbers). "
            "Arguments override the scene file, like the flags of the same name. tissue: a Tissue or a name; "
            "tool: a name or a list of jaws; inclusions: a list of Inclusion or names of "
            "inclusion_presets(), instead of the scene's; stiffness_map: a CSV or PLY file (mm), or an array "
            "with the columns x, y, z (m) and factor; record: HDF5 file to write. Raises InputError.");
      },
      scene_arguments());
  bind_recording(module);
  module.def(
      "device_names",
      [] {
        std::vector<std::string> names;
        for (const scene::DeviceKind& kind : scene::device_kinds()) {
          if (kind.name != "host") names.emplace_back(kind.name);  // no run can open the host's device
        }
        return names;
      },
      "The kinds of devices that a scene and the argument device accept. simulate() takes scripted, replay "
      "and emulated.");
  module.def("_frame_of", &frame_of, py::arg("rows"));
  module.def("_row_type", &row_type);
  module.def("_machine_checks", &machine_checks);
}

}  // namespace palpate::python

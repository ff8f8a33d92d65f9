// Many independent hands at once.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "palpate/error.h"

#include "bindings/python/batch.h"
#include "bindings/python/docs.h"
#include "bindings/python/scene_arguments.h"

namespace palpate::python {
namespace {

using Shape = std::vector<py::ssize_t>;
using Output = py::array_t<double, py::array::c_style>;

std::string text_of(const Shape& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

Shape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// Batch with the arrays that step() returns. They are made again when the number of ticks changes, so arrays
/// that Python still has keep their numbers.
class PythonBatch final {
 public:
  explicit PythonBatch(std::unique_ptr<Batch> batch) : batch_(std::move(batch)) {}

  [[nodiscard]] Batch& get() noexcept { return *batch_; }
  [[nodiscard]] py::array_t<std::uint32_t> status() const { return status_; }
  [[nodiscard]] py::array_t<std::uint32_t> fault() const { return fault_; }

  std::tuple<Output, Output, Output> step(const Numbers& poses, const std::optional<Numbers>& gripper,
                                          const std::optional<py::tuple>& out) {
    const Shape rows = rows_of(poses);
    if (gripper && shape_of(*gripper) != rows) {
      throw InputError(
          fmt::format("gripper: has shape {}, must be {}", text_of(shape_of(*gripper)), text_of(rows)));
    }
    make_arrays(rows);
    Output force = force_, torque = torque_, depth = depth_;
    if (out) take_out(*out, force, torque, depth);
    const py::array_t<std::uint32_t> kept_status = status_, kept_fault = fault_;
    Batch::Ticks ticks;
    ticks.series = rows.size() == 2;
    ticks.count = ticks.series ? static_cast<std::size_t>(rows[1]) : 1;
    ticks.poses = poses.data();
    ticks.gripper = gripper ? gripper->data() : nullptr;
    ticks.force = force.mutable_data();
    ticks.torque = torque.mutable_data();
    ticks.depth = depth.mutable_data();
    ticks.status = status_.mutable_data();
    ticks.fault = fault_.mutable_data();
    {
      const py::gil_scoped_release others_may_run;
      batch_->step(ticks);
    }
    return {force, torque, depth};
  }

 private:
  /// Shape of one number per hand, or per hand and tick.
  Shape rows_of(const Numbers& poses) const {
    Shape shape = shape_of(poses);
    const auto hands = static_cast<py::ssize_t>(batch_->hands());
    const auto size = static_cast<py::ssize_t>(Batch::kPoseSize);
    if (!(shape.size() == 2 || shape.size() == 3) || shape.front() != hands || shape.back() != size) {
      throw InputError(
          fmt::format("poses: has shape {}, must be ({}, {}) or ({}, ticks, {}): position x y z in "
                      "m, orientation w x y z",
                      text_of(shape), hands, size, hands, size));
    }
    shape.pop_back();
    return shape;
  }

  void make_arrays(const Shape& rows) {
    if (shape_of(depth_) == rows) return;
    Shape vectors = rows;
    vectors.push_back(3);
    force_ = Output(vectors);
    torque_ = Output(vectors);
    depth_ = Output(rows);
    status_ = py::array_t<std::uint32_t>(rows);
    fault_ = py::array_t<std::uint32_t>(rows);
  }

  /// The caller's arrays in place of the own ones, which have the right shapes. @throws InputError
  static void take_out(const py::tuple& out, Output& force, Output& torque, Output& depth) {
    if (out.size() != 3) {
      throw InputError(fmt::format("out: has {} arrays, must be force, torque and depth", out.size()));
    }
    replace(out[0], "force", force);
    replace(out[1], "torque", torque);
    replace(out[2], "depth", depth);
  }

  static void replace(const py::object& given, const char* name, Output& array) {
    if (Output::check_(given)) {
      const auto other = py::reinterpret_borrow<Output>(given);
      if (other.writeable() && shape_of(other) == shape_of(array)) {
        array = other;
        return;
      }
    }
    throw InputError(fmt::format("out: {} must be a writeable array of float64 in C order with shape {}",
                                 name, text_of(shape_of(array))));
  }

  std::unique_ptr<Batch> batch_;
  Output force_{Shape{0}}, torque_{Shape{0}}, depth_{Shape{0}};
  py::array_t<std::uint32_t> status_{Shape{0}}, fault_{Shape{0}};
};

std::unique_ptr<PythonBatch> open_batch(const SceneArguments& arguments, std::size_t hands,
                                        std::optional<std::size_t> jobs, double surface_edge, bool cache) {
  std::unique_ptr<Batch> batch;
  {
    const py::gil_scoped_release others_may_run;
    batch = std::make_unique<Batch>(arguments.load(cache), preparation_of(cache), hands, jobs, surface_edge);
  }
  return std::make_unique<PythonBatch>(std::move(batch));
}

/// Numbers of hands or points below `count`: None means all; a mask, or whole numbers. @throws InputError
std::vector<std::size_t> chosen(const char* name, const py::object& given, std::size_t count) {
  std::vector<std::size_t> all;
  if (given.is_none()) {
    all.resize(count);
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }
  require_unmasked(given);
  const auto array = py::array::ensure(given);
  const char kind = array ? array.dtype().kind() : '?';
  const bool is_mask = kind == 'b' && array.ndim() == 1 && static_cast<std::size_t>(array.size()) == count;
  const bool is_list = array && array.ndim() == 1 && (kind == 'i' || kind == 'u' || array.size() == 0);
  if (!is_mask && !is_list) {
    throw InputError(fmt::format("{}: must be whole numbers from 0 to {}, or a mask of {} truth values", name,
                                 count - 1, count));
  }
  const auto numbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const std::int64_t one = numbers.at(i);
    if (is_mask) {
      if (one != 0) all.push_back(static_cast<std::size_t>(i));
      continue;
    }
    if (one < 0 || static_cast<std::size_t>(one) >= count) {
      throw InputError(fmt::format("{}[{}] = {}: must be 0 to {}", name, i, one, count - 1));
    }
    all.push_back(static_cast<std::size_t>(one));
  }
  return all;
}

py::array_t<double> pressure(PythonBatch& python, const py::object& points) {
  Batch& batch = python.get();
  const std::vector<std::size_t> all = chosen("points", points, batch.surface().vertices.size());
  py::array_t<double> pressure(
      {static_cast<py::ssize_t>(batch.hands()), static_cast<py::ssize_t>(all.size())});
  double* to = pressure.mutable_data();
  const py::gil_scoped_release others_may_run;
  batch.pressures(all, to);
  return pressure;
}

py::array_t<double> displacement(PythonBatch& python, const py::object& points) {
  Batch& batch = python.get();
  const std::vector<std::size_t> all = chosen("points", points, batch.surface().vertices.size());
  py::array_t<double> moved(
      {static_cast<py::ssize_t>(batch.hands()), static_cast<py::ssize_t>(all.size()), py::ssize_t{3}});
  double* to = moved.mutable_data();
  const py::gil_scoped_release others_may_run;
  batch.displacements(all, to);
  return moved;
}

constexpr const char* kAboutBatch =
    "Prepares the organ. The arguments of the scene are those of simulate(); of its device only the mapping "
    "to the world frame is used, nobody holds it. n: hands. jobs: threads, None: all cores. surface_edge: "
    "longest edge of surface in metres, 0 keeps the organ's mesh. Raises InputError.";

constexpr const char* kAboutBatchStep =
    "Computes the next tick of every hand from poses (n, 7), or the next ticks from poses (n, ticks, 7): "
    "position x y z in m, orientation w x y z. gripper: jaw opening (n) or (n, ticks), 0 closed to 1 open; "
    "None: closed. Returns (force, torque, depth): force of the tissue on the hand in N (n, 3) or (n, ticks, "
    "3) after the gate and with touch noise, torque in N m about the handle's origin, both in the world "
    "frame, and depth in m. The next step() overwrites these arrays: copy what you keep, or pass out=(force, "
    "torque, depth), float64 arrays of those shapes. Other Python threads run meanwhile. Raises InputError "
    "for a wrong shape, a number that is not finite or a quaternion that has not length 1; then no hand has "
    "moved.";

}  // namespace

void bind_batch(py::module_& module) {
  const py::none none;
  py::class_<PythonBatch> batch(module, "Batch", doc("Batch"));
  std::apply(
      [&](const auto&... scene) {
        batch.def(
            py::init(of_a_scene_and<std::size_t, std::optional<std::size_t>, double, bool>(&open_batch)),
            scene..., py::arg("jobs") = none, py::arg("surface_edge") = 0.0, py::arg("cache") = true,
            kAboutBatch);
      },
      scene_arguments(py::arg("n") = 1));
  batch
      .def("step", &PythonBatch::step, py::arg("poses"), py::arg("gripper") = none, py::kw_only(),
           py::arg("out") = none, kAboutBatchStep)
      .def("displacement", &displacement, py::arg("points") = none,
           "Displacement of points of the surface at the newest tick, (n, points, 3) in m, organ frame. "
           "points: indices of vertices of surface; None: all. A new array. Raises InputError.")
      .def("pressure", &pressure, py::arg("points") = none,
           "Pressure of the tool on points of the surface at the newest tick, (n, points) in Pa, negative "
           "where it pulls, 0 for a needle. The tissue's law gives a contact's force; it is spread by Hertz, "
           "as under a ball on a half-space: 3 F / (2 pi a^2) sqrt(1 - r^2 / a^2), D = a artanh(a / R), in a "
           "pull a at least 1.5 R. The surface should have several points within a: see surface_edge. "
           "points: as displacement(). A new array. Raises InputError.")
      .def(
          "restart",
          [](PythonBatch& self, const py::object& hands) {
            const std::vector<std::size_t> all = chosen("hands", hands, self.get().hands());
            const py::gil_scoped_release others_may_run;
            self.get().restart(all);
          },
          py::arg("hands") = none,
          "Resets hands (numbers from 0, or a mask; None: all) to the state before tick 0.")
      .def(
          "reset_fault",
          [](PythonBatch& self, const py::object& hands) {
            const std::vector<std::size_t> all = chosen("hands", hands, self.get().hands());
            const py::gil_scoped_release others_may_run;
            self.get().reset_fault(all);
          },
          py::arg("hands") = none,
          "Clears the latched faults of hands (numbers from 0, or a mask; None: all) at the next tick.")
      .def_property_readonly(
          "status", &PythonBatch::status,
          "Status bits of the newest step(), (n) or (n, ticks), PALPATE_STARTED_INSIDE ... of palpate.h.")
      .def_property_readonly(
          "fault", &PythonBatch::fault,
          "Latched faults of the newest step(), (n) or (n, ticks), PALPATE_FAULT_... of palpate.h; 0: none. "
          "The force of a hand with a fault falls to 0 within 10 ms and stays there until reset_fault().")
      .def_property_readonly(
          "surface", [](PythonBatch& self) { return self.get().surface(); },
          "The rest surface, a Mesh, whose points displacement() moves.")
      .def_property_readonly(
          "n", [](PythonBatch& self) { return self.get().hands(); }, "Number of hands.")
      .def_property_readonly(
          "jobs", [](PythonBatch& self) { return self.get().jobs(); }, "Number of threads.")
      .def_property_readonly("rate_Hz", [](PythonBatch& self) { return self.get().scene().rate_Hz; })
      .def_property_readonly(
          "remarks", [](PythonBatch& self) { return remarks_of(self.get().scene()); },
          "Remarks on the scene for the user: mesh repairs and warnings.");
}

}  // namespace palpate::python

#pragma once
// What the parts of the Python module share.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "palpate/mesh.h"
#include "palpate/tissue.h"

namespace palpate::python {

namespace py = pybind11;

/// Numbers in: any array or sequence, converted to double without gaps.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The parts of the module, one a file.
void bind_model(py::module_& module);
void bind_geometry(py::module_& module);
void bind_runs(py::module_& module);
void bind_fit(py::module_& module);
void bind_surface(py::module_& module);
void bind_live(py::module_& module);
void bind_ticked(py::module_& module);
void bind_validate(py::module_& module);

/// "press" or "pull". @throws InputError.
[[nodiscard]] model::Direction direction_of(const std::string& word);

/// An array of the same shape with `answer` of every number; no array but one value for a number alone.
template <typename Row, typename Answer>
py::object vectorised(const Numbers& numbers, const Answer& answer) {
  const std::vector<py::ssize_t> shape(numbers.shape(), numbers.shape() + numbers.ndim());
  py::array_t<Row> rows(shape);
  const double* from = numbers.data();
  Row* to = rows.mutable_data();
  const py::ssize_t count = numbers.size();
  {
    const py::gil_scoped_release others_may_run;
    for (py::ssize_t i = 0; i < count; ++i) to[i] = answer(from[i]);
  }
  return rows[py::tuple()];
}

/// n x 3, copies.
[[nodiscard]] py::array_t<double> vertices_of(const geometry::TriangleMesh& mesh);
[[nodiscard]] py::array_t<std::int32_t> triangles_of(const geometry::TriangleMesh& mesh);

/// A copy as a row of numbers.
[[nodiscard]] py::array_t<double> array_of(std::span<const double> values);
/// x y z; w x y z.
[[nodiscard]] py::array_t<double> array_of(const Vec3& vector);
[[nodiscard]] py::array_t<double> array_of(const Quat& rotation);

/// A NumPy array that owns what was a vector; nothing is copied. @param dtype of one element
template <typename Element>
py::array adopt(std::vector<Element> values, const py::dtype& dtype) {
  auto* kept = new std::vector<Element>(std::move(values));
  const py::capsule owner(kept, [](void* vector) { delete static_cast<std::vector<Element>*>(vector); });
  return py::array(dtype, {static_cast<py::ssize_t>(kept->size())},
                   {static_cast<py::ssize_t>(sizeof(Element))}, kept->data(), owner);
}

}  // namespace palpate::python

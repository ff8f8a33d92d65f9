#pragma once
// Shared declarations of the Python modules.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "palpate/mesh.h"
#include "palpate/tissue.h"

namespace palpate::python {

namespace py = pybind11;

/// @throws InputError if an argument is a NumPy array with masked values, or a list with one: a conversion to
/// numbers would use the values that the mask hides
void require_unmasked(py::handle argument);

/// An array argument without masked values.
template <typename Element, int kFlags>
class Unmasked : public py::array_t<Element, kFlags> {
 public:
  using py::array_t<Element, kFlags>::array_t;
  Unmasked() = default;
  explicit Unmasked(const py::array_t<Element, kFlags>& array) : py::array_t<Element, kFlags>(array) {}
};

/// Numeric argument: any array or sequence, converted to contiguous doubles.
using Numbers = Unmasked<double, py::array::c_style | py::array::forcecast>;

/// The parts of the module _palpate, one per file.
void bind_model(py::module_& module);
void bind_inclusions(py::module_& module);
void bind_geometry(py::module_& module);
void bind_runs(py::module_& module);
void bind_palpation(py::module_& module);
void bind_surface(py::module_& module);
void bind_live(py::module_& module);
void bind_ticked(py::module_& module);
void bind_batch(py::module_& module);

/// Parses "press" or "pull". @throws InputError
[[nodiscard]] model::Direction direction_of(const std::string& word);

/// A number for a number, an array for an array. Signatures and type stubs show its name.
class NumberOrArray : public py::object {
 public:
  NumberOrArray(py::object value) : py::object(std::move(value)) {}  // NOLINT(google-explicit-constructor)
};

/// A row of a structured array for a number, such an array for an array.
class RowOrRows : public py::object {
 public:
  RowOrRows(py::object value) : py::object(std::move(value)) {}  // NOLINT(google-explicit-constructor)
};

/// Applies `answer` to every number. Returns an array of the same shape, or one value for a scalar.
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

/// File argument: one file, or several.
using FilesArgument = std::variant<std::filesystem::path, std::vector<std::filesystem::path>>;

/// All that `read` finds in one file or in several. A repeated name gets a number, as in `palpate fit`.
template <typename Item>
std::vector<Item> read_all(const FilesArgument& files,
                           std::vector<Item> (*read)(const std::filesystem::path&)) {
  if (const auto* file = std::get_if<std::filesystem::path>(&files)) return read(*file);
  std::vector<Item> all;
  for (const std::filesystem::path& file : std::get<1>(files)) {
    for (Item& item : read(file)) {
      const auto taken = [&all](const std::string& name) {
        return std::any_of(all.begin(), all.end(), [&name](const Item& other) { return other.name == name; });
      };
      const std::string name = item.name;
      for (int n = 2; taken(item.name); ++n) item.name = name + " (" + std::to_string(n) + ")";
      all.push_back(std::move(item));
    }
  }
  return all;
}

/// Copies as n x 3 arrays.
[[nodiscard]] py::array_t<double> vertices_of(const geometry::TriangleMesh& mesh);
[[nodiscard]] py::array_t<std::int32_t> triangles_of(const geometry::TriangleMesh& mesh);

/// Copies numbers to a 1-D array.
[[nodiscard]] py::array_t<double> array_of(std::span<const double> values);
/// Copies a vector (x y z) or a quaternion (w x y z) to a 1-D array.
[[nodiscard]] py::array_t<double> array_of(const Vec3& vector);
[[nodiscard]] py::array_t<double> array_of(const Quat& rotation);

/// Moves a vector into a NumPy array without copying. @param dtype type of one element
template <typename Element>
py::array adopt(std::vector<Element> values, const py::dtype& dtype) {
  auto* kept = new std::vector<Element>(std::move(values));
  const py::capsule owner(kept, [](void* vector) { delete static_cast<std::vector<Element>*>(vector); });
  return py::array(dtype, {static_cast<py::ssize_t>(kept->size())},
                   {static_cast<py::ssize_t>(sizeof(Element))}, kept->data(), owner);
}

}  // namespace palpate::python

template <typename Element, int kFlags>
struct pybind11::detail::pyobject_caster<palpate::python::Unmasked<Element, kFlags>> {
  using Array = array_t<Element, kFlags>;
  using type = palpate::python::Unmasked<Element, kFlags>;

  bool load(handle from, bool convert) {
    if (!convert && !Array::check_(from)) return false;
    palpate::python::require_unmasked(from);
    value = type(Array::ensure(from));
    return static_cast<bool>(value);
  }
  static handle cast(const handle& from, return_value_policy, handle) { return from.inc_ref(); }
  PYBIND11_TYPE_CASTER(type, handle_type_name<Array>::name);
};

template <>
struct pybind11::detail::handle_type_name<palpate::python::RowOrRows> {
  static constexpr auto name = const_name("Union[numpy.void, numpy.ndarray]");
};
template <>
struct pybind11::detail::handle_type_name<palpate::python::NumberOrArray> {
  static constexpr auto name = const_name("Union[float, numpy.ndarray[numpy.float64]]");
};

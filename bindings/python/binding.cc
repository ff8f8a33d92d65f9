#include "bindings/python/binding.h"

#include <array>
#include <cstring>

#include "palpate/error.h"

namespace palpate::python {

namespace {

/// Bounds the depth of lists in lists, as a list that contains itself has no end.
struct RecursiveCall {
  RecursiveCall() {
    if (Py_EnterRecursiveCall(" in a list of arrays") != 0) throw py::error_already_set();
  }
  ~RecursiveCall() { Py_LeaveRecursiveCall(); }
  RecursiveCall(const RecursiveCall&) = delete;
  RecursiveCall& operator=(const RecursiveCall&) = delete;
};

}  // namespace

model::Direction direction_of(const std::string& word) {
  if (word == "press") return model::Direction::kPress;
  if (word == "pull") return model::Direction::kPull;
  throw InputError("direction = \"" + word + "\": must be press or pull");
}

void require_unmasked(py::handle argument) {
  PyObject* const given = argument.ptr();
  const auto& numpy = py::detail::npy_api::get();
  if (PyList_Check(given) || PyTuple_Check(given)) {
    const RecursiveCall deeper;
    const py::ssize_t count = PySequence_Fast_GET_SIZE(given);
    for (py::ssize_t i = 0; i < count; ++i) require_unmasked(PySequence_Fast_GET_ITEM(given, i));
    return;
  }
  const bool is_subclass = Py_TYPE(given) != numpy.PyArray_Type_ && numpy.PyArray_Check_(given);
  if (!is_subclass || !py::module_::import("numpy.ma").attr("is_masked")(argument).cast<bool>()) return;
  throw InputError(
      "a masked array (numpy.ma) was given: its mask hides values, which would count as the others do; leave "
      "them out first, by the same rows of every array, such as force[~mask]");
}

py::array_t<double> array_of(std::span<const double> values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> array_of(const Vec3& vector) {
  return array_of(std::array{vector.x(), vector.y(), vector.z()});
}

py::array_t<double> array_of(const Quat& rotation) {
  return array_of(std::array{rotation.w(), rotation.x(), rotation.y(), rotation.z()});
}

py::array_t<double> vertices_of(const geometry::TriangleMesh& mesh) {
  py::array_t<double> array({static_cast<py::ssize_t>(mesh.vertices.size()), py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const Vec3& vertex : mesh.vertices) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) *to++ = vertex(axis);
  }
  return array;
}

py::array_t<std::int32_t> triangles_of(const geometry::TriangleMesh& mesh) {
  py::array_t<std::int32_t> array({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  if (!mesh.triangles.empty()) {
    std::memcpy(array.mutable_data(), mesh.triangles.data(),
                mesh.triangles.size() * sizeof(geometry::Triangle));
  }
  return array;
}

}  // namespace palpate::python

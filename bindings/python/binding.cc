#include "bindings/python/binding.h"

#include <array>
#include <cstring>

#include "palpate/error.h"

namespace palpate::python {

model::Direction direction_of(const std::string& word) {
  if (word == "press") return model::Direction::kPress;
  if (word == "pull") return model::Direction::kPull;
  throw InputError("direction = \"" + word + "\": must be press or pull");
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

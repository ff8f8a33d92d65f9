#pragma once
#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace palpate::mesh_io {

/// The bytes of a number in a file, least significant first.
template <typename T>
std::string bytes_of(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// A tetrahedron with a different length on each axis, so that swapped axes are detected. Volume 2 x 3 x 4 /
/// 6 = 4.
inline const std::vector<std::array<float, 3>> kVertices{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
inline const std::vector<std::array<int, 3>> kTriangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

}  // namespace palpate::mesh_io

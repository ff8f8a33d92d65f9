// Reads the surface of a glTF 2.0 file as it is when nothing moves it.
//
// The scene is a tree of nodes; each places its mesh by the product of the transforms from the root. A mesh
// has parts (primitives), each a list of vertices and of triangles, strips or fans. Two things move vertices
// further, and a file may hold them as its shape at rest:
//
//     p  =  p0 + sum_t  w_t d_t(v)              morph targets (shape keys) with weights that are not 0
//     p' =  sum_j  w_j(v)  G_j B_j  p           a skin: joints j with their global transform G_j and inverse
//                                               bind matrix B_j (identity where the file has none)
//
// The transform of a node with a skin does not count [glTF 2.0, section 3.7.3.3]. A transform that mirrors
// turns its triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/gltf_document.h"
#include "io/system/path_text.h"

namespace palpate::mesh_io {
namespace {

using Json = GltfDocument::Json;
using Mat4 = Eigen::Matrix4d;

constexpr int kDeepestGltfNode = 200;
constexpr std::size_t kMaxNodes = 100'000;
constexpr double kUnitWithin = 0.01;  // of 1: length of a rotation's quaternion

class GltfReader final {
 public:
  explicit GltfReader(const MeshFile& file) : document_(file) { document_.check(); }

  ImportedMesh run() {
    place_nodes();
    for (const auto& [node, to_file] : placed_) add_mesh_of(node, to_file);
    note_parts(imported_, mirrored_, lines_);
    return std::move(imported_);
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const { document_.refuse(message); }

  /// Some numbers of an object, all finite; empty where they are missing.
  template <std::size_t kCount>
  [[nodiscard]] std::optional<std::array<double, kCount>> reals(const Json& owner, const char* name,
                                                                std::string_view where) const {
    const auto found = owner.find(name);
    if (found == owner.end()) return {};
    std::array<double, kCount> values{};
    bool good = found->is_array() && found->size() == kCount;
    for (std::size_t k = 0; good && k < kCount; ++k) {
      good = (*found)[k].is_number();
      if (good) values[k] = (*found)[k].get<double>();
    }
    if (!good) refuse(fmt::format("{}: {} must be {} numbers", where, name, kCount));
    return values;
  }

  [[nodiscard]] Mat4 transform_of(const Json& node, std::size_t index) const {
    const std::string where = fmt::format("node {}", index);
    if (const auto m = reals<16>(node, "matrix", where)) return Eigen::Map<const Mat4>(m->data());
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (const auto t = reals<3>(node, "translation", where))
      transform.translate(Vec3((*t)[0], (*t)[1], (*t)[2]));
    if (const auto r = reals<4>(node, "rotation", where)) {
      const Quat q((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
      if (!(std::abs(q.norm() - 1.0) < kUnitWithin)) {
        refuse(fmt::format("{}: rotation has the length {:.4g}, must be 1", where, q.norm()));
      }
      transform.rotate(q.normalized());
    }
    if (const auto s = reals<3>(node, "scale", where)) transform.scale(Vec3((*s)[0], (*s)[1], (*s)[2]));
    return transform.matrix();
  }

  /// The nodes that are nobody's child, in a file that does not say what its scene is.
  [[nodiscard]] Json roots() const {
    const Json& nodes = document_.list("nodes");
    std::vector<bool> child(nodes.size(), false);
    for (const Json& node : nodes) {
      for (const Json& index : GltfDocument::list_in(node, "children")) {
        if (index.is_number_unsigned() && index.get<std::uint64_t>() < nodes.size())
          child[index.get<std::size_t>()] = true;
      }
    }
    Json found = Json::array();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!child[i]) found.push_back(i);
    return found;
  }

  [[nodiscard]] Json first_nodes() {
    const Json& scenes = document_.list("scenes");
    if (scenes.empty()) return roots();
    const std::uint64_t scene = document_.whole(document_.root(), "scene", 0, "the file");
    if (scene >= scenes.size())
      refuse(fmt::format("scene {} is named but not there: it has {}", scene, scenes.size()));
    if (scenes.size() > 1) {
      imported_.repairs.push_back(fmt::format("took scene {} of its {}", scene, scenes.size()));
    }
    return GltfDocument::list_in(scenes[scene], "nodes");
  }

  /// Fills placed_ with the scene's nodes and their transforms; a node once per use.
  void place_nodes() {
    struct Open {
      std::size_t node;
      int depth;
      Mat4 outer;
    };
    const Json& nodes = document_.list("nodes");
    std::vector<Open> open;
    const auto add = [&](const Json& indices, int depth, const Mat4& outer) {
      for (auto index = indices.rbegin(); index != indices.rend(); ++index) {
        if (open.size() + placed_.size() >= kMaxNodes) {
          refuse(fmt::format("its nodes are used more than {} times", kMaxNodes));
        }
        if (!index->is_number_unsigned() || index->get<std::uint64_t>() >= nodes.size() ||
            !nodes[index->get<std::size_t>()].is_object()) {
          refuse(
              fmt::format("node {} is named but not there: it has {}", excerpt(index->dump()), nodes.size()));
        }
        open.push_back({index->get<std::size_t>(), depth, outer});
      }
    };
    add(first_nodes(), 1, Mat4::Identity());
    while (!open.empty()) {
      const Open here = open.back();
      open.pop_back();
      if (here.depth > kDeepestGltfNode) {
        refuse(fmt::format("its nodes are nested more than {} deep", kDeepestGltfNode));
      }
      const Json& node = nodes[here.node];
      const Mat4 to_file = here.outer * transform_of(node, here.node);
      global_.emplace(here.node, to_file);
      placed_.emplace_back(here.node, to_file);
      add(GltfDocument::list_in(node, "children"), here.depth + 1, to_file);
    }
    if (nodes.empty()) {  // a file of meshes alone
      for (std::size_t i = 0; i < document_.list("meshes").size(); ++i)
        add_mesh(i, Json::object(), {Mat4::Identity()}, false);
    }
  }

  void add_mesh_of(std::size_t node_index, const Mat4& to_file) {
    const Json& node = document_.list("nodes")[node_index];
    const std::string where = fmt::format("node {}", node_index);
    const std::size_t meshes = document_.list("meshes").size();
    if (!node.contains("mesh")) return;
    const std::uint64_t mesh = document_.whole(node, "mesh", meshes, where);
    if (mesh >= meshes) refuse(fmt::format("{}: mesh {} is not there: it has {}", where, mesh, meshes));
    if (!node.contains("skin")) return add_mesh(mesh, node, {to_file}, false);
    add_mesh(mesh, node, joints_of(document_.whole(node, "skin", 0, where)), true);
  }

  /// The matrices of a skin's joints.
  [[nodiscard]] std::vector<Mat4> joints_of(std::uint64_t skin_index) {
    const Json& skins = document_.list("skins");
    if (skin_index >= skins.size()) {
      refuse(fmt::format("skin {} is named but not there: it has {}", skin_index, skins.size()));
    }
    const Json& skin = skins[skin_index];
    const std::string where = fmt::format("skin {}", skin_index);
    const Json& joints = GltfDocument::list_in(skin, "joints");
    std::vector<double> inverse;
    if (skin.is_object() && skin.contains("inverseBindMatrices")) {
      inverse = document_.numbers(document_.whole(skin, "inverseBindMatrices", 0, where), "MAT4");
    }
    if (joints.empty()) refuse(where + ": has no joints");
    document_.spend(joints.size());
    if (!inverse.empty() && inverse.size() < 16 * joints.size()) {
      refuse(fmt::format("{}: has {} joints and {} inverse bind matrices", where, joints.size(),
                         inverse.size() / 16));
    }
    std::vector<Mat4> matrices;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto global =
          joints[j].is_number_unsigned() ? global_.find(joints[j].get<std::size_t>()) : global_.end();
      if (global == global_.end()) refuse(fmt::format("{}: joint {} is no node of the scene", where, j));
      Mat4 bind = Mat4::Identity();
      if (!inverse.empty()) bind = Eigen::Map<const Mat4>(inverse.data() + 16 * j);
      matrices.push_back(global->second * bind);
    }
    return matrices;
  }

  /// @param node with weights of morph targets of its own, or without @param matrices one, or one per joint
  void add_mesh(std::size_t index, const Json& node, const std::vector<Mat4>& matrices, bool skinned) {
    const Json& mesh = document_.list("meshes")[index];
    const Json& own = GltfDocument::list_in(node, "weights");
    const Json& weights = own.empty() ? GltfDocument::list_in(mesh, "weights") : own;
    std::size_t number = 0;
    for (const Json& part : GltfDocument::list_in(mesh, "primitives")) {
      add_part(part, fmt::format("mesh {}, part {}", index, number++), weights, matrices, skinned);
    }
  }

  void add_part(const Json& part, const std::string& where, const Json& weights,
                const std::vector<Mat4>& matrices, bool skinned) {
    if (!part.is_object() || !part.contains("attributes") || !part["attributes"].contains("POSITION")) {
      refuse(where + ": has no POSITION");
    }
    const std::uint64_t mode = document_.whole(part, "mode", 4, where);
    const Json& attributes = part["attributes"];
    std::vector<double> points = document_.numbers(document_.whole(attributes, "POSITION", 0, where), "VEC3");
    move_by_targets(part, where, weights, points);
    const std::size_t vertices = points.size() / 3;
    const auto offset = static_cast<std::int32_t>(imported_.mesh.vertices.size());
    if (imported_.mesh.vertices.size() + vertices > 3 * kMaxTriangles) too_many();
    if (!attributes.contains("JOINTS_0") && matrices.size() > 1) {
      refuse(where + ": has a skin, must have JOINTS_0 and WEIGHTS_0");
    }
    if (attributes.contains("JOINTS_0") && skinned) {
      add_skinned(attributes, where, points, matrices);
    } else {
      for (std::size_t v = 0; v < vertices; ++v) add_vertex(matrices.front(), &points[3 * v]);
    }
    std::vector<double> corners;
    if (part.contains("indices")) {
      corners = document_.numbers(document_.whole(part, "indices", 0, where), "SCALAR");
    } else {
      for (std::size_t v = 0; v < vertices; ++v) corners.push_back(static_cast<double>(v));
    }
    const std::size_t before = imported_.mesh.triangles.size();
    add_triangles(mode, corners, vertices, offset, where);
    if (imported_.mesh.triangles.size() == before) return;
    if (matrices.front().topLeftCorner<3, 3>().determinant() < 0.0) turn_from(before);
  }

  void turn_from(std::size_t first) {
    ++mirrored_;
    for (std::size_t t = first; t < imported_.mesh.triangles.size(); ++t)
      std::swap(imported_.mesh.triangles[t][1], imported_.mesh.triangles[t][2]);
  }

  void move_by_targets(const Json& part, const std::string& where, const Json& weights,
                       std::vector<double>& points) {
    const Json& targets = GltfDocument::list_in(part, "targets");
    for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
      if (!weights[t].is_number()) refuse(fmt::format("{}: weight {} must be a number", where, t));
      const double weight = weights[t].get<double>();
      if (weight == 0.0 || !targets[t].is_object() || !targets[t].contains("POSITION")) continue;
      const std::vector<double> moved =
          document_.numbers(document_.whole(targets[t], "POSITION", 0, where), "VEC3");
      if (moved.size() != points.size()) {
        refuse(fmt::format("{}: target {} has {} vertices, must have {}", where, t, moved.size() / 3,
                           points.size() / 3));
      }
      for (std::size_t k = 0; k < points.size(); ++k) points[k] += weight * moved[k];
    }
  }

  void add_skinned(const Json& attributes, const std::string& where, const std::vector<double>& points,
                   const std::vector<Mat4>& matrices) {
    const std::size_t vertices = points.size() / 3;
    std::vector<Mat4> blended(vertices, Mat4::Zero());
    std::vector<double> sums(vertices, 0.0);
    for (int set = 0; attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const std::vector<double> joints = document_.numbers(
          document_.whole(attributes, fmt::format("JOINTS_{}", set).c_str(), 0, where), "VEC4");
      const std::vector<double> weights =
          document_.numbers(document_.whole(attributes, fmt::format("WEIGHTS_{}", set).c_str(),
                                            std::numeric_limits<std::uint64_t>::max(), where),
                            "VEC4");
      if (joints.size() != 4 * vertices || weights.size() != 4 * vertices) {
        refuse(fmt::format("{}: JOINTS_{} and WEIGHTS_{} must have an element per vertex", where, set, set));
      }
      for (std::size_t i = 0; i < joints.size(); ++i) {
        if (weights[i] == 0.0) continue;
        if (!(joints[i] >= 0.0 && joints[i] < static_cast<double>(matrices.size()))) {
          refuse(fmt::format("{}: joint {} is out of range: the skin has {}", where, joints[i],
                             matrices.size()));
        }
        blended[i / 4] += weights[i] * matrices[static_cast<std::size_t>(joints[i])];
        sums[i / 4] += weights[i];
      }
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      if (!(sums[v] > 0.0)) refuse(fmt::format("{}: vertex {} has no joint with a weight", where, v));
      add_vertex(blended[v] / sums[v], &points[3 * v]);
    }
  }

  void add_vertex(const Mat4& matrix, const double* point) {
    imported_.mesh.vertices.emplace_back(
        (matrix * Eigen::Vector4d(point[0], point[1], point[2], 1.0)).head<3>());
    if ((imported_.mesh.vertices.back().array().abs() <= kLargestCoordinate).all()) return;  // false for NaN
    refuse(fmt::format("vertex {} is not finite (NaN, infinite or past 3.4e38)",
                       imported_.mesh.vertices.size()));
  }

  [[noreturn]] void too_many() const { refuse(fmt::format("more than {} triangles", kMaxTriangles)); }

  /// @param mode glTF's: 0 to 3 points and lines, 4 triangles, 5 a strip, 6 a fan
  void add_triangles(std::uint64_t mode, const std::vector<double>& corners, std::size_t vertices,
                     std::int32_t offset, const std::string& where) {
    const std::size_t n = corners.size();
    for (const double corner : corners) {
      if (corner >= 0.0 && corner < static_cast<double>(vertices)) continue;
      refuse(fmt::format("{}: vertex index {} is out of range: the part has {} vertices", where, corner,
                         vertices));
    }
    if (mode > 6) refuse(fmt::format("{}: mode {}: must be 0 to 6", where, mode));
    if (mode < 4) {
      lines_ += mode == 1 ? n / 2 : n;
      return;
    }
    if (mode == 4 && n % 3 != 0)
      refuse(fmt::format("{}: {} indices make no triangles: must be a multiple of 3", where, n));
    const std::size_t count = mode == 4 ? n / 3 : (n < 3 ? 0 : n - 2);
    if (imported_.mesh.triangles.size() + count > kMaxTriangles) too_many();
    const auto corner = [&](std::size_t i) { return offset + static_cast<std::int32_t>(corners[i]); };
    for (std::size_t t = 0; t < count; ++t) {
      if (mode == 4) {
        imported_.mesh.triangles.push_back({corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)});
      } else if (mode == 5) {  // every second one is turned
        imported_.mesh.triangles.push_back({corner(t), corner(t + 1 + t % 2), corner(t + 2 - t % 2)});
      } else {
        imported_.mesh.triangles.push_back({corner(t + 1), corner(t + 2), corner(0)});
      }
    }
  }

  GltfDocument document_;
  std::map<std::size_t, Mat4> global_;                // of a node's first use
  std::vector<std::pair<std::size_t, Mat4>> placed_;  // node and transform
  ImportedMesh imported_;
  std::size_t mirrored_ = 0;
  std::size_t lines_ = 0;
};

}  // namespace

ImportedMesh read_gltf(const MeshFile& file) { return GltfReader(file).run(); }

std::vector<std::filesystem::path> gltf_buffer_files(const std::filesystem::path& mesh) {
  const std::optional<MeshFormat> format = mesh_format(mesh);
  if (format != MeshFormat::kGltf && format != MeshFormat::kGlb) return {};
  const MeshFile file = open_mesh_file(mesh);
  std::vector<std::filesystem::path> files;
  for (const std::string& name : GltfDocument(file).buffer_names())
    files.push_back(mesh.parent_path() / to_path(name));
  return files;
}

}  // namespace palpate::mesh_io

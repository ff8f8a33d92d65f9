#include "io/mesh_io/import_mesh.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <assimp/DefaultIOSystem.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/core.h>

#include "io/system/input_file.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr std::size_t kMostTriangles = 20'000'000;
constexpr int kDeepestNode = 1000;

std::string one_line(std::string_view text) {
  std::string line(text.substr(0, text.find_first_of("\r\n")));
  for (char& c : line) {
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  }
  return line.substr(0, 200);
}

/// Keeps the first complaint about an index that the importer has bent into range instead of refusing it.
class Complaints final : public Assimp::LogStream {
 public:
  void write(const char* message) override {
    std::string text = one_line(message);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* sign : {"overflow", "out of range", "out-of-range", "exceed", "failed to triangulate"}) {
      if (text.find(sign) != std::string::npos && first_.empty()) first_ = one_line(message);
    }
  }
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  std::string first_;
};

class LogCapture final {
 public:
  LogCapture() {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(&complaints_, Assimp::Logger::Err | Assimp::Logger::Warn);
  }
  ~LogCapture() {
    Assimp::DefaultLogger::get()->detachStream(&complaints_, Assimp::Logger::Err | Assimp::Logger::Warn);
    Assimp::DefaultLogger::kill();
  }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;
  [[nodiscard]] const std::string& first() const { return complaints_.first(); }

 private:
  Complaints complaints_;
};

/// Gives the importer the mesh file's bytes from memory, and lets it open regular files alone beside it (the
/// buffers of a glTF file).
class CheckedFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit CheckedFiles(const MeshFile& file) : file_(file) {}

  /// The base class opens a file to see whether it is there, which waits for a FIFO.
  bool Exists(const char* name) const override {
    std::error_code error;
    return std::filesystem::exists(name, error);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
    const auto* start = reinterpret_cast<const std::uint8_t*>(file_.bytes.data());
    if (file_.path == name) return new Assimp::MemoryIOStream(start, file_.bytes.size());
    try {
      const std::string bytes = InputFile(name, kMeshInput).read_rest();
      auto* copy = new std::uint8_t[bytes.size()];  // the stream owns it, and the importer the stream
      std::memcpy(copy, bytes.data(), bytes.size());
      return new Assimp::MemoryIOStream(copy, bytes.size(), true);
    } catch (const InputError& error) {
      if (refusal_.empty()) refusal_ = error.what();
      return nullptr;
    }
  }
  /// Why the first file beside the mesh that was refused was refused; empty: none was.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 private:
  const MeshFile& file_;
  std::string refusal_;
};

using Mat4 = Eigen::Matrix4d;

Mat4 matrix_of(const aiMatrix4x4& m) {
  Mat4 matrix;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) matrix(row, column) = static_cast<double>(m[row][column]);
  }
  return matrix;
}

/// The 3DS importer turns the scene by -90 degrees about x, to its own y-up; this turns it back.
Mat4 axis_change_undone(MeshFormat format) {
  Mat4 undo = Mat4::Identity();
  if (format == MeshFormat::k3ds) {
    undo.row(1) << 0, 0, -1, 0;
    undo.row(2) << 0, 1, 0, 0;
  }
  return undo;
}

class SceneReader final {
 public:
  SceneReader(const MeshFile& file, const aiScene& scene) : file_(file), scene_(scene) {}

  ImportedMesh run() {
    if (scene_.mRootNode != nullptr) add_node(*scene_.mRootNode, axis_change_undone(file_.format), 0);
    if (mirrored_ > 0) {
      imported_.repairs.push_back(
          fmt::format("turned the triangles of {} mirrored parts outwards", mirrored_));
    }
    return std::move(imported_);
  }

 private:
  void add_node(const aiNode& node, const Mat4& outer, int depth) {
    if (depth > kDeepestNode) throw InputError(file_.path.string() + ": its parts are nested too deeply");
    const Mat4 to_file = outer * matrix_of(node.mTransformation);
    for (unsigned n = 0; n < node.mNumMeshes; ++n) add_part(*scene_.mMeshes[node.mMeshes[n]], to_file);
    for (unsigned n = 0; n < node.mNumChildren; ++n) add_node(*node.mChildren[n], to_file, depth + 1);
  }

  void add_part(const aiMesh& part, const Mat4& to_file) {
    TriangleMesh& mesh = imported_.mesh;
    if (mesh.triangles.size() + part.mNumFaces > kMostTriangles ||
        mesh.vertices.size() + part.mNumVertices > 3 * kMostTriangles) {
      throw InputError(fmt::format("{}: more than {} triangles", file_.path.string(), kMostTriangles));
    }
    const bool is_mirrored = to_file.topLeftCorner<3, 3>().determinant() < 0.0;
    mirrored_ += is_mirrored ? 1 : 0;
    const auto offset = static_cast<std::int32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      const Eigen::Vector4d homogeneous(static_cast<double>(p.x), static_cast<double>(p.y),
                                        static_cast<double>(p.z), 1.0);
      mesh.vertices.emplace_back((to_file * homogeneous).head<3>());
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines: counted by the caller
      Triangle triangle{};
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) {
          throw InputError(
              fmt::format("{}: a triangle's vertex index {} is out of range: the part has {} vertices",
                          file_.path.string(), face.mIndices[k], part.mNumVertices));
        }
        triangle[k] = offset + static_cast<std::int32_t>(face.mIndices[k]);
      }
      if (is_mirrored) std::swap(triangle[1], triangle[2]);
      mesh.triangles.push_back(triangle);
    }
  }

  const MeshFile& file_;
  const aiScene& scene_;
  ImportedMesh imported_;
  int mirrored_ = 0;
};

struct FaceCounts {
  std::size_t lines = 0;     // of fewer than three corners
  std::size_t polygons = 0;  // of more
};

void add_faces(const aiScene& scene, FaceCounts& counts) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f) {
      const unsigned corners = scene.mMeshes[m]->mFaces[f].mNumIndices;
      counts.lines += corners < 3 ? 1 : 0;
      counts.polygons += corners > 3 ? 1 : 0;
    }
  }
}

std::string cannot_read(const MeshFile& file, const std::string& why) {
  return file.path.string() + ": cannot be read: " + one_line(why);
}

}  // namespace

ImportedMesh import_mesh(const MeshFile& file, const FileFacts& facts) {
  FaceCounts counts;
  counts.lines = facts.lines;
  ImportedMesh imported;
  const bool is_cleaned =
      file.format == MeshFormat::kObj || file.format == MeshFormat::kPly || file.format == MeshFormat::kOff;
  if (!is_cleaned || facts.cleaned.find("\nf ") != std::string::npos) {
    const LogCapture log;
    Assimp::Importer importer;
    auto* files = new CheckedFiles(file);  // the importer's from here on
    importer.SetIOHandler(files);
    const aiScene* scene =
        is_cleaned ? importer.ReadFileFromMemory(facts.cleaned.data(), facts.cleaned.size(), 0, "obj")
                   : importer.ReadFile(file.path.string(), 0);
    if (scene == nullptr) {
      throw InputError(
          cannot_read(file, files->refusal().empty() ? importer.GetErrorString() : files->refusal()));
    }
    add_faces(*scene, counts);
    if (counts.polygons > 0) {
      scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
      if (scene == nullptr) throw InputError(cannot_read(file, importer.GetErrorString()));
    }
    if (!log.first().empty()) throw InputError(cannot_read(file, log.first()));
    imported = SceneReader(file, *scene).run();
  }
  if (counts.polygons > 0) {
    imported.repairs.push_back(fmt::format("cut {} polygons into triangles", counts.polygons));
  }
  if (counts.lines > 0) {
    imported.repairs.push_back(fmt::format("dropped {} lines or points", counts.lines));
  }
  return imported;
}

}  // namespace palpate::geometry

#include <algorithm>
#include <array>
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
#include <assimp/scene.h>
#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/scan.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::mesh_io {
namespace {

constexpr int kDeepestNode = 1000;

std::string first_line(std::string_view text) {
  return one_line(std::string(text.substr(0, std::min<std::size_t>(200, text.find_first_of("\r\n")))));
}

/// While it exists, keeps the first message about an index that the importer corrected instead of rejecting
/// it.
class IndexWarnings final : public Assimp::LogStream {
 public:
  IndexWarnings() {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(this, kLevels);
  }
  ~IndexWarnings() override {
    Assimp::DefaultLogger::get()->detachStream(this, kLevels);
    Assimp::DefaultLogger::kill();
  }
  IndexWarnings(const IndexWarnings&) = delete;
  IndexWarnings& operator=(const IndexWarnings&) = delete;

  void write(const char* message) override {
    const std::string text = lower_case(first_line(message));
    for (const char* sign : {"overflow", "out of range", "out-of-range", "exceed"}) {
      if (text.find(sign) != std::string::npos && first_.empty()) first_ = first_line(message);
    }
  }
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  static constexpr unsigned kLevels = Assimp::Logger::Err | Assimp::Logger::Warn;
  std::string first_;
};

/// Gives the importer the mesh file from memory. Lets it open other files, the buffers of a glTF file, only
/// if they are regular.
class CheckedFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit CheckedFiles(const MeshFile& file) : file_(file) {}

  /// The base class opens a file to test its existence, which blocks on a FIFO.
  bool Exists(const char* name) const override {
    std::error_code error;  // an error counts as absent: Open() reports it
    return std::filesystem::exists(to_path(name), error);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr) return nullptr;
    const auto* start = reinterpret_cast<const std::uint8_t*>(file_.bytes.data());
    if (file_.path == to_path(name)) return new Assimp::MemoryIOStream(start, file_.bytes.size());
    try {
      const std::string bytes = InputFile(to_path(name), kMeshInput).read_rest();
      auto* copy = new std::uint8_t[bytes.size()];  // the stream owns it, and the importer the stream
      std::memcpy(copy, bytes.data(), bytes.size());
      return new Assimp::MemoryIOStream(copy, bytes.size(), true);
    } catch (const InputError& error) {
      if (refusal_.empty()) refusal_ = error.what();
      return nullptr;
    }
  }
  /// The reason why the first other file was rejected; empty: none was.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 private:
  const MeshFile& file_;
  std::string refusal_;
};

using Mat4 = Eigen::Matrix4d;

Mat4 matrix_of(const aiMatrix4x4& m) {
  return Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(m[0]).cast<double>();
}

/// The 3DS importer rotates the scene by -90 degrees about x, to y-up; this is the inverse.
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
    note_parts(imported_, mirrored_, lines_);
    return std::move(imported_);
  }

 private:
  void add_node(const aiNode& node, const Mat4& outer, int depth) {
    if (depth > kDeepestNode) throw InputError(to_text(file_.path) + ": its parts are nested too deeply");
    const Mat4 to_file = outer * matrix_of(node.mTransformation);
    for (unsigned n = 0; n < node.mNumMeshes; ++n) add_part(*scene_.mMeshes[node.mMeshes[n]], to_file);
    for (unsigned n = 0; n < node.mNumChildren; ++n) add_node(*node.mChildren[n], to_file, depth + 1);
  }

  void add_part(const aiMesh& part, const Mat4& to_file) {
    geometry::TriangleMesh& mesh = imported_.mesh;
    if (mesh.triangles.size() + part.mNumFaces > kMaxTriangles ||
        mesh.vertices.size() + part.mNumVertices > 3 * kMaxTriangles) {
      throw InputError(fmt::format("{}: more than {} triangles", to_text(file_.path), kMaxTriangles));
    }
    const bool is_mirrored = to_file.topLeftCorner<3, 3>().determinant() < 0.0;
    mirrored_ += is_mirrored ? 1 : 0;
    const auto offset = static_cast<std::int32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      const Eigen::Vector4d homogeneous(static_cast<double>(p.x), static_cast<double>(p.y),
                                        static_cast<double>(p.z), 1.0);
      mesh.vertices.emplace_back((to_file * homogeneous).head<3>());
      // Nested transforms may have scaled it beyond what a file's numbers can be.
      if ((mesh.vertices.back().array().abs() <= kLargestCoordinate).all()) continue;  // false for NaN
      throw InputError(fmt::format("{}: vertex {} is not finite (NaN, infinite or past 3.4e38)",
                                   to_text(file_.path), mesh.vertices.size()));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) {  // neither format has polygons
        ++lines_;
        continue;
      }
      geometry::Triangle triangle{};
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) {
          throw InputError(
              fmt::format("{}: a triangle's vertex index {} is out of range: the part has {} vertices",
                          to_text(file_.path), face.mIndices[k], part.mNumVertices));
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
  std::size_t mirrored_ = 0;
  std::size_t lines_ = 0;
};

std::string cannot_read(const MeshFile& file, const std::string& why) {
  return to_text(file.path) + ": cannot be read: " + first_line(why);
}

ImportedMesh read_by_assimp(const MeshFile& file) {
  const IndexWarnings index_warnings;
  Assimp::Importer importer;
  auto* files = new CheckedFiles(file);  // now owned by the importer
  importer.SetIOHandler(files);
  const aiScene* scene = importer.ReadFile(to_text(file.path), 0);
  if (scene == nullptr) {
    throw InputError(
        cannot_read(file, files->refusal().empty() ? importer.GetErrorString() : files->refusal()));
  }
  if (!index_warnings.first().empty()) throw InputError(cannot_read(file, index_warnings.first()));
  return SceneReader(file, *scene).run();
}

/// The importer trusts the number of keys that a track declares.
void check_3ds_track(const MeshFile& file, std::size_t begin, std::size_t end) {
  constexpr std::size_t kBeforeCount = 10;  // flags and unused bytes
  constexpr std::size_t kLeastKey = 6;      // bytes
  const std::string where = fmt::format("{}, byte {}: a track of key frames ", to_text(file.path), begin);
  if (end - begin < kBeforeCount + 4) throw InputError(where + "is too short");
  const std::size_t keys = little_endian_32(file.bytes, begin + kBeforeCount);
  if (keys > (end - begin) / kLeastKey) {
    throw InputError(fmt::format("{}declares {} keys in {} bytes", where, keys, end - begin));
  }
}

/// Checks nested chunks, down to the tracks of key frames. Rejects a chunk that is longer than the rest of
/// its parent: the importer would read all of it before it fails.
void check_3ds_chunks(const MeshFile& file, std::size_t begin, std::size_t end, std::size_t depth) {
  constexpr std::size_t kHead = 6;
  // The main chunk, its key frames, their nodes and the tracks of these: first and last identifier.
  constexpr std::array<std::array<unsigned, 2>, 4> kChunks{
      {{0x4D4D, 0x4D4D}, {0xB000, 0xB000}, {0xB001, 0xB007}, {0xB020, 0xB029}}};
  constexpr unsigned kProject = 0xC23D;  // another identifier of the main chunk
  while (begin + kHead <= end) {
    const std::size_t length = little_endian_32(file.bytes, begin + 2);
    if (length < kHead || length > end - begin) {
      throw InputError(fmt::format(
          "{}, byte {}: a chunk declares {} bytes, must be 6 to {}, which are left of the one around it",
          to_text(file.path), begin, length, end - begin));
    }
    const auto low = static_cast<unsigned char>(file.bytes[begin]);
    const auto high = static_cast<unsigned char>(file.bytes[begin + 1]);
    const unsigned id = 256U * high + low;
    if ((id >= kChunks[depth][0] && id <= kChunks[depth][1]) || (depth == 0 && id == kProject)) {
      if (depth + 1 < kChunks.size()) {
        check_3ds_chunks(file, begin + kHead, begin + length, depth + 1);
      } else {
        check_3ds_track(file, begin + kHead, begin + length);
      }
    }
    begin += length;
  }
}

void check_3ds(const MeshFile& file) {
  const std::string& bytes = file.bytes;
  if (bytes.size() < 6 || bytes.compare(0, 2, "MM") != 0) {
    throw InputError(to_text(file.path) + ": not a 3DS file: must start with the chunk 4D4D");
  }
  const std::size_t declared = little_endian_32(bytes, 2);
  if (declared > bytes.size()) {
    throw InputError(
        fmt::format("{}: truncated: declares {} bytes, has {}", to_text(file.path), declared, bytes.size()));
  }
  check_3ds_chunks(file, 0, bytes.size(), 0);
}

}  // namespace

ImportedMesh read_3ds(const MeshFile& file) {
  check_3ds(file);
  return read_by_assimp(file);
}

}  // namespace palpate::mesh_io

#include "io/scene/organ_cache.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/index.h"
#include "io/system/cache_folder.h"
#include "io/system/path_text.h"
#include "palpate/organ_cache.h"

namespace palpate::scene {
namespace {

namespace fs = std::filesystem;
using contact::OrganArrays;
using contact::ReadOrgan;
using contact::ResponseArrays;

constexpr const char* kEnding = ".organ";
constexpr const char* kMeshEnding = ".mesh";
constexpr const char* kMapEnding = ".factors";
constexpr const char* kResponseEnding = ".response";
constexpr std::uint64_t kMaxOthers = 1ULL << 28;  // bytes: ten meshes of a million triangles; 28 responses
constexpr std::uint64_t kMaxCached = 1ULL << 30;  // bytes: about ten organs of a million triangles

bool all_within(const std::vector<std::array<std::int32_t, 3>>& rows, std::int32_t lowest, std::size_t end) {
  return std::all_of(rows.begin(), rows.end(), [&](const std::array<std::int32_t, 3>& row) {
    return std::all_of(row.begin(), row.end(),
                       [&](std::int32_t i) { return i >= lowest && (i < 0 || at(i) < end); });
  });
}

std::vector<char> lines_of(const std::vector<std::string>& texts) {
  std::vector<char> lines;
  for (const std::string& text : texts) {
    lines.insert(lines.end(), text.begin(), text.end());
    lines.push_back('\n');
  }
  return lines;
}

std::vector<std::string> texts_of(const std::vector<char>& lines) {
  std::vector<std::string> texts;
  for (auto begin = lines.begin(); begin != lines.end();) {
    const auto end = std::find(begin, lines.end(), '\n');
    texts.emplace_back(begin, end);
    begin = end == lines.end() ? end : end + 1;
  }
  return texts;
}

/// Whether a refined surface is finite and inside the bounding box of the organ that it was made from.
bool lies_within(const geometry::TriangleMesh& refined, const geometry::TriangleMesh& organ) {
  const geometry::Bounds box = geometry::bounds(organ);
  const double rounding = 1e-9 * box.size().norm();
  return std::all_of(refined.vertices.begin(), refined.vertices.end(), [&](const Vec3& v) {
    return ((v - box.low).array() >= -rounding).all() && ((box.high - v).array() >= -rounding).all();
  });
}

/// The folder of prepared organs.
class OrganCache final : public contact::OrganStore {
 public:
  OrganCache(fs::path folder, std::function<void(const std::string&)> remark)
      : folder_(std::move(folder)), remark_(std::move(remark)) {}

  [[nodiscard]] std::optional<ReadOrgan> load_read(const ContentHash& key) const override {
    const std::optional<ArrayFileReader> reader = open(key, kMeshEnding);
    ReadOrgan organ;
    std::vector<char> repairs;
    std::vector<char> remarks;
    std::vector<char> space;
    if (!reader || !reader->get("vertices", organ.mesh.vertices) ||
        !reader->get("triangles", organ.mesh.triangles) || !reader->get("repairs", repairs) ||
        !reader->get("remarks", remarks) || !reader->get("space", space) ||
        !all_within(organ.mesh.triangles, 0, organ.mesh.vertices.size()) ||
        !lies_within(organ.mesh, organ.mesh))
      return std::nullopt;
    organ.repairs = texts_of(repairs);
    organ.remarks = texts_of(remarks);
    organ.space.assign(space.begin(), space.end());
    return organ;
  }

  void store_read(const ContentHash& key, const ReadOrgan& organ) const override {
    keep(key, kMeshEnding, kMaxOthers, "the organ's mesh", [&organ](ArrayFileWriter& file) {
      file.put("vertices", organ.mesh.vertices);
      file.put("triangles", organ.mesh.triangles);
      file.put("repairs", lines_of(organ.repairs));
      file.put("remarks", lines_of(organ.remarks));
      file.put("space", std::span<const char>(organ.space));
    });
  }

  [[nodiscard]] std::optional<OrganArrays> load(const geometry::TriangleMesh& organ,
                                                double reference_radius) const override {
    const ContentHash key = contact::organ_key(organ, reference_radius);
    const fs::path file = file_of(key, kEnding);
    std::error_code error;  // an error counts as absent: the organ is prepared again
    if (!fs::exists(file, error)) {
      report("the cache does not have this organ: " + to_text(file));
      return std::nullopt;
    }
    const std::optional<ArrayFileReader> reader = open(key, kEnding);
    std::optional<OrganArrays> arrays = reader ? get(*reader) : std::nullopt;
    if (arrays && !lies_within(arrays->mesh, organ)) arrays.reset();
    if (!arrays) {
      report(
          "the cached organ is damaged, of another version or open to other users, and is computed again: " +
          to_text(file));
      return std::nullopt;
    }
    report("prepared organ taken from the cache: " + to_text(file));
    return arrays;
  }

  void store(const geometry::TriangleMesh& organ, double reference_radius,
             const OrganArrays& arrays) const override {
    keep(contact::organ_key(organ, reference_radius), kEnding, kMaxCached, "the prepared organ",
         [&arrays](ArrayFileWriter& file) { put(arrays, file); });
  }

  [[nodiscard]] std::vector<double> load_factors(const ContentHash& key) const override {
    const std::optional<ArrayFileReader> reader = open(key, kMapEnding);
    std::vector<double> factors;
    if (!reader || !reader->get("factors", factors)) return {};
    return factors;
  }

  void store_factors(const ContentHash& key, const std::vector<double>& factors) const override {
    keep(key, kMapEnding, kMaxOthers, "the stiffness map",
         [&factors](ArrayFileWriter& file) { file.put("factors", factors); });
  }

  [[nodiscard]] std::optional<ResponseArrays> load_response(const ContentHash& key) const override {
    const std::optional<ArrayFileReader> reader = open(key, kResponseEnding);
    ResponseArrays response;
    std::vector<double> edge;
    if (!reader || !reader->get("cell_edge", edge) || edge.size() != 1 ||
        !reader->get("scale", response.scale) || !reader->get("entries", response.entries))
      return std::nullopt;
    response.cell_edge = edge.front();
    return response;
  }

  void store_response(const ContentHash& key, const ResponseArrays& response) const override {
    keep(key, kResponseEnding, kMaxOthers, "the response", [&response](ArrayFileWriter& file) {
      file.put("cell_edge", std::span(&response.cell_edge, 1));
      file.put("scale", response.scale);
      file.put("entries", response.entries);
    });
  }

 private:
  /// Opens a file and marks it as used: the least recently used files are removed first.
  [[nodiscard]] std::optional<ArrayFileReader> open(const ContentHash& key, const char* ending) const {
    std::optional<ArrayFileReader> reader = ArrayFileReader::open(file_of(key, ending), key);
    std::error_code error;
    if (reader) fs::last_write_time(file_of(key, ending), fs::file_time_type::clock::now(), error);
    return reader;
  }

  /// Writes the file that `fill` fills, and removes others until all with its ending have at most `most`
  /// bytes.
  template <typename Fill>
  void keep(const ContentHash& key, const char* ending, std::uint64_t most, const char* what,
            const Fill& fill) const {
    bool kept = make_private_folder(folder_);
    if (kept) {
      ArrayFileWriter writer(file_of(key, ending), key);
      fill(writer);
      kept = writer.commit();
      trim_cache(folder_, ending, most);
    }
    if (!kept) report(std::string(what) + " could not be kept as " + to_text(file_of(key, ending)));
  }

  [[nodiscard]] fs::path file_of(const ContentHash& key, const char* ending) const {
    return folder_ / (key.hexadecimal() + ending);
  }
  void report(const std::string& text) const {
    if (remark_) remark_(text);
  }

  fs::path folder_;
  std::function<void(const std::string&)> remark_;
};

bool all_within(const std::vector<std::int32_t>& list, std::int32_t lowest, std::size_t end) {
  return std::all_of(list.begin(), list.end(),
                     [&](std::int32_t i) { return i >= lowest && (i < 0 || at(i) < end); });
}

/// Whether no normal is longer than a unit vector, within rounding.
bool none_longer_than_one(const std::vector<Vec3>& normals) {
  constexpr double kRounding = 1e-6;
  return std::all_of(normals.begin(), normals.end(), [](const Vec3& normal) {
    return normal.squaredNorm() <= 1.0 + kRounding;  // false for NaN
  });
}

/// Whether all indices are in range and all numbers are possible. A file with a valid checksum may still have
/// been written by other code.
bool hangs_together(const OrganArrays& arrays) {
  const std::size_t triangles = arrays.mesh.triangles.size();
  const std::vector<std::int32_t>& start = arrays.sharp_start;
  return arrays.neighbours.size() == triangles && arrays.row_of.size() == triangles &&
         arrays.bends.size() == triangles && start.size() == triangles + 1 && start.front() == 0 &&
         at(start.back()) == arrays.sharp_near.size() && std::is_sorted(start.begin(), start.end()) &&
         arrays.normals.size() >= arrays.mesh.vertices.size() && none_longer_than_one(arrays.normals) &&
         all_within(arrays.mesh.triangles, 0, arrays.mesh.vertices.size()) &&
         all_within(arrays.neighbours, -1, triangles) &&
         all_within(arrays.row_of, -1, arrays.side_rows.size()) &&
         all_within(arrays.side_rows, 0, arrays.normals.size()) &&
         all_within(arrays.sharp_near, 0, arrays.sharp_edges.size()) &&
         std::all_of(arrays.sharp_edges.begin(), arrays.sharp_edges.end(),
                     [&](const contact::SharpEdge& sharp) {
                       return std::all_of(sharp.triangle.begin(), sharp.triangle.end(),
                                          [&](std::int32_t i) { return i >= 0 && at(i) < triangles; }) &&
                              std::all_of(sharp.edge.begin(), sharp.edge.end(),
                                          [](std::int32_t i) { return i >= 0 && i < 3; });
                     });
}

}  // namespace

fs::path organ_cache_folder() { return user_cache_folder(); }

void use_organ_cache(contact::Preparation& how, fs::path folder,
                     std::function<void(const std::string&)> remark,
                     const std::function<void(const std::string&)>& distrusted) {
  if (folder.empty()) return;
  if (const std::string why = distrust_reason(folder); !why.empty()) {
    if (distrusted) distrusted("the cache of prepared organs is not used: " + why);
    return;
  }
  how.store = std::make_shared<const OrganCache>(std::move(folder), std::move(remark));
}

void put(const OrganArrays& arrays, ArrayFileWriter& file) {
  file.put("vertices", arrays.mesh.vertices);
  file.put("triangles", arrays.mesh.triangles);
  file.put("neighbours", arrays.neighbours);
  file.put("normals", arrays.normals);
  file.put("bends", arrays.bends);
  file.put("row_of", arrays.row_of);
  file.put("side_rows", arrays.side_rows);
  file.put("sharp_edges", arrays.sharp_edges);
  file.put("sharp_start", arrays.sharp_start);
  file.put("sharp_near", arrays.sharp_near);
}

std::optional<OrganArrays> get(const ArrayFileReader& file) {
  OrganArrays arrays;
  const bool whole = file.get("vertices", arrays.mesh.vertices) &&
                     file.get("triangles", arrays.mesh.triangles) &&
                     file.get("neighbours", arrays.neighbours) && file.get("normals", arrays.normals) &&
                     file.get("bends", arrays.bends) && file.get("row_of", arrays.row_of) &&
                     file.get("side_rows", arrays.side_rows) && file.get("sharp_edges", arrays.sharp_edges) &&
                     file.get("sharp_start", arrays.sharp_start) && file.get("sharp_near", arrays.sharp_near);
  if (!whole || !hangs_together(arrays)) return std::nullopt;
  return arrays;
}

}  // namespace palpate::scene

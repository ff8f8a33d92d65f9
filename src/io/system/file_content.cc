#include "io/system/file_content.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate {
namespace {

constexpr std::size_t kRead = std::size_t{64} << 10U;  // bytes
constexpr InputKind kReadableFile{"a file", std::uint64_t{1} << 40U};
constexpr const char* kMeshUse = "palpate inspect, --organ and --tool read it";
constexpr const char* kSceneUse = "palpate run, serve and sweep read it";
constexpr const char* kVolumeUse = "segment it, in 3D Slicer for example, and save the surface as STL";

ContentFacts mesh(const char* format, const char* extension) {
  return {FileContent::kMesh, std::string("a mesh (") + format + ")", kMeshUse, extension};
}

ContentFacts other(const char* name, const char* use) { return {FileContent::kOther, name, use, ""}; }

ContentFacts vtk_xml() {
  return other("an XML file of VTK", "save it as legacy VTK (.vtk) or STL; palpate inspect reads that");
}

/// Contents by the first bytes of a file.
const std::vector<std::pair<std::string_view, ContentFacts>>& signatures() {
  constexpr const char* kImageUse = "palpate validate reads photographs (docs/photographs.md)";
  static const std::vector<std::pair<std::string_view, ContentFacts>> kAll = {
      {"\x89HDF\r\n\x1a\n",
       {FileContent::kRecording, "a recording (HDF5)",
        "palpate view, replay, export, score and --device replay:FILE read it", ""}},
      {"\x89PNG", other("a PNG picture", kImageUse)},
      {"\xff\xd8\xff", other("a JPEG picture", kImageUse)},
      {{"II*\0", 4}, other("a TIFF picture", "save it as PNG; palpate validate reads that")},
      {{"MM\0*", 4}, other("a TIFF picture", "save it as PNG; palpate validate reads that")},
      {"%PDF", other("a PDF document", "palpate reads none")},
      {"PK\x03\x04", other("a ZIP archive or an Office document", "unpack it, or save a sheet as CSV")},
      {"\x1f\x8b", other("a file compressed by gzip", "unpack it first")},
      {"MATLAB ", other("a MATLAB file", "save the table as CSV, by writetable")},
      {"\x93NUMPY", other("a NumPy file", "save the array as CSV, with a header")},
      {"#ROSBAG", other("a ROS bag", "write a topic as CSV, by rostopic echo -p")},
      {"version https://git-lfs", other("a pointer of Git LFS", "git lfs pull fetches the file itself")},
      {"NRRD", other("an image volume (NRRD)", kVolumeUse)},
      {"<VTKFile", vtk_xml()},
      {"glTF", mesh("binary glTF", ".glb")},
      {"ply\n", mesh("PLY", ".ply")},
      {"ply\r", mesh("PLY", ".ply")},
      {"OFF\n", mesh("OFF", ".off")},
      {"OFF\r", mesh("OFF", ".off")},
      {"# vtk DataFile", mesh("legacy VTK", ".vtk")},
      {"$MeshFormat", mesh("Gmsh", ".msh")}};
  return kAll;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.size(), text.find_first_of("\r\n"));
    if (const std::string_view line = trimmed(text.substr(0, end)); !line.empty()) lines.push_back(line);
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return lines;
}

/// The tables of a TOML file tell what it is.
ContentFacts toml_of(const std::vector<std::string_view>& lines) {
  const auto has = [&](std::string_view table) {
    return std::any_of(lines.begin(), lines.end(), [&](std::string_view line) {
      const std::size_t name = line.find_first_not_of("[ ");
      return line.front() == '[' && name != std::string_view::npos && line.substr(name).starts_with(table) &&
             line.substr(name + table.size()).find_first_of("].") == 0;
    });
  };
  if (has("study")) return {FileContent::kStudy, "a study file", "palpate study check reads it", ""};
  if (has("scene") || has("organ") || has("tool")) return {FileContent::kScene, "a scene", kSceneUse, ""};
  if (has("tissue")) return {FileContent::kTissue, "a tissue file", "--tissue FILE reads it", ""};
  return {};
}

/// A table by the columns of its first line that is no comment.
ContentFacts csv_of(const std::vector<std::string_view>& lines) {
  const auto header =
      std::find_if(lines.begin(), lines.end(), [](std::string_view line) { return line.front() != '#'; });
  if (header == lines.end()) return {};
  std::vector<std::string> names;
  for (std::string_view rest = *header;;) {
    const std::size_t end = std::min(rest.size(), rest.find_first_of(",;\t"));
    std::string name(trimmed(rest.substr(0, end)));
    std::erase(name, '"');
    names.push_back(std::move(name));
    if (end == rest.size()) return table_of(names);
    rest.remove_prefix(end + 1);
  }
}

/// OBJ has no signature: its first words are keywords, and some are v.
bool is_obj(const std::vector<std::string_view>& lines) {
  constexpr std::array<std::string_view, 11> kWords = {"v", "vn", "vt", "vp",     "f",     "l",
                                                       "o", "g",  "s",  "usemtl", "mtllib"};
  bool has_vertex = false;
  const std::size_t most = std::min<std::size_t>(lines.size(), 50);
  for (std::size_t n = 0; n < most; ++n) {
    const std::string_view word = lines[n].substr(0, lines[n].find_first_of(" \t"));
    if (word.front() == '#') continue;
    if (std::find(kWords.begin(), kWords.end(), word) == kWords.end()) return false;
    has_vertex = has_vertex || word == "v";
  }
  return has_vertex;
}

/// @param is_whole whether this is all of the file
ContentFacts text_of(std::string_view text, bool is_whole) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::vector<std::string_view> lines = lines_of(text);
  if (lines.empty()) return {};
  const std::string first = lower_case(lines.front().substr(0, 200));
  if (first.starts_with("<!doctype html") || first.starts_with("<html")) {
    return other("an HTML page, such as a report", "open it in a browser");
  }
  if (first.starts_with("<?xml") || first.starts_with("<svg")) {
    if (contains(text, "<VTKFile")) return vtk_xml();
    return other("an XML file", "palpate reads none");
  }
  if (first.starts_with("solid") && contains(lower_case(text.substr(0, 4096)), "facet")) {
    return mesh("text STL", ".stl");
  }
  if (first.front() == '{' && contains(text, "\"asset\"")) return mesh("glTF", ".gltf");
  if (first.front() == '{' && is_whole) {  // a longer glTF file may have its "asset" further on
    return other("a JSON document", "palpate reads none but those of a study");
  }
  for (const ContentFacts& facts : {toml_of(lines), csv_of(lines)}) {
    if (facts.content != FileContent::kUnknown) return facts;
  }
  return is_obj(lines) ? mesh("OBJ", ".obj") : ContentFacts{};
}

/// Whether the number of triangles in a binary STL's header makes the file's size.
bool is_binary_stl(std::string_view start, std::uint64_t size) {
  constexpr std::size_t kHeader = 84;
  constexpr std::uint64_t kTriangle = 50;
  if (start.size() < kHeader) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, start.data() + 80, sizeof triangles);
  return triangles > 0 && size == kHeader + kTriangle * triangles;
}

ContentFacts facts_of(std::string_view start, std::uint64_t size) {
  for (const auto& [signature, facts] : signatures()) {
    if (start.starts_with(signature)) return facts;
  }
  if (is_binary_stl(start, size)) return mesh("binary STL", ".stl");
  if (start.size() > 132 && start.substr(128, 4) == "DICM") {
    return other("a DICOM image", kVolumeUse);
  }
  if (start.starts_with("MM") && start.size() >= 6) {
    std::uint32_t length = 0;
    std::memcpy(&length, start.data() + 2, sizeof length);
    if (length > 6 && length <= size) return mesh("3DS", ".3ds");
  }
  if (contains(start, std::string_view("\0", 1))) return {};
  return text_of(start, start.size() == size);
}

ContentFacts folder_facts(const std::filesystem::path& folder) {
  if (file_exists(folder / "lock.json") || file_exists(folder / "study.toml")) {
    return {FileContent::kOther, "the folder of a study", "palpate study status reads it", ""};
  }
  if (file_exists(folder / "report.html")) {
    return other("the folder of a report", "open its report.html in a browser");
  }
  return {};
}

}  // namespace

ContentFacts find_content(const std::filesystem::path& file) {
  try {
    if (folder_exists(file)) return folder_facts(file);
    InputFile in(file, kReadableFile);
    std::string start(kRead, '\0');
    start.resize(in.read(start));
    return facts_of(start, in.size());
  } catch (const InputError&) {
    return {};  // the reader itself says why
  }
}

ContentFacts table_of(std::span<const std::string> columns) {
  struct Table {
    std::vector<std::string_view> required;
    const char* name;
    const char* use;
  };
  static const std::vector<Table> kTables = {
      {{"tick", "time_s", "hand", "phase"},
       "the ticks of a recording as CSV",
       "palpate export wrote it; commands read the recording (.h5) itself"},
      {{"time_s", "x_m", "y_m", "z_m"}, "a tool path (CSV)", "--device scripted:FILE reads it"},
      {{"probe", "x_mm", "y_mm", "z_mm", "depth_mm", "force_N"},
       "a map of probes (CSV)",
       "palpate fit --map reads it"},
      {{"x_mm", "y_mm", "z_mm", "factor"},
       "a stiffness map (CSV)",
       "[organ.stiffness] map = \"FILE\" in a scene reads it"},
      {{"displacement_mm", "force_N"}, "a measured curve (CSV)", "palpate fit and validate read it"},
      {{"r_mm", "u_mm"}, "a displacement profile (CSV)", "palpate validate --profile reads it"},
      {{"participant", "trial_number"}, "a study's trials (CSV)", "no command reads it back"}};
  for (const Table& table : kTables) {
    const bool has_all =
        std::all_of(table.required.begin(), table.required.end(), [&](std::string_view name) {
          return std::find(columns.begin(), columns.end(), name) != columns.end();
        });
    if (has_all) return {FileContent::kTable, table.name, table.use, ""};
  }
  return {};
}

ContentFacts refuse_other_content(const std::filesystem::path& file, FileContent wanted,
                                  std::string_view must_be) {
  ContentFacts found = find_content(file);
  if (found.content == FileContent::kUnknown || found.content == wanted) return found;
  std::string use = found.use;
  // What a person who runs a file that is no scene most likely wants.
  if (wanted == FileContent::kScene && found.content == FileContent::kRecording)
    use = "palpate view " + to_text(file) + " shows it; " + use;
  if (wanted == FileContent::kScene && found.content == FileContent::kMesh)
    use = "palpate run --organ " + to_text(file) + " --organ-unit mm presses it; " + use;
  throw InputError(to_text(file) + ": is " + found.name + ", must be " + std::string(must_be) + "; " + use);
}

}  // namespace palpate

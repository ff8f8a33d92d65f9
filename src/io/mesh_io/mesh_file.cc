#include "io/mesh_io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/system/file_content.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/read_mesh.h"

namespace palpate::mesh_io {
namespace {

struct Reader {
  std::string_view ending;
  MeshFormat format;
  ImportedMesh (*read)(const MeshFile& file);
};

constexpr std::array<Reader, 9> kReaders{{{".stl", MeshFormat::kStl, read_stl},
                                          {".obj", MeshFormat::kObj, read_obj},
                                          {".ply", MeshFormat::kPly, read_ply},
                                          {".off", MeshFormat::kOff, read_off},
                                          {".3ds", MeshFormat::k3ds, read_3ds},
                                          {".gltf", MeshFormat::kGltf, read_gltf},
                                          {".glb", MeshFormat::kGlb, read_gltf},
                                          {".vtk", MeshFormat::kVtk, read_vtk},
                                          {".msh", MeshFormat::kMsh, read_msh}}};

/// @throws InputError for UTF-16, another content, and a mesh of another format than its name's extension
/// says
void refuse_other_format(const MeshFile& file) {
  const ContentFacts found = refuse_other_content(file.path, FileContent::kMesh, "a mesh file");
  if (file.bytes.starts_with("\xFF\xFE") || file.bytes.starts_with("\xFE\xFF")) {
    throw InputError(to_text(file.path) + ": is UTF-16, must be binary or UTF-8");
  }
  if (found.content != FileContent::kMesh || mesh_format("a" + found.extension) == file.format) return;
  throw InputError(
      fmt::format("{}: is {}: its name must end in {}", to_text(file.path), found.name, found.extension));
}

/// The letters at the start of a text, in upper case, at most eight.
std::string leading_letters(std::string_view text) {
  constexpr std::size_t kMost = 8;
  std::string letters;
  for (const char c : text.substr(0, kMost)) {
    if (std::isalpha(static_cast<unsigned char>(c)) == 0) break;
    letters += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return letters;
}

/// The part of a file before its coordinates.
std::string_view header_of(const MeshFile& file) {
  constexpr std::size_t kMost = 4096;  // bytes
  constexpr std::size_t kStlHeader = 80;
  const std::string_view start = std::string_view(file.bytes).substr(0, kMost);
  const auto until = [start](std::string_view end) { return start.substr(0, start.find(end)); };
  switch (file.format) {
    case MeshFormat::kStl:
      return until("facet").substr(0, kStlHeader);
    case MeshFormat::kPly:
      return until("end_header");
    case MeshFormat::kObj:
      return until("\nv ");
    case MeshFormat::kVtk:
      return until("\nPOINTS");
    default:
      return {};
  }
}

/// The text after the first `word` that does not end a longer one, as in COLORSPACE; empty: there is none.
std::string_view after_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const unsigned char before = at == 0 ? ' ' : static_cast<unsigned char>(text[at - 1]);
    if (std::isalnum(before) == 0 && before != '_') return text.substr(at + word.size());
  }
  return {};
}

/// The axes that a header names in another way than 3D Slicer: "CoordinateSystem = LPS", or in NRRD's words,
/// "space: left-posterior-superior". Empty: none.
std::string otherwise_declared(std::string_view header) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kNames = {
      {{"lps", "LPS"},
       {"ras", "RAS"},
       {"left-posterior-superior", "LPS"},
       {"right-anterior-superior", "RAS"}}};
  const std::string text = lower_case(header);
  for (const std::string_view word : {"space", "coordinatesystem", "coordinate system"}) {
    std::string_view rest = after_word(text, word);
    const std::size_t value = std::min(rest.find_first_not_of(" =:"), rest.size());
    if (rest.substr(0, value).find_first_of("=:") == std::string_view::npos) continue;
    rest.remove_prefix(value);
    for (const auto& [name, axes] : kNames) {
      const bool ends =
          rest.size() <= name.size() || std::isalnum(static_cast<unsigned char>(rest[name.size()])) == 0;
      if (rest.starts_with(name) && ends) return std::string(axes);
    }
  }
  return {};
}

}  // namespace

std::string declared_space(const MeshFile& file) {
  constexpr std::string_view kTag = "SPACE=";
  constexpr std::string_view kArray = "SPACE 1 1 string";  // of field data; the text is in the next line
  const std::string_view header = header_of(file);
  if (std::string declared = leading_letters(after_word(header, kTag)); !declared.empty()) return declared;
  if (std::string declared = otherwise_declared(header); !declared.empty()) return declared;
  const std::string_view rest = after_word(header, kArray);
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  const auto first = std::find_if(rest.begin(), rest.end(), is_letter);  // after the length in binary files
  return leading_letters(rest.substr(static_cast<std::size_t>(first - rest.begin())));
}

std::vector<std::string> mesh_file_extensions() {
  std::vector<std::string> endings;
  for (const Reader& reader : kReaders) endings.emplace_back(reader.ending);
  return endings;
}

std::optional<MeshFormat> mesh_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(to_text(path.extension()));
  for (const Reader& reader : kReaders) {
    if (reader.ending == ending) return reader.format;
  }
  return std::nullopt;
}

bool is_mesh_file(const std::filesystem::path& path) { return mesh_format(path).has_value(); }

MeshFile open_mesh_file(const std::filesystem::path& path) {
  InputFile input(path, kMeshInput);
  const std::optional<MeshFormat> format = mesh_format(path);
  if (!format) {
    refuse_other_content(path, FileContent::kMesh, "a mesh file");
    throw InputError(fmt::format("{}: unknown file name extension \"{}\": must be one of {}", to_text(path),
                                 to_text(path.extension()), joined(mesh_file_extensions())));
  }
  MeshFile file{path, *format, input.read_rest()};
  if (file.bytes.empty()) throw InputError(to_text(path) + ": empty");
  return file;
}

void note_parts(ImportedMesh& imported, std::size_t mirrored, std::size_t lines) {
  if (mirrored > 0) {
    imported.repairs.push_back(fmt::format("turned the triangles of {} outwards",
                                           counted(mirrored, "mirrored part", "mirrored parts")));
  }
  if (lines > 0) imported.repairs.push_back("dropped " + counted(lines, "line or point", "lines or points"));
}

ImportedMesh import_mesh(const MeshFile& file) {
  const auto* const reader = std::find_if(kReaders.begin(), kReaders.end(),
                                          [&](const Reader& known) { return known.format == file.format; });
  try {
    ImportedMesh mesh = reader->read(file);
    if (mesh.mesh.triangles.empty()) refuse_other_format(file);  // an OBJ reader skips what it does not know
    return mesh;
  } catch (const InputError&) {
    refuse_other_format(file);
    throw;
  }
}

}  // namespace palpate::mesh_io

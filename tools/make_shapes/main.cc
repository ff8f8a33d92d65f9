// Makes the built-in organs and instruments, for maintainers:
//
//   make_shapes FOLDER           writes shapes.bin and shapes.txt (the repository's assets/)
//   make_shapes --check FOLDER   exit 1 when the shapes differ from those of shapes.txt
//   make_shapes --vessels        prints src/view/render/organ_vessels.inc
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/content_hash.h"
#include "io/shapes/mesh_archive.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/tool.h"
#include "palpate/units.h"

#include "tools/make_shapes/forceps.h"
#include "tools/make_shapes/organs.h"
#include "tools/make_shapes/pack_mesh.h"

namespace palpate::geometry {

namespace {

struct Organ {
  const char* name;
  TriangleMesh (*make)(Detail);
};
constexpr Organ kOrgans[]{
    {"gallbladder", make_gallbladder}, {"heart", make_heart}, {"liver", make_liver}, {"kidney", make_kidney}};

/// A resolution: the suffix of its names, and the packing of its meshes. Meshes with the paper's counts keep
/// all bits, because the golden hashes depend on them; vertices of finer ones are rounded to 2 micrometres.
struct Resolution {
  Detail detail;
  const char* ending;
  Packing packing;
};
constexpr Resolution kResolutions[]{{Detail::kPaper, "", {}},
                                    {Detail::k30k, "-30k", {.grid = 19}},
                                    {Detail::k75k, "-300k", {.grid = 19, .divisions = 1}}};

TriangleMesh centred(TriangleMesh mesh) {
  const Vec3 middle = bounds(mesh).middle();
  for (Vec3& v : mesh.vertices) v -= middle;
  return mesh;
}

class Archive final {
 public:
  void add(const std::string& name, const TriangleMesh& mesh, const Packing& packing) {
    pack_mesh(bytes, name, mesh, packing);
    const TriangleMesh read =
        unpack_mesh({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, name);
    ContentHasher hasher;
    hasher.add(std::span(read.vertices)).add(std::span(read.triangles));
    list += fmt::format("{} {} {} {}\n", name, read.vertices.size(), read.triangles.size(),
                        hasher.hash().hexadecimal());
  }

  std::string bytes;
  std::string list;  // one line per mesh: name, vertices, triangles, hash
};

Archive make_all() {
  Archive archive;
  for (const auto& [detail, ending, packing] : kResolutions) {
    for (const auto& [name, make] : kOrgans)
      archive.add(std::string(name) + ending, centred(make(detail)), packing);
    const Tool curved = make_curved_forceps(detail);
    const Tool straight = make_straight_forceps(detail);
    for (std::size_t jaw = 0; jaw < 2; ++jaw) {
      for (const auto& [name, tool] :
           {std::pair{"curved-forceps", &curved}, std::pair{"straight-forceps", &straight}}) {
        const ToolPart& part = tool->parts[jaw];
        archive.add(fmt::format("{}{}/{}", name, ending, part.name), part.mesh, packing);
      }
    }
    archive.add(std::string("shaft") + ending, curved.parts.back().mesh, packing);
  }
  return archive;
}

void write(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  if (!(out << bytes) || !out.flush()) throw InputError(file.string() + ": cannot be written");
}

// The vessels' lines as rows of C++, in millimetres of the centred organs' frame.
void print_vessels() {
  struct Lines {
    const char* organ;
    TriangleMesh (*make)(Detail);
    std::vector<VesselLine> (*lines)();
  };
  fmt::print("// By `make_shapes --vessels`. Organ, kind, and x, y, z and radius along the line [mm].\n");
  for (const Lines& of :
       {Lines{"heart", make_heart, heart_vessels}, Lines{"kidney", make_kidney, kidney_vessels},
        Lines{"liver", make_liver, liver_vessels}}) {
    const Vec3 middle = bounds(of.make(Detail::k30k)).middle() / kMillimetre;
    for (const VesselLine& line : of.lines()) {
      fmt::print("{{\"{}\", VesselKind::k{}{}, {{", of.organ, static_cast<char>(line.kind[0] - 'a' + 'A'),
                 line.kind.substr(1));
      for (const TubeKnot& knot : line.knots) {
        const Vec3 p = knot.middle - middle;
        fmt::print("{{{:.1f}F, {:.1f}F, {:.1f}F, {:.1f}F}},", p.x(), p.y(), p.z(), knot.radius);
      }
      fmt::print("}}}},\n");
    }
  }
}

int run(const std::vector<std::string>& arguments) {
  if (arguments == std::vector<std::string>{"--vessels"}) {
    print_vessels();
    return 0;
  }
  const bool check = arguments.size() == 2 && arguments[0] == "--check";
  if (!check && arguments.size() != 1)
    throw InputError("usage: make_shapes [--check] FOLDER, or make_shapes --vessels");
  const std::filesystem::path folder = arguments.back();
  const Archive archive = make_all();
  if (check) {
    std::ifstream in(folder / "shapes.txt");
    const std::string list{std::istreambuf_iterator<char>(in), {}};
    if (list != archive.list)
      throw InputError((folder / "shapes.txt").string() + " is not of these shapes:\n" + archive.list);
  } else {
    write(folder / "shapes.bin", archive.bytes);
    write(folder / "shapes.txt", archive.list);
  }
  fmt::print("{}{} bytes\n", archive.list, archive.bytes.size());
  return 0;
}

}  // namespace

}  // namespace palpate::geometry

int main(int argc, char** argv) try {
  return palpate::geometry::run({argv + 1, argv + argc});
} catch (const std::exception& error) {
  std::cerr << "make_shapes: " << error.what() << '\n';
  return 1;
}

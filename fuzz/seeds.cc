// Writes seed files for every fuzz target, small valid ones and deeply nested ones: FOLDER/TARGET/NAME.
// Usage: palpate_fuzz_seeds FOLDER
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/igtl/igtl_messages.h"
#include "io/record/hdf5_handle.h"
#include "io/record/scene_json.h"
#include "io/record/test/sample_recording.h"
#include "io/system/array_file.h"
#include "io/system/base64.h"
#include "palpate/error.h"
#include "palpate/scene.h"
#include "palpate/tissue.h"

#include "fuzz/seed_texts.h"

namespace {

using namespace palpate;
using fuzz::kHaplyMessage;
using fuzz::kLiveMessages;
using fuzz::kScene;
using fuzz::kStudy;
using fuzz::kTrialLog;

using Face = std::vector<int>;

struct Shape {
  std::string name;
  std::vector<std::array<float, 3>> vertices;  // mm
  std::vector<Face> faces;
};

const std::vector<Shape> kShapes{
    {"tetrahedron",
     {{0, 0, 0}, {20, 0, 0}, {0, 30, 0}, {0, 0, 40}},
     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}},
    {"open", {{0, 0, 0}, {20, 0, 0}, {0, 30, 0}, {0, 0, 40}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}}},
    {"two",  // touching in a vertex, one inside out
     {{0, 0, 0}, {20, 0, 0}, {0, 30, 0}, {0, 0, 40}, {-20, 0, 0}, {0, -30, 0}, {0, 0, -40}},
     {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 5, 4}, {0, 4, 6}, {4, 5, 6}, {0, 6, 5}}},
    {"cube",
     {{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}, {0, 0, 20}, {20, 0, 20}, {20, 20, 20}, {0, 20, 20}},
     {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}};

template <typename T>
std::string little_endian(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

template <typename T>
std::string big_endian(T value) {
  const std::string bytes = little_endian(value);
  return {bytes.rbegin(), bytes.rend()};
}

std::uint32_t count_of(const std::string& bytes) { return static_cast<std::uint32_t>(bytes.size()); }

std::string numbers(const std::array<float, 3>& vertex) {
  return std::to_string(vertex[0]) + ' ' + std::to_string(vertex[1]) + ' ' + std::to_string(vertex[2]);
}

/// Splits all faces into triangle fans.
std::vector<Face> triangles(const Shape& shape) {
  std::vector<Face> cut;
  for (const Face& face : shape.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) cut.push_back({face[0], face[k - 1], face[k]});
  }
  return cut;
}

std::string text_stl(const Shape& shape) {
  std::string text = "solid a\n";
  for (const Face& face : triangles(shape)) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int v : face) text += "vertex " + numbers(shape.vertices[static_cast<std::size_t>(v)]) + '\n';
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid a\n";
}

std::string binary_stl(const Shape& shape) {
  const std::vector<Face> cut = triangles(shape);
  std::string bytes(80, ' ');
  bytes += little_endian(static_cast<std::uint32_t>(cut.size()));
  for (const Face& face : cut) {
    bytes += std::string(12, '\0');
    for (const int v : face) {
      for (const float x : shape.vertices[static_cast<std::size_t>(v)]) bytes += little_endian(x);
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string obj(const Shape& shape) {
  std::string text = "# a comment\no a\n";
  for (const auto& vertex : shape.vertices) text += "v " + numbers(vertex) + '\n';
  for (const Face& face : shape.faces) {
    text += 'f';
    for (const int v : face) text += ' ' + std::to_string(v + 1);
    text += '\n';
  }
  return text + "f -1/1/1 -2//1 -3/1\nl 1 2\n";
}

/// One line per face: its number of corners, then the corners.
std::string face_lines(const Shape& shape) {
  std::string text;
  for (const Face& face : shape.faces) {
    text += std::to_string(face.size());
    for (const int v : face) text += ' ' + std::to_string(v);
    text += '\n';
  }
  return text;
}

std::string vertex_lines(const Shape& shape) {
  std::string text;
  for (const auto& vertex : shape.vertices) text += numbers(vertex) + '\n';
  return text;
}

std::string off(const Shape& shape) {
  return "OFF\n" + std::to_string(shape.vertices.size()) + ' ' + std::to_string(shape.faces.size()) + " 0\n" +
         vertex_lines(shape) + face_lines(shape);
}

std::string ply_header(const Shape& shape, const std::string& form) {
  return "ply\nformat " + form + " 1.0\ncomment a\nelement vertex " + std::to_string(shape.vertices.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(shape.faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string text_ply(const Shape& shape) {
  return ply_header(shape, "ascii") + vertex_lines(shape) + face_lines(shape);
}

std::string binary_ply(const Shape& shape) {
  std::string bytes = ply_header(shape, "binary_little_endian");
  for (const auto& vertex : shape.vertices) {
    for (const float x : vertex) bytes += little_endian(x);
  }
  for (const Face& face : shape.faces) {
    bytes += static_cast<char>(face.size());
    for (const int v : face) bytes += little_endian(v);
  }
  return bytes;
}

std::string chunk_3ds(std::uint16_t id, const std::string& content) {
  return little_endian(id) + little_endian(count_of(content) + 6) + content;
}

std::string three_ds(const Shape& shape) {
  const std::vector<Face> cut = triangles(shape);
  std::string vertices = little_endian(static_cast<std::uint16_t>(shape.vertices.size()));
  for (const auto& vertex : shape.vertices) {
    for (const float x : vertex) vertices += little_endian(x);
  }
  std::string faces = little_endian(static_cast<std::uint16_t>(cut.size()));
  for (const Face& face : cut) {
    for (const int v : face) faces += little_endian(static_cast<std::uint16_t>(v));
    faces += little_endian(std::uint16_t{7});
  }
  const std::string part =
      std::string("a") + '\0' + chunk_3ds(0x4100, chunk_3ds(0x4110, vertices) + chunk_3ds(0x4120, faces));
  return chunk_3ds(0x4d4d, chunk_3ds(0x3d3d, chunk_3ds(0x4000, part)));
}

/// Vertices, then triangles, as a glTF buffer.
std::string gltf_buffer(const Shape& shape) {
  std::string bytes;
  for (const auto& vertex : shape.vertices) {
    for (const float x : vertex) bytes += little_endian(x);
  }
  for (const Face& face : triangles(shape)) {
    for (const int v : face) bytes += little_endian(static_cast<std::uint16_t>(v));
  }
  return bytes;
}

std::string gltf_json(const Shape& shape, const std::string& uri) {
  const std::size_t places = 12 * shape.vertices.size();
  const std::size_t corners = 3 * triangles(shape).size();
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},)"
         R"({"mesh":0,"scale":[1,1,-1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
         R"("buffers":[{)" +
         uri + R"("byteLength":)" + std::to_string(places + 2 * corners) +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(places) +
         R"(},{"buffer":0,"byteOffset":)" + std::to_string(places) + R"(,"byteLength":)" +
         std::to_string(2 * corners) +
         R"(}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
         std::to_string(shape.vertices.size()) +
         R"(},{"bufferView":1,"componentType":5123,"type":"SCALAR","count":)" + std::to_string(corners) +
         "}]}";
}

std::string gltf(const Shape& shape) {
  return gltf_json(shape,
                   R"("uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer(shape)) + "\",");
}

std::string glb(const Shape& shape) {
  std::string json = gltf_json(shape, "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string buffer = gltf_buffer(shape);
  const std::string body = little_endian(count_of(json)) + "JSON" + json + little_endian(count_of(buffer)) +
                           std::string("BIN\0", 4) + buffer;
  return "glTF" + little_endian(std::uint32_t{2}) + little_endian(12 + count_of(body)) + body;
}

std::string vtk_numbers(const Shape& shape) {
  std::size_t numbers = 0;
  for (const Face& face : shape.faces) numbers += face.size() + 1;
  return std::to_string(shape.faces.size()) + ' ' + std::to_string(numbers) + '\n';
}

std::string text_vtk(const Shape& shape) {
  return "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS " +
         std::to_string(shape.vertices.size()) + " float\n" + vertex_lines(shape) + "POLYGONS " +
         vtk_numbers(shape) + face_lines(shape) + "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";
}

std::string binary_vtk(const Shape& shape) {
  std::string bytes = "# vtk DataFile Version 3.0\na\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                      std::to_string(shape.vertices.size()) + " double\n";
  for (const auto& vertex : shape.vertices) {
    for (const float x : vertex) bytes += big_endian(static_cast<double>(x));
  }
  bytes += "\nCELLS " + vtk_numbers(shape);
  for (const Face& face : shape.faces) {
    bytes += big_endian(static_cast<std::int32_t>(face.size()));
    for (const int v : face) bytes += big_endian(v);
  }
  bytes += "\nCELL_TYPES " + std::to_string(shape.faces.size()) + '\n';
  for (std::size_t f = 0; f < shape.faces.size(); ++f) bytes += big_endian(std::int32_t{7});  // polygon
  return bytes;
}

/// The file with strings and bits as field data, before its points.
std::string with_field_data(std::string vtk, bool is_binary) {
  const std::string space = is_binary ? std::string("\xc3LPS\x80\x02") + "ab\n" : "LPS\na%20b\n";
  const std::string bits = is_binary ? "\xff\n" : "1 1 1\n";
  return vtk.insert(vtk.find("POINTS"), "FIELD FieldData 2\nSPACE 1 2 string\n" + space +
                                            "METADATA\nINFORMATION 0\n\nflags 1 3 bit\n" + bits);
}

/// The file with its vertices' bytes taken for whole numbers.
std::string quantized(std::string gltf) {
  const std::string type = "\"componentType\":5126";
  return gltf.replace(gltf.find(type), type.size(), "\"componentType\":5122,\"normalized\":true");
}

std::string in_upper_case(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

std::string utf16(const std::string& ascii) {
  std::string bytes = "\xff\xfe";
  for (const char c : ascii) bytes += {c, '\0'};
  return bytes;
}

// A hexahedron and a tetrahedron on it that share no face.
const std::vector<std::array<float, 3>> kSolidNodes{{0, 0, 0},    {20, 0, 0},  {20, 20, 0},
                                                    {0, 20, 0},   {0, 0, 20},  {20, 0, 20},
                                                    {20, 20, 20}, {0, 20, 20}, {10, 10, 40}};
const std::vector<Face> kSolidCells{{0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 8}};

std::string solid_vtk() {
  std::string text = "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 float\n" +
                     vertex_lines({"", kSolidNodes, {}});
  text += "CELLS 2 14\n" + face_lines({"", {}, kSolidCells});
  return text + "CELL_TYPES 2\n12 10\n";
}

std::string text_msh() {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n";
  for (std::size_t n = 0; n < kSolidNodes.size(); ++n)
    text += std::to_string(n) + ' ' + numbers(kSolidNodes[n]) + '\n';
  text += "$EndNodes\n$Elements\n2\n";
  for (std::size_t c = 0; c < kSolidCells.size(); ++c) {
    text += std::to_string(c + 1) + (c == 0 ? " 5 2 1 1" : " 4 2 1 1");
    for (const int node : kSolidCells[c]) text += ' ' + std::to_string(node);
    text += '\n';
  }
  return text + "$EndElements\n";
}

/// Version 4.1 has blocks of nodes and elements; counts and tags have eight bytes.
std::string binary_msh() {
  const auto wide = [](std::size_t value) { return little_endian(std::uint64_t{value}); };
  const std::size_t nodes = kSolidNodes.size();
  std::string bytes = "$MeshFormat\n4.1 1 8\n" + little_endian(1) + "\n$EndMeshFormat\n$Nodes\n" + wide(1) +
                      wide(nodes) + wide(0) + wide(nodes - 1) + little_endian(3) + little_endian(1) +
                      little_endian(0) + wide(nodes);
  for (std::size_t n = 0; n < nodes; ++n) bytes += wide(n);
  for (const auto& vertex : kSolidNodes) {
    for (const float x : vertex) bytes += little_endian(static_cast<double>(x));
  }
  bytes += "\n$EndNodes\n$Elements\n" + wide(2) + wide(2) + wide(1) + wide(2);
  for (std::size_t c = 0; c < kSolidCells.size(); ++c) {
    bytes += little_endian(3) + little_endian(1) + little_endian(c == 0 ? 5 : 4) + wide(1) + wide(c + 1);
    for (const int node : kSolidCells[c]) bytes += wide(static_cast<std::size_t>(node));
  }
  return bytes + "\n$EndElements\n";
}

class Seeds final {
 public:
  explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::filesystem::path place(const std::string& target, const std::string& name) const {
    std::filesystem::create_directories(folder_ / target);
    return folder_ / target / name;
  }
  void add(const std::string& target, const std::string& name, const std::string& bytes) const {
    std::ofstream out(place(target, name), std::ios::binary);
    if (!out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) {
      throw InputError(place(target, name).string() + ": cannot be written");
    }
  }

 private:
  std::filesystem::path folder_;
};

void add_meshes(const Seeds& seeds) {
  for (const Shape& shape : kShapes) {
    seeds.add("mesh_stl", shape.name + "_text", text_stl(shape));
    seeds.add("mesh_stl", shape.name, binary_stl(shape));
    seeds.add("tool_mesh", shape.name + "_text", text_stl(shape));
    seeds.add("tool_mesh", shape.name, binary_stl(shape));
    seeds.add("mesh_obj", shape.name, obj(shape));
    seeds.add("mesh_ply", shape.name + "_text", text_ply(shape));
    seeds.add("mesh_ply", shape.name, binary_ply(shape));
    seeds.add("mesh_off", shape.name, off(shape));
    seeds.add("mesh_3ds", shape.name, three_ds(shape));
    seeds.add("mesh_gltf", shape.name, gltf(shape));
    seeds.add("mesh_glb", shape.name, glb(shape));
    seeds.add("mesh_vtk", shape.name + "_text", text_vtk(shape));
    seeds.add("mesh_vtk", shape.name, binary_vtk(shape));
  }
  const Shape& first = kShapes.front();
  seeds.add("mesh_stl", "upper_case", "\xef\xbb\xbf# by hand\n" + in_upper_case(text_stl(first)));
  seeds.add("mesh_gltf", "quantized", quantized(gltf(first)));
  seeds.add("mesh_vtk", "field_text", with_field_data(text_vtk(first), false));
  seeds.add("mesh_vtk", "field", with_field_data(binary_vtk(first), true));
  seeds.add("mesh_vtk", "solid", solid_vtk());
  seeds.add("mesh_msh", "solid_text", text_msh());
  seeds.add("mesh_msh", "solid", binary_msh());
}

/// PNG of 64 x 64 pixels with one bit, white above black.
constexpr char kPicture[] =
    "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x40\x00\x00\x00\x40"
    "\x01\x00\x00\x00\x00\x82\x12\x4c\x73\x00\x00\x00\x14\x49\x44\x41\x54\x78\xda\x63\xf8\x0f\x05\x0c"
    "\xa3\x0c\xac\x8c\x51\x80\x17\x00\x00\x6b\x72\xff\x01\x8d\x03\xbe\xf3\x00\x00\x00\x00\x49\x45\x4e"
    "\x44\xae\x42\x60\x82";

/// One line of a specimen and one of a sweep.
std::string fit_lines() {
  const std::string estimate =
      R"({"value":0.0,"interval":[0.0,0.0],"covariance":null,"bootstrap":[1.0,2.0],"determined":true})";
  std::string estimates = estimate;
  for (int i = 1; i < 6; ++i) estimates += ',' + estimate;
  return R"({"key":"a","name":"a","law":"layered","layers":6,"layers_reached":4,"terms":0,"parameters":[)" +
         estimates +
         R"(],"rms_N":0.0,"nrmse":0.0,"leave_out_nrmse":"nan","points":2,"rows":2,"warnings":["a"],)"
         R"("curve":{"time":[0.0,1.0],"displacement":[0.001,0.002],"measured":[0.1,0.2],"fitted":[0.1,0.2],)"
         R"("low":[0.0,0.1],"high":[0.2,0.3]},"shared":[1.0,2.0,3.0,4.0],"own":[5.0,6.0],)"
         R"("local_optima":[[1.0,2.0,3.0,4.0,5.0,6.0]]})"
         "\n"
         R"({"key":"b","best_nrmse":0.1,"found_better":false,"values":1,)"
         R"("points_swept":[[1,"nan",1.0,0.5,1,2,3,4]]})"
         "\n";
}

void add_the_rest(const Seeds& seeds) {
  seeds.add("scene", "scene", kScene);
  seeds.add("study", "study", kStudy);
  seeds.add("trial_log", "trial", kTrialLog);
  seeds.add("tissue", "heart", scene::to_toml(model::tissue_preset("heart")));
  model::TissueParameters fitted = model::tissue_preset("liver");
  fitted.source = model::SourceParameters{"ball", 3e-3};
  seeds.add("tissue", "fitted", scene::to_toml(fitted));
  seeds.add("stiffness_map", "two", "x_mm,y_mm,z_mm,factor\n1,2,3,0.5\n-4e1,5,6,2\n");
  const std::string place = "property float x\nproperty float y\nproperty float z\n";
  seeds.add("stiffness_map", "ply_factor",
            "ply\nformat ascii 1.0\nelement vertex 2\n" + place +
                "property double factor\nend_header\n1 2 3 0.5\n-4e1 5 6 2\n");
  seeds.add("stiffness_map", "ply_quality",
            "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" + place +
                "property float quality\nend_header\n" + big_endian(1.0F) + big_endian(2.0F) +
                big_endian(3.0F) + big_endian(0.5F));
  seeds.add("stiffness_map", "ply_colours",
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + place +
                "property uchar red\nproperty uchar green\nproperty float blue\nend_header\n" +
                little_endian(1.0F) + little_endian(2.0F) + little_endian(3.0F) + "\x10\xff" +
                little_endian(0.5F));
  seeds.add("tool_path", "places", "time_s,x_m,y_m,z_m\n0,0,0,0.1\n0.5,0,1e-3,-0.1\n");
  seeds.add("tool_path", "all",
            "time_s,x_m,y_m,z_m,qw,qx,qy,qz,gripper\n0,0,0,1,1,0,0,0,1\n1,0,0,0,0,1,0,0,0\n");
  seeds.add("tool_path", "tabs",
            utf16("time_s\tx_m\ty_m\tz_m\ns\tm\tm\tm\n0,5\t0\t0\t0\n1,5\t0\t0\t1,234\n"));
  std::string curve = "# a comment\ntime_s,displacement_mm,force_N,specimen\n";
  for (int i = 0; i < 12; ++i) {
    const std::string n = std::to_string(i);
    curve += n + ',' + n + ".5," + n + "e-2,a\n" + n + ',' + n + ",0." + n + ",b\n";
  }
  seeds.add(
      "map_data", "two",
      "probe,x_mm,y_mm,z_mm,nx,ny,nz,depth_mm,force_N\n0,1,2,3,0,0,1,0.5,0.1\n1,4,5e0,-6,0,0,1,1,2e-1\n");
  seeds.add("fit_data", "two", curve);
  std::string quoted = "\"displacement_mm\";\"force_N\";\n";
  for (int i = 0; i < 12; ++i) {
    quoted += "\"" + std::to_string(i) + "\";" + std::to_string(i) + ";0," + std::to_string(i) + ";\n";
  }
  seeds.add("fit_data", "quoted", quoted);
  seeds.add("fit_lines", "two", fit_lines());
  seeds.add("deformation", "two",
            "depth_mm,r_mm,u_mm\n1,0,1\n1,-1,.8\n1,2,.4\n1,5,.2\n1,9,.1\n"
            "3,0,3\n3,1,2.5\n3,-2,1.9\n3,5,.6\n3,9,.3\n");
  seeds.add("picture", "png", std::string(kPicture, sizeof kPicture - 1));
  seeds.add("picture", "jpeg", "\xff\xd8\xff\xe0");
  seeds.add("scene_json", "scene", record::scene_to_json(record::sample_setup(2)));
  seeds.add("haply_message", "all", kHaplyMessage);
  seeds.add("haply_message", "none", R"({"inverse3":[],"wireless_verse_grip":null})");
  net::IgtlMessages transforms(0);
  transforms.add_transform("Hand", {});
  const std::string transform(transforms.bytes().begin(), transforms.bytes().end());
  seeds.add("igtl_message", "whole", transform);
  seeds.add("igtl_message", "version1", std::string(1, '\0') + transform.substr(58));
  seeds.add("igtl_message", "version2",
            std::string("\1\0\14", 3) + std::string(10, '\0') + transform.substr(58));
  int message = 0;
  for (const char* text : kLiveMessages) seeds.add("live_message", std::to_string(++message), text);
  record::record_sample(seeds.place("recording", "no_tick"), 0, 1);
  record::record_sample(seeds.place("recording", "some"), 20, 2);
  ArrayFileWriter writer(seeds.place("array_file", "arrays"), ContentHash{});
  writer.put("numbers", std::vector<double>{1.0, 2.0});
  writer.put("bytes", std::vector<std::uint8_t>{1, 2, 3});
  if (!writer.commit()) throw InputError("array_file: cannot be written");
}

std::string times(std::size_t count, const std::string& part) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += part;
  return all;
}

/// A recording whose /scene is this text.
void add_recording_of(const Seeds& seeds, const std::string& name, const std::string& scene) {
  const std::filesystem::path file = seeds.place("recording", name);
  record::record_sample(file, 1, 1);
  const record::hdf5::Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "recording");
  H5Ldelete(opened.id(), "scene", H5P_DEFAULT);
  record::hdf5::write_text(record::hdf5::create_text(opened.id(), "scene", scene.size()).id(), scene);
}

/// Texts that are nested so deep that a recursive reader overflows the stack.
void add_deep(const Seeds& seeds) {
  constexpr std::size_t kDeep = 100'000;
  const std::string list = times(kDeep, "[") + times(kDeep, "]");
  for (const char* target : {"scene", "tissue", "study"}) {
    seeds.add(target, "deep_key", times(kDeep, "a.") + "a=1\n");
    seeds.add(target, "deep_table", "[" + times(kDeep, "a.") + "a]\n");
    seeds.add(target, "deep_tables", "[[" + times(kDeep, "a.") + "a]]\n");
    seeds.add(target, "deep_list", "a=" + list + "\n");
    seeds.add(target, "deep_object", "a=" + times(kDeep, "{a=") + "1" + times(kDeep, "}") + "\n");
  }
  for (const char* target : {"scene_json", "fit_lines", "haply_message", "live_message", "mesh_gltf"}) {
    seeds.add(target, "deep_list", list);
    seeds.add(target, "deep_object", times(kDeep, R"({"a":)") + "1" + times(kDeep, "}"));
  }
  seeds.add("trial_log", "deep", R"({"n":1,"z":)" + list + "}\n");
  std::string scene = record::scene_to_json(record::sample_setup(1));
  add_recording_of(seeds, "deep", scene.insert(scene.find("\"soft\""), list + ","));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: palpate_fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  try {
    const Seeds seeds(argv[1]);
    add_meshes(seeds);
    add_the_rest(seeds);
    add_deep(seeds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate_fuzz_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}

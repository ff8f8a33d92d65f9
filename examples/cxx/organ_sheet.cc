// Draws an organ at rest from four sides on one sheet, without a display. Usage: organ_sheet ORGAN
// [SHEET.png]
// ORGAN is a built-in name, such as liver-30k. Without OpenGL it prints a message and draws nothing.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <stdexcept>
#include <string>

#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/offscreen.h"
#include "palpate/tick_observer.h"

namespace {

using palpate::Vec3;
using palpate::render::Camera;
using palpate::render::Image;

constexpr int kWidth = 560;  // pixels, of each picture
constexpr int kHeight = 440;
constexpr int kGap = 4;  // pixels between the pictures, white

/// Camera that shows the whole organ from a direction, with +y up.
Camera camera_from(const palpate::geometry::TriangleMesh& organ, const Vec3& direction) {
  Camera camera;
  camera.up = Vec3::UnitY();
  camera.vertical_view_deg = 24.0;
  const Vec3 to_eye = direction.normalized();
  const Vec3 right = camera.up.cross(to_eye).normalized();
  const Vec3 up = to_eye.cross(right);
  const double half = std::tan(0.5 * camera.vertical_view_deg * 3.14159265358979 / 180.0);
  double distance = 0.0;
  for (const Vec3& v : organ.vertices) {
    const double across = std::max(std::abs(v.dot(right)) * kHeight / kWidth, std::abs(v.dot(up)));
    distance = std::max(distance, v.dot(to_eye) + 1.08 * across / half);
  }
  camera.target = Vec3::Zero();  // built-in organs are centred at the origin
  camera.eye = distance * to_eye;
  return camera;
}

void put(const Image& part, std::size_t column, std::size_t row, Image& sheet) {
  const std::size_t width = static_cast<std::size_t>(part.width);
  const std::size_t height = static_cast<std::size_t>(part.height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t line = row * (height + kGap) + y;
    const std::size_t to = line * static_cast<std::size_t>(sheet.width) + column * (width + kGap);
    std::copy_n(part.rgb.data() + 3 * y * width, 3 * width, sheet.rgb.data() + 3 * to);
  }
}

void draw(const std::string& name, const char* file) {
  palpate::render::Subject subject;
  subject.organ = palpate::geometry::make_organ(name);
  subject.organ_name = name;
  subject.tissue_name = name.substr(0, name.find('-'));
  palpate::render::OffscreenRenderer renderer(subject, kWidth, kHeight);
  // From the front, from behind and above, from the left and above, from behind and below.
  const std::array<Vec3, 4> sides{Vec3(0.0, 0.0, 1.0), Vec3(0.1, 0.55, -1.0), Vec3(0.75, 0.45, 0.6),
                                  Vec3(0.1, -0.9, -0.45)};
  Image sheet{2 * kWidth + kGap, 2 * kHeight + kGap, {}};
  sheet.rgb.resize(static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height) * 3, 255);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Camera camera = camera_from(subject.organ, sides[i]);
    put(renderer.draw(palpate::haptics::Snapshot{}, camera), i % 2, i / 2, sheet);
  }
  if (file != nullptr) palpate::render::write_png(sheet, file);
  std::cout << name << ": " << sheet.width << " x " << sheet.height << " pixels\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: organ_sheet ORGAN [SHEET.png]\n";
    return 1;
  }
  try {
    draw(argv[1], argc > 2 ? argv[2] : nullptr);
  } catch (const palpate::InputError& error) {
    std::cerr << error.what() << '\n';
    return 3;
  } catch (const std::runtime_error& error) {
    std::cout << "no picture: " << error.what() << '\n';
  }
  return 0;
}

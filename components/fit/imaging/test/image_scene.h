#pragma once
// Synthetic side views with a known displacement, drawn by a small renderer that shares no code with the
// measurement.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <jpeglib.h>

#include "core/base/random.h"

#include "fit/imaging/image_file.h"

namespace palpate::imaging::test {

/// A tissue body in front of a background, pressed by a ball on a shaft. Lengths in pixels unless stated; y
/// down.
struct SideView {
  int width = 900;
  int height = 460;
  double mm_per_px = 0.1;
  double surface_y = 200.0;  // of the flat surface, in the middle column
  double dome = 0.0;         // the surface falls by a (column/width)^2 rows from the middle
  double centre_x = 450.0;   // of the contact
  double depth_mm = 6.0;     // D; negative: pulled
  double tip_mm = 3.0;       // R
  double above = 0.75;       // brightness, 1 = white
  double below = 0.40;
  double texture = 0.02;  // of both, standard deviation
  double uneven = 0.0;    // relative decrease of the light from left to right
  double turn = 0.0;      // rad, rotation of the camera
  double shift_x = 0.0;   // shift of the camera
  double shift_y = 0.0;
  bool instrument = true;
  double instrument_light = 0.15;
  std::vector<double> bars;  // columns where an object hides the line
  double bar_width = 40.0;
  std::vector<std::array<double, 3>> spots;  // highlights: column, rows below the line, radius
  double blur = 0.0;                         // px, standard deviation
  double noise = 0.0;                        // 1 = white
  int jpeg = 0;                              // quality; 0: no compression
  std::uint32_t seed = 1;
};

/// Radii and weights of model.md, section 3, implemented independently: c = 1.1, a = 0.43, s = 1.8, g = 0.58.
/// Pixels.
struct Bowl {
  explicit Bowl(const SideView& view) : depth_px(view.depth_mm / view.mm_per_px) {
    const double r1 = 1.1 * std::sqrt(view.tip_mm * std::abs(view.depth_mm)) / view.mm_per_px;
    for (std::size_t i = 0; i < radii.size(); ++i) {
      radii[i] = r1 * (1.0 + 0.43 * (std::pow(1.8, i) - 1.0) / 0.8);
      weights[i] = std::pow(0.58, i);
      sum += weights[i];
    }
  }
  [[nodiscard]] double u(double r_px) const {
    if (depth_px == 0.0) return 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < radii.size(); ++i) {
      const double share = r_px / radii[i];
      all += weights[i] * std::max(0.0, 1.0 - share * share);
    }
    return depth_px * all / sum;
  }

  double depth_px;
  double sum = 0.0;
  std::array<double, 6> radii{};
  std::array<double, 6> weights{};
};

inline double true_u(const SideView& view, double r_px) { return Bowl(view).u(r_px); }

inline double rest_row(const SideView& view, double x) {
  const double share = (x - 0.5 * view.width) / view.width;
  return view.surface_y + view.dome * share * share;
}

inline double surface_row(const SideView& view, const Bowl& bowl, double x) {
  return rest_row(view, x) + bowl.u(std::abs(x - view.centre_x));
}

/// Smooth noise of unit size: bilinear interpolation of random lattice values.
inline double lattice_noise(double x, double y, double cell, std::uint32_t seed) {
  const double fx = std::floor(x / cell);
  const double fy = std::floor(y / cell);
  const auto value = [seed](double i, double j) {
    auto h = static_cast<std::uint32_t>(static_cast<std::int64_t>(i) * 73856093) ^
             static_cast<std::uint32_t>(static_cast<std::int64_t>(j) * 19349663) ^ (seed * 83492791U);
    h = (h ^ (h >> 13U)) * 0x5bd1e995U;
    h ^= h >> 15U;
    return 3.46 * (static_cast<double>(h & 0xffffU) / 65536.0 - 0.5);
  };
  const double u = x / cell - fx;
  const double v = y / cell - fy;
  return (1 - v) * ((1 - u) * value(fx, fy) + u * value(fx + 1, fy)) +
         v * ((1 - u) * value(fx, fy + 1) + u * value(fx + 1, fy + 1));
}

/// Coverage of a pixel at a distance inside an edge; exactly 1 at 5 pixels.
inline double coverage(double distance) {
  if (std::abs(distance) > 5.0) return distance > 0.0 ? 1.0 : 0.0;
  return 0.5 * std::erfc(-distance / (0.5 * std::sqrt(2.0)));
}

/// Brightness of the scene at a point, before the camera.
inline double light_at(const SideView& view, const Bowl& bowl, double x, double y) {
  const double row = surface_row(view, bowl, x);
  const double slope = 0.5 * (surface_row(view, bowl, x + 1.0) - surface_row(view, bowl, x - 1.0));
  const double inside = coverage((y - row) / std::hypot(1.0, slope));
  const double grain = lattice_noise(x, y, 7.0, view.seed) + 0.7 * lattice_noise(x, y, 23.0, view.seed + 1);
  const double above = view.above + 0.3 * view.texture * lattice_noise(x, y, 60.0, view.seed + 2);
  double light = above + inside * (view.below + view.texture * grain - above);
  if (view.instrument) {
    const double tip = view.tip_mm / view.mm_per_px;
    const double up = view.depth_mm < 0.0 ? -1.0 : 1.0;
    const double pressed = surface_row(view, bowl, view.centre_x);
    const double ball_y = pressed - tip * up;
    const double top = std::min(ball_y, pressed);
    const double ball = tip - std::hypot(x - view.centre_x, y - (view.depth_mm < 0.0 ? top - tip : ball_y));
    const double shaft = y < top ? 0.45 * tip - std::abs(x - view.centre_x) : -9.0;
    const double cover = coverage(std::max(ball, shaft));
    light += cover * (view.instrument_light - light);
  }
  for (const auto& spot : view.spots) {
    const double away = std::hypot(x - spot[0], y - rest_row(view, spot[0]) - spot[1]);
    light += coverage(spot[2] - away) * (0.98 - light);
  }
  for (const double bar : view.bars) {
    if (y > rest_row(view, bar) + 130.0) continue;
    light += coverage(0.5 * view.bar_width - std::abs(x - bar)) * (view.instrument_light - light);
  }
  return light * (1.0 - view.uneven * x / view.width);
}

inline void blur(std::vector<float>& gray, int width, int height, double sigma) {
  const int half = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int k = -half; k <= half; ++k) {
    kernel.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += kernel.back();
  }
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  for (const bool across : {true, false}) {
    const std::vector<float> from = gray;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double value = 0.0;
        for (std::size_t i = 0; i < kernel.size(); ++i) {
          const int k = static_cast<int>(i) - half;
          const int xx = across ? std::clamp(x + k, 0, width - 1) : x;
          const int yy = across ? y : std::clamp(y + k, 0, height - 1);
          value += kernel[i] * static_cast<double>(from[at(xx, yy)]);
        }
        gray[at(x, y)] = static_cast<float>(value / sum);
      }
    }
  }
}

/// Compressed and decoded by libjpeg; luma only.
inline std::vector<unsigned char> as_jpeg(const std::vector<unsigned char>& gray, int width, int height,
                                          int quality) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<unsigned char> row(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    std::copy_n(gray.begin() + static_cast<std::ptrdiff_t>(y) * width, width, row.begin());
    JSAMPROW pointer = row.data();
    jpeg_write_scanlines(&jpeg, &pointer, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::vector<unsigned char> out(bytes, bytes + size);
  std::free(bytes);  // NOLINT: libjpeg allocates it by malloc
  return out;
}

inline std::vector<unsigned char> from_jpeg(const std::vector<unsigned char>& bytes, int width, int height) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg_start_decompress(&jpeg);
  std::vector<unsigned char> gray(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row =
        gray.data() + static_cast<std::size_t>(jpeg.output_scanline) * static_cast<std::size_t>(width);
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return gray;
}

inline Picture picture_of(const std::vector<unsigned char>& gray, int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  for (const unsigned char g : gray) {
    picture.gray.push_back(static_cast<float>(g) / 255.0F);
    picture.rgb.insert(picture.rgb.end(), {g, g, g});
  }
  return picture;
}

/// The photograph: scene, camera, blur, noise, 8 bits, compression.
inline Picture photograph(const SideView& view) {
  const Bowl bowl(view);
  std::vector<float> light;
  const double c = std::cos(view.turn);
  const double n = std::sin(view.turn);
  const double middle_x = 0.5 * view.width;
  const double middle_y = 0.5 * view.height;
  for (int py = 0; py < view.height; ++py) {
    for (int px = 0; px < view.width; ++px) {
      const double x = px - middle_x - view.shift_x;
      const double y = py - middle_y - view.shift_y;
      light.push_back(
          static_cast<float>(light_at(view, bowl, middle_x + c * x + n * y, middle_y - n * x + c * y)));
    }
  }
  if (view.blur > 0.0) blur(light, view.width, view.height, view.blur);
  Random random(view.seed, 17, 5);
  std::vector<unsigned char> gray;
  for (const float value : light) {
    const double noisy = static_cast<double>(value) + (view.noise > 0.0 ? view.noise * random.normal() : 0.0);
    gray.push_back(static_cast<unsigned char>(std::lround(255.0 * std::clamp(noisy, 0.0, 1.0))));
  }
  if (view.jpeg > 0)
    gray = from_jpeg(as_jpeg(gray, view.width, view.height, view.jpeg), view.width, view.height);
  return picture_of(gray, view.width, view.height);
}

}  // namespace palpate::imaging::test

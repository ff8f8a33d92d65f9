#pragma once
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::report {

/// gnuplot could not draw: it is missing, or refused the script; the message says which, in words.
class FigureError final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// [any] Distance of two tics so that some four fit between -largest and largest: 1, 2 or 5 times a power of
/// ten.
[[nodiscard]] double tic_step(double largest);

// Colours that colour-blind readers can tell apart (Okabe and Ito 2008).
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kOrange = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kGrey = "#9a9a9a";

/// [setup] The first lines of every figure's script: size in points, output, border and grid.
/// @param key position and layout of the legend, as gnuplot's `set key` takes them
[[nodiscard]] std::string preamble(int width, int height, const std::string& key);

/// A folder of its own under the system's temporary folder, removed with everything in it at the end.
class TemporaryFolder final {
 public:
  /// [setup] @throws FigureError when it cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// One table of numbers that a script reads: columns separated by spaces, one row a line.
struct PlotData {
  std::string name;  // of the file, in the script's working folder
  std::vector<std::vector<double>> rows;
};

/// [setup] Writes the data files, runs gnuplot on the script in a temporary folder and moves what the script
/// wrote under "figure.svg" to `file`. @param program gnuplot's name or path
/// @throws FigureError when gnuplot is missing or fails; InputError when `file` cannot be written.
void run_gnuplot(const std::string& script, const std::vector<PlotData>& data,
                 const std::filesystem::path& file, const std::string& program = "gnuplot");

}  // namespace palpate::report

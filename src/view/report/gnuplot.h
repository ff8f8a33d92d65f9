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

/// One figure or picture of the report.
struct Figure {
  std::filesystem::path file;  // in the report's folder
  std::string alternative;     // what it shows, for who cannot see it
  std::string caption{};
  std::string missing{};  // why there is none, in words; empty: it is there
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

/// Of figures with two panes: the legend at the upper left.
inline constexpr const char* kKeyLeft = "top left Left reverse samplen 2 spacing 1.15 noopaque";

/// [setup] A figure of 760 points with two panes over one x axis, whose tics only the lower one has.
/// @param lower_share of the height @param upper, lower commands that draw the panes
[[nodiscard]] std::string two_panes(int height, const std::string& key, double lower_share,
                                    const std::string& upper, const std::string& lower);

/// [any] Sorts rows by their first column; equal ones stay in their order.
void sort_by_x(std::vector<std::vector<double>>& rows);

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

/// [setup] The figure, drawn; when gnuplot is missing or fails, `missing` says why. @throws InputError when
/// its file cannot be written.
[[nodiscard]] Figure drawn(Figure figure, const std::string& script, const std::vector<PlotData>& data);

}  // namespace palpate::report

#pragma once
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::report {

/// gnuplot is missing or rejected the script; the message gives the reason.
class FigureError final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One figure or picture of the report.
struct Figure {
  std::filesystem::path file;  // in the folder of the report
  std::string alternative;     // description for readers who cannot see it (HTML alt text)
  std::string caption{};
  std::string missing{};  // reason why there is no figure; empty: it exists
};

/// [any] Distance between tics that puts about four between -largest and largest: 1, 2 or 5 times a power of
/// ten.
[[nodiscard]] double tic_step(double largest);

// Colours that colour-blind readers can distinguish (Okabe and Ito 2008).
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kOrange = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kGrey = "#9a9a9a";

/// [setup] First lines of each figure's script: size in points, output, border and grid.
/// @param key position and layout of the legend, in the syntax of gnuplot's `set key`
[[nodiscard]] std::string preamble(int width, int height, const std::string& key);

/// Legend at the upper left, for figures with two panels.
inline constexpr const char* kKeyLeft = "top left Left reverse samplen 2 spacing 1.15 noopaque";

/// [setup] Script of a figure with two panels above each other and a common x axis.
/// @param lower_share of the height @param upper, lower commands that draw the panels
/// @param height, width in points
[[nodiscard]] std::string two_panes(int height, const std::string& key, double lower_share,
                                    const std::string& upper, const std::string& lower, int width = 760);

/// [any] Text in single quotes of a script.
[[nodiscard]] std::string quoted(const std::string& text);

/// [any] The command that draws curves over each other; without curves it draws an empty panel.
/// @param curves each as in gnuplot's `plot`: table, columns, style, title
[[nodiscard]] std::string plot(const std::vector<std::string>& curves);

/// [any] Stable sort of rows by their first column.
void sort_by_x(std::vector<std::vector<double>>& rows);

/// A table of numbers for a script: columns separated by spaces, one row per line.
struct PlotData {
  std::string name;  // file name in the script's working folder
  std::vector<std::vector<double>> rows;
};

/// [setup] Writes the data files, runs gnuplot on the script in a temporary folder and moves its output
/// "figure.svg" to `file`. @param program name or path of gnuplot @throws FigureError when gnuplot is missing
/// or fails; InputError when `file` cannot be written.
void run_gnuplot(const std::string& script, const std::vector<PlotData>& data,
                 const std::filesystem::path& file, const std::string& program = "gnuplot");

/// [setup] Draws a figure; when gnuplot is missing or fails, `missing` of the result gives the reason.
/// @throws InputError when its file cannot be written.
[[nodiscard]] Figure drawn(Figure figure, const std::string& script, const std::vector<PlotData>& data);

}  // namespace palpate::report

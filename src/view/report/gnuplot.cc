#include "view/report/gnuplot.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "core/base/text.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/output_file.h"
#include "io/system/temporary.h"
#include "palpate/error.h"
#include "view/report/run_script.h"

namespace palpate::report {
namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw FigureError("figure: cannot write " + file.string());
}

std::string table_text(const PlotData& data) {
  std::string text;
  for (const std::vector<double>& row : data.rows) {
    for (const double value : row) text += shortest(value) + ' ';
    text += '\n';
  }
  return text;
}

std::string read_text(const std::filesystem::path& file) {
  constexpr InputKind kMessages{"the messages of gnuplot", std::uint64_t{1} << 20};
  return InputFile(file, kMessages).read_rest();
}

}  // namespace

double tic_step(double largest) {
  if (!(largest > 0.0) || !std::isfinite(largest)) return 1.0;
  const double wanted = largest / 2.0;
  const double decade = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= wanted) return factor * decade;
  }
  return 10.0 * decade;
}

std::string preamble(int width, int height, const std::string& key) {
  constexpr const char* kScript = R"(set encoding utf8
set terminal svg size {},{} dynamic noenhanced font 'Helvetica,14' background '#ffffff'
set output 'figure.svg'
set border 3 lw 1 lc rgb '#555555'
set tics nomirror out scale 0.6 textcolor rgb '#333333'
set grid lc rgb '#e4e4e4' lw 1
set key {}
)";
  return fmt::format(kScript, width, height, key);
}

std::string two_panes(int height, const std::string& key, double lower_share, const std::string& upper,
                      const std::string& lower, int width) {
  constexpr const char* kScript = R"({}set lmargin 11
set multiplot
set origin 0,{}
set size 1,{}
set bmargin 0.6
set format x ''
{}
set origin 0,0
set size 1,{}
set tmargin 0.8
set bmargin 3.4
set format x '%g'
{}
unset multiplot
)";
  return fmt::format(kScript, preamble(width, height, key), lower_share, 1.0 - lower_share, upper,
                     lower_share, lower);
}

std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("''") : std::string(1, c);
  return safe + "'";
}

std::string plot(const std::vector<std::string>& curves) {
  return fmt::format("plot {}\n", curves.empty() ? "NaN" : fmt::format("{}", fmt::join(curves, ", ")));
}

void sort_by_x(std::vector<std::vector<double>>& rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
}

void run_gnuplot(const std::string& script, const std::vector<PlotData>& data,
                 const std::filesystem::path& file, const std::string& program) {
  const ScratchFolder folder("palpate-figure-");
  if (folder.path().empty()) throw FigureError("figure: no temporary folder can be made");
  for (const PlotData& table : data) write_text(folder.path() / table.name, table_text(table));
  write_text(folder.path() / "figure.gp", script);
  const int status = run_script(folder.path(), program);
  const std::filesystem::path drawn = folder.path() / "figure.svg";
  if (status != 0 || !file_exists(drawn)) {
    throw FigureError(
        fmt::format("gnuplot failed (exit {}): {}", status, read_text(folder.path() / "errors.txt")));
  }
  std::error_code error;
  std::filesystem::copy_file(drawn, file, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw InputError(file.string() + ": cannot be written: " + error.message());
}

Figure drawn(Figure figure, const std::string& script, const std::vector<PlotData>& data) {
  try {
    replace_file(figure.file, [&](const std::filesystem::path& file) { run_gnuplot(script, data, file); });
  } catch (const FigureError& error) {
    figure.missing = error.what();
  }
  return figure;
}

}  // namespace palpate::report

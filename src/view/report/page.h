#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/pose.h"
#include "view/report/gnuplot.h"

namespace palpate::report {

inline constexpr double kMilli = 1e3;  // m to mm, N to mN

/// [any] `value` with `digits` decimals, independent of the locale.
[[nodiscard]] std::string fixed(double value, int digits);

/// [any] A count with commas between thousands: 2,110.
[[nodiscard]] std::string grouped(std::uint64_t value);

/// [any] A value with its unit, at most 6 digits: 1.5 mm; `unit` may be empty.
[[nodiscard]] std::string number(double value, const char* unit);
/// [any] A length [m]: 1.5 mm.
[[nodiscard]] std::string millimetres(double metres);
/// [any] A point [m]: 1, 2.5, 3 mm.
[[nodiscard]] std::string point_mm(const Vec3& p);

/// [any] `text` with &, <, > and quotes escaped for HTML text and attributes.
[[nodiscard]] std::string escaped(std::string_view text);

/// [any] A time since 1970 [ns] as "2011-07-01 12:00:00 UTC".
[[nodiscard]] std::string utc_time(std::int64_t unix_ns);

/// Cells of a table as HTML (use escaped() for text).
using TableRows = std::vector<std::vector<std::string>>;

/// [setup] @throws InputError when the report's folder cannot be created, or has folders in place of files.
void make_report_folder(const std::filesystem::path& folder);

/// [any] Whether a run's report may write a file of this name: its page, its list, or a figure such as
/// 1-law.svg.
[[nodiscard]] bool is_report_file(const std::string& name);

/// Builds a self-contained HTML page with its style and pictures inside. Text arguments are escaped here;
/// arguments named `html` are inserted unchanged.
class Page final {
 public:
  /// [setup] @param title title and first heading of the page
  Page(const std::string& title, const std::string& subtitle);

  /// Begins a section, which extends to the next one.
  void section(const std::string& id, const std::string& heading);
  void heading(const std::string& text);
  void paragraph(const std::string& html);
  void code(const std::string& text);
  /// Adds a list; nothing when there are no items.
  void list(const std::vector<std::string>& items);
  void html_list(const std::vector<std::string>& html_items, const std::string& css_class);
  /// Adds a table of two columns: name and value.
  void facts(const std::vector<std::pair<std::string, std::string>>& rows);
  /// Adds a table. The first row is the header; the first column names the rows.
  void table(const TableRows& html_rows);
  /// Begins a folded part, which a click on its heading opens. It prints unfolded.
  void open_details(const std::string& heading);
  void close_details();
  void open_grid(const std::string& css_class);
  void close_grid();
  /// Embeds figures in a grid; for a missing one its reason is shown. @throws InputError when a file cannot
  /// be read.
  void figures(const std::string& css_class, const std::vector<Figure>& figures);

  /// The HTML of the page.
  [[nodiscard]] std::string html() const;
  /// Writes the page as report.html, and a list of its figures that lie in the folder, with their checksums.
  /// Figures in the list of an earlier report that this page does not have are deleted, unless they were
  /// changed since. @return the file @throws InputError when it cannot be written.
  [[nodiscard]] std::filesystem::path write(const std::filesystem::path& folder) const;

 private:
  void figure(const Figure& figure);

  bool in_section_ = false;
  std::string title_;
  std::string body_;
  std::vector<std::filesystem::path> files_;  // of the figures
};

}  // namespace palpate::report

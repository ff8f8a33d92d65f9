#include "view/report/page.h"

#include <array>
#include <ctime>
#include <map>
#include <sstream>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "core/base/text.h"
#include "io/system/base64.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/output_file.h"
#include "io/system/sha256.h"
#include "palpate/error.h"

namespace palpate::report {
namespace {

constexpr const char* kStyle = R"css(
:root { --ink: #1f2328; --soft: #5b6570; --line: #dfe3e8; --paper: #ffffff; --tint: #f6f7f9;
        --met: #006b4f; --late: #9a6700; --missed: #b3261e; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; padding: 2.5rem 1.25rem 4rem; max-width: 66rem; background: var(--paper);
       color: var(--ink); font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
header { border-bottom: 3px solid var(--ink); padding-bottom: 1rem; margin-bottom: 1.5rem; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .25rem; letter-spacing: -.01em; }
h2 { font-size: 1.45rem; line-height: 1.25; margin: 3rem 0 .75rem; padding-top: 1rem;
     border-top: 1px solid var(--line); }
header + section h2 { margin-top: 0; border-top: 0; padding-top: 0; }
h3 { font-size: 1.08rem; margin: 2rem 0 .5rem; }
p { margin: .5rem 0 .9rem; max-width: 46rem; }
header p { color: var(--ink); margin: .5rem 0 0; font-size: 1.12rem; max-width: 52rem; }
nav { margin: 0 0 1rem; } nav a { margin-right: 1.2rem; }
a { color: #00578a; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 4px; padding: .6rem .8rem;
      overflow-x: auto; font: 13.5px/1.5 ui-monospace, "DejaVu Sans Mono", monospace; white-space: pre-wrap;
      overflow-wrap: anywhere; }
.scroll { overflow-x: auto; margin: .5rem 0 1rem; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .32rem 1.1rem .32rem 0;
         border-bottom: 1px solid var(--line); }
thead th { border-bottom: 2px solid var(--ink); font-weight: 600; }
tbody th { font-weight: 400; color: var(--soft); }
td, th { overflow-wrap: break-word; } .facts td { overflow-wrap: anywhere; }
ul { margin: .4rem 0 1rem; padding-left: 1.2rem; max-width: 50rem; }
ul.marks { list-style: none; padding: 0; }
ul.marks li { padding: .12rem 0 .12rem 1.6rem; text-indent: -1.6rem; }
.mark { display: inline-block; width: 1.6rem; text-indent: 0; font-weight: 700; }
.met { color: var(--met); } .late { color: var(--late); } .missed { color: var(--missed); } .information { color: var(--soft); }
figure { margin: 0 0 1rem; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; border: 1px solid var(--line); border-radius: 3px; }
figcaption { font-size: .86rem; color: var(--soft); margin-top: .35rem; line-height: 1.45; }
.absent { background: var(--tint); border: 1px dashed #b6bdc6; border-radius: 3px; padding: 1.2rem;
          color: var(--soft); font-size: .9rem; overflow-wrap: anywhere; }
.two { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 1rem 1.25rem; }
.four { display: grid; grid-template-columns: repeat(4, 1fr); gap: 1rem .8rem; }
.one { max-width: 52rem; } .wide { max-width: 46rem; }
details { border-top: 1px solid var(--line); padding: .1rem 0; }
details:last-of-type { border-bottom: 1px solid var(--line); }
summary { cursor: pointer; font-weight: 600; padding: .45rem 0; }
summary:hover { color: #00578a; }
details[open] > summary { margin-bottom: .4rem; }
code { font: .92em ui-monospace, "DejaVu Sans Mono", monospace; }
@media (max-width: 46rem) {
  body { padding: 1.25rem .9rem 3rem; } h1 { font-size: 1.6rem; }
  header p { font-size: 1.02rem; } h2 { margin-top: 2rem; } summary { padding: .7rem 0; }
  .two { grid-template-columns: minmax(0, 1fr); } .four { grid-template-columns: 1fr 1fr; }
  th, td { padding-right: .7rem; } table { font-size: .86rem; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; } nav { display: none; }
  h2, h3 { break-after: avoid; } tr, pre { break-inside: avoid; }
  details::details-content { content-visibility: visible; display: block; }
  details { border: 0; } summary { list-style: none; padding: .8rem 0 .2rem; break-after: avoid; }
  section.experiment, #paper { break-before: page; } .one { max-width: 13cm; } a { color: inherit; }
}
)css";

constexpr const char* kPageFile = "report.html";
/// The figures of a report, in the format of sha256sum.
constexpr const char* kFigureList = "report-figures.sha256";

/// Whether a name of the list may be deleted: a figure in the folder itself, whatever the list says.
bool is_figure_name(const std::string& name) {
  const std::filesystem::path path(name);
  return !name.empty() && name.find('/') == std::string::npos &&
         (path.extension() == ".svg" || path.extension() == ".png");
}

/// Deletes a figure of an earlier report, unless it is a link or its content changed since.
void delete_stale_figure(const std::filesystem::path& file, const std::string& checksum) {
  std::error_code error;  // an error counts as absent: the file then stays
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error))) return;
  if (sha256_of_file(file) == checksum) std::filesystem::remove(file, error);
}

/// The list of an earlier report; empty: there is none, or the file cannot be one.
std::string read_figure_list(const std::filesystem::path& list) {
  constexpr InputKind kList{"the list of a report's figures", std::uint64_t{1} << 20};
  if (!regular_file_exists(list)) return {};
  try {
    return InputFile(list, kList).read_rest();
  } catch (const InputError&) {
    return {};
  }
}

void replace_figure_list(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& figures) {
  std::map<std::string, std::string> now;  // checksum by name
  for (const std::filesystem::path& figure : figures) {
    if ((figure.parent_path() / "").lexically_normal() == (folder / "").lexically_normal())
      now[figure.filename().string()] = sha256_of_file(figure);
  }
  const std::filesystem::path list = folder / kFigureList;
  constexpr std::size_t kChecksum = 64;  // digits; two blanks follow
  std::istringstream lines(read_figure_list(list));
  for (std::string line; std::getline(lines, line);) {
    if (line.size() < kChecksum + 2) continue;
    const std::string name = line.substr(kChecksum + 2);
    if (is_figure_name(name) && !now.contains(name))
      delete_stale_figure(folder / name, line.substr(0, kChecksum));
  }
  std::string text;
  for (const auto& [name, checksum] : now) text += checksum + "  " + name + "\n";
  replace_file(list, [&](const std::filesystem::path& file) { write_output(file, text); });
}

std::string read_bytes(const std::filesystem::path& file) {
  return InputFile(file, kPictureInput).read_rest();
}

}  // namespace

Page::Page(const std::string& title, const std::string& subtitle) : title_(title) {
  body_ = fmt::format("<header>\n<h1>{}</h1>\n<p>{}</p>\n</header>\n", escaped(title), escaped(subtitle));
}

void Page::section(const std::string& id, const std::string& heading) {
  if (in_section_) body_ += "</section>\n";
  in_section_ = true;
  const bool experiment = id.starts_with("experiment") || id == "details";
  body_ += fmt::format("<section id=\"{}\"{}>\n<h2>{}</h2>\n", escaped(id),
                       experiment ? " class=\"experiment\"" : "", escaped(heading));
}

void Page::heading(const std::string& text) { body_ += "<h3>" + escaped(text) + "</h3>\n"; }

void Page::paragraph(const std::string& html) { body_ += "<p>" + html + "</p>\n"; }

void Page::code(const std::string& text) { body_ += "<pre><code>" + escaped(text) + "</code></pre>\n"; }

void Page::list(const std::vector<std::string>& items) {
  if (items.empty()) return;
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += "<li>" + escaped(item) + "</li>\n";
  body_ += "</ul>\n";
}

void Page::html_list(const std::vector<std::string>& html_items, const std::string& css_class) {
  body_ += "<ul class=\"" + css_class + "\">\n";
  for (const std::string& item : html_items) body_ += "<li>" + item + "</li>\n";
  body_ += "</ul>\n";
}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& rows) {
  body_ += "<div class=\"scroll\"><table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : rows) {
    body_ += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), escaped(value));
  }
  body_ += "</tbody></table></div>\n";
}

void Page::table(const TableRows& html_rows) {
  body_ += "<div class=\"scroll\"><table>\n";
  for (std::size_t r = 0; r < html_rows.size(); ++r) {
    body_ += r == 0 ? "<thead><tr>" : "<tr>";
    for (std::size_t c = 0; c < html_rows[r].size(); ++c) {
      const bool head = r == 0 || c == 0;
      const std::string scope = r == 0 ? " scope=\"col\"" : " scope=\"row\"";
      body_ += (head ? "<th" + scope + ">" : "<td>") + html_rows[r][c] + (head ? "</th>" : "</td>");
    }
    body_ += r == 0 ? "</tr></thead>\n<tbody>\n" : "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::open_details(const std::string& heading) {
  body_ += "<details>\n<summary>" + escaped(heading) + "</summary>\n";
}

void Page::close_details() { body_ += "</details>\n"; }

void Page::open_grid(const std::string& css_class) { body_ += "<div class=\"" + css_class + "\">\n"; }

void Page::close_grid() { body_ += "</div>\n"; }

void Page::figures(const std::string& css_class, const std::vector<Figure>& figures) {
  if (figures.empty()) return;
  open_grid(css_class);
  for (const Figure& each : figures) figure(each);
  close_grid();
}

void Page::figure(const Figure& figure) {
  body_ += "<figure>\n";
  if (figure.missing.empty()) {
    files_.push_back(figure.file);
    const std::string type = figure.file.extension() == ".svg" ? "image/svg+xml" : "image/png";
    body_ += fmt::format("<img alt=\"{}\" src=\"data:{};base64,{}\">\n", escaped(figure.alternative), type,
                         base64(read_bytes(figure.file)));
  } else {
    body_ += fmt::format("<div class=\"absent\">{}: no figure. {}</div>\n", escaped(figure.alternative),
                         escaped(figure.missing));
  }
  if (!figure.caption.empty()) body_ += "<figcaption>" + escaped(figure.caption) + "</figcaption>\n";
  body_ += "</figure>\n";
}

std::string Page::html() const {
  constexpr const char* kPage = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{}</title>
<style>{}</style>
</head>
<body>
{}{}</body>
</html>
)";
  return fmt::format(kPage, escaped(title_), kStyle, body_, in_section_ ? "</section>\n" : "");
}

std::filesystem::path Page::write(const std::filesystem::path& folder) const {
  std::filesystem::path file = folder / kPageFile;
  write_output(file, html());
  replace_figure_list(folder, files_);
  return file;
}

void make_report_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !folder_exists(folder)) {
    throw InputError(folder.string() + ": the report's folder cannot be made" +
                     (error ? ": " + error.message() : ""));
  }
  for (const char* name : {kPageFile, kFigureList}) {
    if (folder_exists(folder / name))
      throw InputError((folder / name).string() + ": is a folder; the report writes a file of this name");
  }
}

bool is_report_file(const std::string& name) {
  const std::size_t digits = name.find_first_not_of("0123456789");
  const bool numbered = digits != std::string::npos && digits > 0 && name[digits] == '-';
  return name == kPageFile || name == kFigureList || (numbered && is_figure_name(name));
}

std::string fixed(double value, int digits) {
  const std::string text = fmt::format("{:.{}f}", value, digits);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.starts_with('-') ? text.substr(1) : text;
}

std::string grouped(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string escaped(std::string_view text) {
  static constexpr std::string_view kMarkup = "&<>\"'";
  static constexpr std::array<const char*, kMarkup.size()> kEntities = {"&amp;", "&lt;", "&gt;", "&quot;",
                                                                        "&#39;"};
  std::string result;
  for (const char c : text) {
    const std::size_t which = kMarkup.find(c);
    result += which < kEntities.size() ? kEntities[which] : std::string(1, c);
  }
  return result;
}

std::string utc_time(std::int64_t unix_ns) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(unix_ns / 1'000'000'000)));
}

std::string number(double value, const char* unit) {
  constexpr int kDigits = 6;
  return brief(value, kDigits) + (*unit == '\0' ? "" : " ") + unit;
}

std::string millimetres(double metres) { return number(metres * kMilli, "mm"); }

std::string point_mm(const Vec3& p) {
  const auto bare = [](double metres) {
    const std::string text = millimetres(metres);
    return text.substr(0, text.size() - 3);
  };
  return fmt::format("{}, {}, {} mm", bare(p.x()), bare(p.y()), bare(p.z()));
}

}  // namespace palpate::report

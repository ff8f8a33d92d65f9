#include "view/report/sections.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/mesh.h"

namespace palpate::report {
namespace {

constexpr double kLeastShown = 1e-5;  // N: a smaller difference from the law is shown as this one
constexpr std::size_t kAtDepth = 2;   // of the pictures: before contact, at contact, at depth, after

std::string anchor(std::size_t number) { return "experiment-" + std::to_string(number); }

std::string marked(const Check& check) {
  struct Sign {
    const char* css_class;
    const char* meaning;
    const char* text;
  };
  static constexpr std::array<Sign, 4> kSigns = {
      {{"met", "met", "✓"}, {"late", "note", "!"}, {"missed", "missed", "✗"}, {"information", "fact", "·"}}};
  const Sign& sign = kSigns.at(static_cast<std::size_t>(check.mark));
  return fmt::format("<span class=\"mark {}\" role=\"img\" aria-label=\"{}\">{}</span>{}", sign.css_class,
                     sign.meaning, sign.text, check.html);
}

std::string lower_first(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

void write_hand(Page& page, const HandAnalysis& hand, const HandFigures& figures, std::size_t hands) {
  if (hands > 1) page.heading("Hand " + std::to_string(hand.hand + 1));
  if (went_in(hand)) {  // three panels and a legend
    page.figures("one", {figures.law});
    page.figures("one", {figures.profile});
  } else {
    page.figures("two", {figures.law, figures.profile});
  }
}

void write_more_pictures(Page& page, const PictureSet& pictures) {
  page.figures("two", {pictures.close_ups[0], pictures.close_ups[1], pictures.close_ups[3]});
  page.paragraph(
      escaped(fmt::format("Drawn by {}, {} × {} pixels, all from the same two places. A picture of the "
                          "moving contact, 1280 × 720 pixels in balanced quality as in the window, takes {} "
                          "ms (p50), {} ms (p99), deformation included; the paper: 32 ms. Contacts of this "
                          "tool at its deepest tick: {}.",
                          pictures.driver, pictures.width, pictures.height, fixed(pictures.moving_p50_ms, 1),
                          fixed(pictures.moving_p99_ms, 1), pictures.contacts_at_depth)));
}

void write_over_time(Page& page, const HandAnalysis& hand, const HandFigures& figures, std::size_t hands) {
  if (hands > 1) page.heading("Hand " + std::to_string(hand.hand + 1));
  page.figures("one", {figures.over_time});
  page.facts({{"largest depth", fixed(hand.peak_depth * kMilli, 3) + " mm"},
              {"largest tissue force", fixed(hand.peak_tissue_force, 4) + " N"},
              {"largest force to the hand", fixed(hand.peak_device_force, 4) + " N, with noise"},
              {"largest step of force", fixed(hand.largest_step, 4) + " N between two ticks, with noise"}});
}

void write_timing(Page& page, const ExperimentResults& worked) {
  const Analysis& analysis = worked.analysis;
  const bool offline = worked.experiment->recording->facts.offline;
  page.figures("two", {worked.tick_time, worked.lateness});
  const auto row = [](const std::string& name, const Percentiles& p) {
    return std::vector<std::string>{name, microseconds(p.p50), microseconds(p.p99), microseconds(p.p999),
                                    microseconds(p.max)};
  };
  TableRows rows{{"µs", "p50", "p99", "p99.9", "max"}};
  if (is_timed(analysis)) rows.push_back(row("computing time of a tick", analysis.tick_time.figures));
  if (!offline) rows.push_back(row("lateness of a tick", analysis.lateness.figures));
  if (rows.size() > 1) page.table(rows);
  if (offline) {
    page.paragraph("The run was offline: there are no deadlines to miss.");
    return;
  }
  page.paragraph(
      fmt::format("Missed deadlines (a full period or more late): <strong>{}</strong> of {} ticks. Longest "
                  "gap between two ticks: {} µs.",
                  grouped(analysis.missed), grouped(analysis.ticks),
                  microseconds(worked.experiment->recording->facts.longest_gap_ns)));
}

void write_folded(Page& page, const ExperimentResults& worked) {
  page.open_details("Checks");
  std::vector<std::string> checks;
  for (const Check& check : checks_of(worked)) checks.push_back(marked(check));
  page.html_list(checks, "marks");
  page.close_details();
  if (worked.pictures.missing.empty()) {
    page.open_details("More pictures");
    write_more_pictures(page, worked.pictures);
    page.close_details();
  }
  const std::size_t hands = worked.hands.size();
  page.open_details("Force and depth over time");
  for (std::size_t i = 0; i < hands; ++i)
    write_over_time(page, worked.analysis.hands[i], worked.hands[i], hands);
  page.close_details();
  page.open_details("Touch noise");
  for (const HandFigures& figures : worked.hands)
    page.figures("two", {figures.noise_spectrum, figures.noise_histogram});
  page.close_details();
  page.open_details("Timing");
  write_timing(page, worked);
  page.close_details();
  page.open_details("What was run");
  write_what_was_run(page, worked);
  page.close_details();
}

std::string mesh_count(const geometry::TriangleMesh& mesh) {
  return grouped(mesh.vertices.size()) + " vertices, " + grouped(mesh.triangles.size()) + " triangles";
}

std::string tool_count(const std::vector<geometry::Tool>& tools) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const geometry::Tool& tool : tools) {
    for (const geometry::ToolPart& part : tool.parts) {
      vertices += part.mesh.vertices.size();
      triangles += part.mesh.triangles.size();
    }
  }
  return fmt::format("{} vertices, {} triangles", grouped(vertices), grouped(triangles));
}

std::string picture_time(const PictureSet& pictures) {
  if (!pictures.missing.empty()) return "not drawn";
  std::string text =
      fmt::format("{} ms p50, {} ms p99 (in motion, balanced; {})", fixed(pictures.moving_p50_ms, 1),
                  fixed(pictures.moving_p99_ms, 1), escaped(pictures.driver));
  if (pictures.driver.find("llvmpipe") != std::string::npos)
    text += ": drawn by the processor, without a graphics card";
  return text;
}

/// Results of the paper beside these, for one experiment. [Zhang 2011, section 3]
TableRows comparison(const ExperimentResults& worked) {
  const bool pull = is_pull(worked);
  const scene::Scene& scene = worked.experiment->recording->scene;
  const Percentiles& tick = worked.analysis.tick_time.figures;
  constexpr double kNewtonPerCentimetre = 1e-2;  // in 1 N/m
  return {
      {"", pull ? "paper: heart pulled, straight forceps" : "paper: gallbladder pressed, curved forceps",
       "this run: " + escaped(lower_first(worked.experiment->title))},
      {"k₁", pull ? "0.15 N/cm" : "0.18 N/cm", brief(scene.tissue.k1 * kNewtonPerCentimetre) + " N/cm"},
      {"β", pull ? "2.0" : "1.6", brief(scene.tissue.beta)},
      {"organ", pull ? "3,000 vertices, 6,412 triangles" : "1,057 vertices, 2,110 triangles",
       mesh_count(scene.organ)},
      {"instrument", pull ? "612 vertices, 1,207 triangles" : "461 vertices, 921 triangles",
       tool_count(scene.tools)},
      {"one force", pull ? "not given" : "under 1 ms",
       is_timed(worked.analysis)
           ? fmt::format("{} µs p50, {} µs p99, {} µs max (whole tick: contact, force, noise, gate)",
                         microseconds(tick.p50), microseconds(tick.p99), microseconds(tick.max))
           : "not recorded: the run was offline"},
      {"one picture", pull ? "not given" : "32 ms", picture_time(worked.pictures)},
      {"largest depth", "not given", fixed(main_hand(worked).peak_depth * kMilli, 2) + " mm"},
      {"largest tissue force", "not given", fixed(main_hand(worked).peak_tissue_force, 3) + " N"},
  };
}

}  // namespace

const HandAnalysis& main_hand(const ExperimentResults& worked) {
  return *std::max_element(
      worked.analysis.hands.begin(), worked.analysis.hands.end(),
      [](const HandAnalysis& a, const HandAnalysis& b) { return a.peak_depth < b.peak_depth; });
}

bool is_timed(const Analysis& analysis) { return analysis.tick_time.figures.max > 0; }

bool is_pull(const ExperimentResults& worked) { return worked.analysis.direction == model::Direction::kPull; }

std::string microseconds(std::int64_t ns) { return fixed(static_cast<double>(ns) * 1e-3, 1); }

std::string lead_sentence(const std::vector<ExperimentResults>& all) {
  std::string text;
  double beside_law = 0.0;  // N
  for (const ExperimentResults& worked : all) {
    const HandAnalysis& hand = main_hand(worked);
    const std::string title = worked.experiment->title;
    if (all.size() == 1) {  // the page has the title already
      text = hand.peak_depth > 0.0
                 ? fmt::format("{} mm {} with up to {} N", fixed(hand.peak_depth * kMilli, 1),
                               is_pull(worked) ? "far" : "deep", fixed(hand.peak_tissue_force, 2))
                 : "The tool did not touch the organ";
      if (!went_in(hand)) beside_law = hand.law.p95;
      break;
    }
    text += text.empty() ? title : ", and " + lower_first(title);
    text += hand.peak_depth > 0.0
                ? fmt::format(" to {} mm with up to {} N", fixed(hand.peak_depth * kMilli, 1),
                              fixed(hand.peak_tissue_force, 2))
                : ", which it did not touch";
    for (const HandAnalysis& each : worked.analysis.hands) beside_law = std::max(beside_law, each.law.p95);
  }
  if (beside_law > 0.0) {
    text += fmt::format("; the force stayed within {} mN of the model's law for 95\u00a0% of the contact",
                        brief(std::max(beside_law, kLeastShown) * kMilli, 2));
  }
  return text + ".";
}

void write_summary(Page& page, const std::vector<ExperimentResults>& all) {
  std::vector<Figure> pictures;
  std::string missing;
  for (const ExperimentResults& worked : all) {
    if (!worked.pictures.missing.empty()) {
      missing = worked.pictures.missing;
      continue;
    }
    Figure picture = worked.pictures.close_ups[kAtDepth];
    if (all.size() > 1) picture.caption = worked.experiment->title + ". " + picture.caption;
    pictures.push_back(std::move(picture));
  }
  page.figures(pictures.size() == 1 ? "wide" : "two", pictures);
  if (!missing.empty()) page.paragraph("There are no pictures of organ and tool: " + escaped(missing));
  std::vector<std::string> attention;
  std::uint64_t late = 0;   // ticks, of runs with Mark::kLate
  std::uint64_t ticks = 0;  // of these runs
  for (const ExperimentResults& worked : all) {
    for (Check check : checks_of(worked)) {
      if (check.mark == Mark::kLate) {
        late += worked.analysis.missed;
        ticks += worked.analysis.ticks;
      } else if (check.mark == Mark::kMissed) {
        if (all.size() > 1) check.html = escaped(worked.experiment->title) + ": " + check.html;
        attention.push_back(marked(check));
      }
    }
  }
  if (late > 0) attention.push_back(marked(deadline_check(late, ticks)));
  if (!attention.empty()) page.html_list(attention, "marks");
}

void write_experiment(Page& page, const ExperimentResults& worked, std::size_t number, bool several) {
  page.section(anchor(number), several ? worked.experiment->title : "Force and deformation");
  for (std::size_t i = 0; i < worked.hands.size(); ++i)
    write_hand(page, worked.analysis.hands[i], worked.hands[i], worked.hands.size());
  if (worked.pictures.missing.empty()) page.figures("four", worked.pictures.overviews);
}

void write_details(Page& page, const std::vector<ExperimentResults>& all) {
  page.section("details", "Details");
  for (const ExperimentResults& worked : all) {
    if (all.size() > 1) page.heading(worked.experiment->title);
    write_folded(page, worked);
  }
}

void write_comparison(Page& page, const std::vector<ExperimentResults>& all) {
  page.section("paper", "Beside the paper");
  for (const ExperimentResults& worked : all) page.table(comparison(worked));
  page.paragraph(
      "X. Zhang, W. Sun, A. Song, J. Li, J. Liu: Enhanced haptic model for real-time "
      "human-computer interaction, 2011. Its figures are of its own machine of that time.");
}

}  // namespace palpate::report

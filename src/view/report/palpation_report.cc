#include "view/report/palpation_report.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "io/system/output_file.h"
#include "palpate/units.h"
#include "view/render/map_legend.h"
#include "view/report/page.h"
#include "view/report/sections.h"
#include "view/report/subject.h"

namespace palpate::report {
namespace {

std::string mm(double length) { return fixed(length / kMillimetre, 1) + " mm"; }

TableRows measure_rows(const palpation::AnyScore& score) {
  TableRows rows{{"measure", "value", "definition"}};
  for (const palpation::Measure& one : palpation::measures(score)) {
    rows.push_back({one.name, one.value, escaped(one.definition)});
  }
  return rows;
}

TableRows lumps_and_marks(const palpation::Score& score) {
  TableRows rows{{"lump or mark", "place, organ frame", "result"}};
  for (const palpation::Lump& lump : score.lumps) {
    rows.push_back({escaped(lump.name), point_mm(Vec3((lump.place_S * 1e4).array().round() * 1e-4)),
                    lump.found     ? "found"
                    : lump.covered ? "missed, though touched"
                                   : "missed, never touched"});
  }
  for (const palpation::Mark& mark : score.marks) {
    rows.push_back({fmt::format("mark at tick {}", mark.tick),
                    point_mm(Vec3((mark.place_S * 1e4).array().round() * 1e-4)),
                    mark.lump
                        ? fmt::format("{} from {}", mm(mark.distance), escaped(score.lumps[*mark.lump].name))
                    : score.lumps.empty() ? "no lump"
                                          : "false, " + mm(mark.distance) + " from the nearest lump"});
  }
  return rows;
}

Figure draw_figure(const scene::Scene& scene, const palpation::Scorer& scorer,
                   const std::filesystem::path& file) {
  Figure figure{file, "the organ from above, coloured by the felt and the true stiffness"};
  figure.caption =
      "Stiffness divided by that of the uniform tissue at the same depth. Left as the hand felt it, right as "
      "the tissue is; where the organ has its natural colour it was not pressed. Rings: lumps; dots: marks "
      "that found one; crosses: false marks.";
  try {
    const render::Image picture = draw_felt_stiffness(scene, scorer);
    replace_file(file, [&](const std::filesystem::path& made) { render::write_png(picture, made); });
  } catch (const std::exception& error) {
    figure.missing = error.what();
  }
  return figure;
}

}  // namespace

std::vector<float> felt_factors(const palpation::FeltMap& map) {
  std::vector<float> factors(map.surface().vertices.size());
  for (std::size_t v = 0; v < factors.size(); ++v) factors[v] = static_cast<float>(map.at(v).factor);
  return factors;
}

FactorRange range_of(const palpation::FeltMap& map) {
  constexpr double kTail = 0.005;  // share of the vertices at each end that may lie outside
  std::vector<double> factors{1.0, 1.2};
  for (std::size_t v = 0; v < map.surface().vertices.size(); ++v) {
    const double felt = map.at(v).factor;
    if (!std::isnan(felt)) factors.push_back(felt);
  }
  // A step of 0.05 keeps the legend's numbers short.
  const double low = std::min(1.0, quantile(factors, kTail));
  const double high = std::max(1.2, quantile(factors, 1.0 - kTail));
  return {std::round(20.0 * low) / 20.0, std::ceil(20.0 * high - 1e-6) / 20.0};
}

std::vector<render::SurfaceMark> marks_of(const palpation::Score& score) {
  using Kind = render::SurfaceMark::Kind;
  std::vector<render::SurfaceMark> marks;
  for (const palpation::Lump& lump : score.lumps) marks.push_back({lump.place_S, Kind::kLump});
  for (const palpation::Mark& mark : score.marks) {
    if (marks.size() == render::kMaxMarks) break;
    marks.push_back({mark.place_S, mark.lump ? Kind::kFound : Kind::kFalse});
  }
  return marks;
}

render::Image draw_felt_stiffness(const scene::Scene& scene, const palpation::Scorer& scorer, int height) {
  const int width = height * 8 / 7;
  const palpation::FeltMap& map = scorer.map();
  render::Subject subject = subject_of(scene);
  subject.inclusions.clear();
  haptics::Snapshot at_rest;
  at_rest.organ_W = scene.organ_pose;
  render::OffscreenRenderer renderer(subject, width, height);
  const render::Camera camera =
      render::frame_from_above(subject, at_rest, static_cast<double>(width) / height);
  const FactorRange range = range_of(map);
  renderer.show_values({map.surface().vertices, felt_factors(map), range.low, range.high});
  renderer.show_marks(marks_of(scorer.score()));
  render::Image left = renderer.draw(at_rest, camera);
  std::vector<float> truth(map.surface().vertices.size());
  for (std::size_t v = 0; v < truth.size(); ++v) truth[v] = static_cast<float>(map.true_factor(v));
  renderer.update_values(truth);
  render::Image right = renderer.draw(at_rest, camera);
  render::draw_title(left, "Felt");
  render::draw_title(right, "True");
  return render::side_by_side(render::side_by_side(left, right),
                              render::legend_panel(height, range.low, range.high, "x"));
}

std::filesystem::path write_palpation_report(const scene::Scene& scene, const palpation::Scorer& scorer,
                                             const std::filesystem::path& folder,
                                             const std::string& command) {
  make_report_folder(folder);
  const palpation::Score score = scorer.score();
  Page page("Search for lumps: " + scene.name,
            fmt::format("{} of {} found, {} false", score.found, score.lumps.size(), score.wrong));
  page.section("score", "Score");
  page.table(measure_rows(score));
  page.section("maps", "What the hand felt, and what there is");
  page.figures("", {draw_figure(scene, scorer, folder / "felt-stiffness.png")});
  page.section("places", "Lumps and marks");
  page.table(lumps_and_marks(score));
  page.section("run", "How it was made");
  page.facts({{"scene", scene.name},
              {"organ", scene.organ_name},
              {"seed", std::to_string(scene.seed)},
              {"tolerance", mm(scene.search.tolerance)}});
  page.code(command);
  return page.write(folder);
}

std::filesystem::path write_insertion_report(const record::Recording& recording,
                                             const palpation::AnyScore& any,
                                             const std::filesystem::path& folder,
                                             const std::string& command) {
  make_report_folder(folder);
  const scene::Scene& scene = recording.scene;
  const auto& score = std::get<palpation::InsertionScore>(any);
  Page page("Insertion: " + scene.name, score.targets == 0               ? "no target"
                                        : score.reached == score.targets ? "target reached"
                                                                         : "target missed");
  page.section("score", "Score");
  page.table(measure_rows(any));
  std::vector<Figure> figures;
  for (const HandAnalysis& hand : analyse(recording).hands) {
    if (!went_in(hand)) continue;
    const std::string name = fmt::format("{}-needle.svg", hand.hand + 1);
    figures.push_back(draw_needle(hand, scene, folder / name));
  }
  page.section("force", "Force along the needle");
  page.figures("", figures);
  page.section("run", "How it was made");
  page.facts({{"scene", scene.name},
              {"organ", scene.organ_name},
              {"tissue", scene.tissue.name},
              {"seed", std::to_string(scene.seed)}});
  page.code(command);
  return page.write(folder);
}

}  // namespace palpate::report

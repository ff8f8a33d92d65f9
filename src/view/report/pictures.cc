#include <algorithm>
#include <array>
#include <exception>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "io/system/clock.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/offscreen.h"
#include "palpate/recording.h"
#include "view/report/page.h"
#include "view/report/sections.h"
#include "view/report/subject.h"

namespace palpate::report {
namespace {

constexpr std::size_t kMovingPictures = 60;
constexpr int kMovingWidth = 1280;  // pixels, about a window's
constexpr int kMovingHeight = 720;
constexpr double kPicturePeriod = 1.0 / 60.0;  // s
constexpr int kUntimedPictures = 3;            // shaders are compiled at their first use

struct NamedMoment {
  const char* name;
  const char* file;
  std::size_t row;
};

std::array<NamedMoment, 4> named(const KeyTicks& key_ticks) {
  return {{{"before contact", "1-before", key_ticks.rest},
           {key_ticks.contact ? "at contact" : "at its nearest", "2-contact", key_ticks.touch},
           {"at depth", "3-depth", key_ticks.deepest},
           {"after", "4-after", key_ticks.after}}};
}

/// The ticks of the moving pictures that are timed: from first contact on, as a window shows them.
std::vector<std::uint64_t> moving_ticks(const HandAnalysis& hand) {
  std::vector<std::uint64_t> ticks;
  double next = 0.0;  // s
  for (std::size_t i = hand.key_ticks.touch; i < hand.rows.size() && ticks.size() < kMovingPictures; ++i) {
    if (!ticks.empty() && hand.rows[i].time < next) continue;
    ticks.push_back(hand.rows[i].tick);
    next = hand.rows[i].time + kPicturePeriod;
  }
  return ticks;
}

/// Sets the time of moving pictures: drawn where they changed, as in the window with a still camera.
void time_moving(const render::Subject& subject, const std::vector<haptics::Snapshot>& moving,
                 const render::Camera& camera, PictureSet& set) {
  render::OffscreenRenderer renderer(subject, kMovingWidth, kMovingHeight, render::Quality::kBalanced);
  renderer.show_drape(true);
  for (int i = 0; i < kUntimedPictures; ++i) renderer.draw_and_keep(moving.front(), camera);
  renderer.finish();
  std::vector<double> times;
  for (const haptics::Snapshot& snapshot : moving) {
    const std::int64_t start = monotonic_ns();
    renderer.draw_and_keep(snapshot, camera);
    renderer.finish();
    times.push_back(static_cast<double>(monotonic_ns() - start) * 1e-6);
  }
  set.moving_p50_ms = quantile(times, 0.5);
  set.moving_p99_ms = quantile(times, 0.99);
}

/// Averages blocks of two by two pixels.
render::Image halved(const render::Image& image) {
  render::Image small;
  small.width = image.width / 2;
  small.height = image.height / 2;
  const auto at = [&image](int x, int y, int channel) {
    return static_cast<unsigned>(image.rgb[static_cast<std::size_t>((y * image.width + x) * 3 + channel)]);
  };
  for (int y = 0; y < 2 * small.height; y += 2) {
    for (int x = 0; x < 2 * small.width; x += 2) {
      for (int c = 0; c < 3; ++c) {
        const unsigned sum = at(x, y, c) + at(x + 1, y, c) + at(x, y + 1, c) + at(x + 1, y + 1, c);
        small.rgb.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
      }
    }
  }
  return small;
}

/// Moves the camera back, so that a moving organ stays in the picture.
render::Camera with_room(render::Camera camera, const render::Subject& subject,
                         const std::vector<model::OrganMotionParameters>& motions) {
  double way = 0.0;
  for (const model::OrganMotionParameters& motion : motions) way += motion.amplitude;
  const double size = geometry::bounds(subject.organ).size().norm();
  if (way > 0.0 && size > 0.0) camera.eye += (2.0 * way / size) * (camera.eye - camera.target);
  return camera;
}

/// @param organ_moved m, displacement of the organ's centre from its rest position
std::string caption_of(std::string text, const haptics::TickRow& row, double organ_moved) {
  text[0] = static_cast<char>(text[0] - 'a' + 'A');
  text += ": " + fixed(row.time, 3) + " s";
  constexpr double kMoved = 0.05e-3;  // m: smallest displacement in a caption
  if (organ_moved > kMoved) text += ", organ " + fixed(organ_moved * kMilli, 1) + " mm from rest";
  if (row.phase == 0) return fmt::format("{}, {} mm away", text, fixed(row.distance * kMilli, 1));
  return fmt::format("{}, depth {} mm, tissue force {} N", text,
                     fixed(std::max(row.depth, -row.distance) * kMilli, 2), fixed(row.tissue_force, 3));
}

Figure written(const render::Image& image, Figure figure) {
  replace_file(figure.file, [&](const std::filesystem::path& file) { render::write_png(image, file); });
  return figure;
}

/// The same camera for all moments, chosen at the largest depth, so that only organ and tool differ.
render::Camera camera_of(const render::Subject& subject, const HandAnalysis& hand,
                         const ReplayedMoments& moments, bool close_up) {
  const haptics::Snapshot& deepest = moments.named[2];
  const contact::ToolResult& result = deepest.results[hand.hand];
  const bool contact = hand.key_ticks.contact;
  return render::frame_contact(subject, deepest, contact ? result.contact_W : result.nearest_W,
                               contact ? result.normal_W : result.away_W, close_up);
}

void draw_all(const record::Recording& recording, const HandAnalysis& hand, const ReplayedMoments& moments,
              const std::filesystem::path& folder, const std::string& prefix, const ReportOptions& options,
              PictureSet& set) {
  const std::vector<haptics::Snapshot>& snapshots = moments.named;
  const scene::Scene& scene = recording.scene;
  const render::Subject subject = subject_of(scene);
  render::OffscreenRenderer renderer(subject, options.picture_width, options.picture_height);
  renderer.show_drape(true);
  set.driver = renderer.driver();
  set.width = options.picture_width;
  set.height = options.picture_height;

  const render::Camera near = camera_of(subject, hand, moments, true);
  const render::Camera wide =
      with_room(camera_of(subject, hand, moments, false), subject, scene.organ_motion);
  set.contacts_at_depth = snapshots[2].results[hand.hand].view_count;

  const Vec3 middle = geometry::bounds(scene.organ).middle();
  std::size_t i = 0;
  for (const NamedMoment& moment : named(hand.key_ticks)) {
    const std::string what = scene.organ_name + " and tool " + moment.name;
    const double moved = (snapshots[i].organ_W * middle - scene.organ_pose * middle).norm();
    const auto file = [&](const char* end) { return folder / (prefix + moment.file + end); };
    set.overviews.push_back(
        written(halved(renderer.draw(snapshots[i], wide)),
                {file(".png"), what + ", overview", std::string("Overview, ") + moment.name}));
    set.close_ups.push_back(written(
        renderer.draw(snapshots[i], near),
        {file("-close.png"), what + ", close-up", caption_of(moment.name, hand.rows[moment.row], moved)}));
    ++i;
  }
  time_moving(subject, moments.moving, wide, set);
}

}  // namespace

ReplayedMoments replay_moments(const record::Recording& recording, const HandAnalysis& hand,
                               const std::vector<std::uint64_t>& profile_ticks) {
  std::vector<std::uint64_t> ticks;
  for (const NamedMoment& moment : named(hand.key_ticks)) ticks.push_back(hand.rows[moment.row].tick);
  const std::vector<std::uint64_t> moving = moving_ticks(hand);
  std::vector<std::uint64_t> ascending = ticks;
  ascending.insert(ascending.end(), moving.begin(), moving.end());
  ascending.insert(ascending.end(), profile_ticks.begin(), profile_ticks.end());
  std::sort(ascending.begin(), ascending.end());
  ascending.erase(std::unique(ascending.begin(), ascending.end()), ascending.end());
  const std::vector<haptics::Snapshot> taken = record::snapshots_at(recording, ascending);
  const auto at = [&](std::uint64_t tick) {
    const auto place = std::lower_bound(ascending.begin(), ascending.end(), tick) - ascending.begin();
    return taken.at(static_cast<std::size_t>(place));
  };
  ReplayedMoments result;
  for (const std::uint64_t tick : ticks) result.named.push_back(at(tick));
  for (const std::uint64_t tick : moving) result.moving.push_back(at(tick));
  for (const std::uint64_t tick : profile_ticks) result.profiles.push_back(at(tick));
  return result;
}

Vec3 across_pictures_S(const record::Recording& recording, const HandAnalysis& hand,
                       const ReplayedMoments& moments) {
  const render::Camera camera = camera_of(subject_of(recording.scene), hand, moments, true);
  const Vec3 right_W = (camera.target - camera.eye).cross(camera.up).normalized();
  return moments.named[2].organ_W.rotation.conjugate() * right_W;
}

PictureSet draw_pictures(const record::Recording& recording, const HandAnalysis& hand,
                         const ReplayedMoments& moments, const std::filesystem::path& folder,
                         const std::string& prefix, const ReportOptions& options) {
  PictureSet set;
  if (!options.pictures) {
    set.missing = "they were not asked for";
    return set;
  }
  try {
    draw_all(recording, hand, moments, folder, prefix, options, set);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    set = PictureSet{};
    set.missing = error.what();
  }
  return set;
}

}  // namespace palpate::report

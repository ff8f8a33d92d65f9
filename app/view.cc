// `palpate view`: shows a recording in a window, or draws pictures and films of it.
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/text.h"
#include "io/system/child_process.h"
#include "io/system/file_content.h"
#include "palpate/error.h"
#include "palpate/offscreen.h"
#include "palpate/units.h"
#include "view/render/map_legend.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/numbers.h"
#include "app/progress.h"
#include "app/recorded_view.h"
#include "app/session.h"
#include "app/window/run_in_window.h"
#include "app/window/viewer.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

// Starts ffmpeg, which reads raw RGB pictures from a pipe. Returns ffmpeg's process id and the end of the
// pipe that the pictures are written to.
std::pair<int, int> start_ffmpeg(const fs::path& file, int width, int height, double frames_a_second) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw InputError(file.string() + ": cannot make a pipe to ffmpeg: " + std::strerror(errno));
  std::istringstream flags(fmt::format(
      "ffmpeg -nostdin -loglevel error -y -f rawvideo -pix_fmt rgb24 -s {}x{} -r {} -i pipe:0 -an "
      "-c:v libx264 -crf 18 -pix_fmt yuv420p -movflags +faststart",
      width, height, shortest(frames_a_second)));
  std::vector<std::string> arguments(std::istream_iterator<std::string>(flags), {});
  arguments.push_back(file.string());
  std::error_code error;
  const int child = start_process({.arguments = std::move(arguments), .input = ends[0]}, error);
  close(ends[0]);
  if (error) {
    close(ends[1]);
    throw InputError(file.string() + ": cannot start ffmpeg: " + error.message());
  }
  return {child, ends[1]};
}

/// [any] Whether ffmpeg is on the PATH.
bool ffmpeg_installed() {
  const char* path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nothing writes it
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

/// Writes the pictures of a film in order: to ffmpeg, which encodes them, or as PNG files to a folder.
class Film final {
 public:
  /// [setup] Starts ffmpeg when it is installed; otherwise makes the folder FILE-frames in the file's folder.
  /// @param width, height size of the pictures [px] @param frames_a_second frame rate [Hz]
  /// @throws InputError when ffmpeg cannot be started, or the folder cannot be made.
  Film(fs::path file, int width, int height, double frames_a_second) : file_(std::move(file)) {
    if (ffmpeg_installed()) {
      std::signal(SIGPIPE, SIG_IGN);  // write() reports an ffmpeg that died, so the message can explain it
      const auto [child, pipe] = start_ffmpeg(file_, width, height, frames_a_second);
      child_ = child;
      pipe_ = pipe;
      return;
    }
    folder_ = file_;
    folder_.replace_extension();
    folder_ += "-frames";
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed) throw InputError(folder_.string() + ": the folder cannot be made: " + failed.message());
  }

  ~Film() {
    if (pipe_ >= 0) close(pipe_);
    if (child_ > 0) waitpid(child_, nullptr, 0);
  }
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// [setup] Writes the next picture. @throws InputError when it cannot be written.
  void add(const render::Image& picture) {
    ++frames_;
    if (!folder_.empty()) {
      render::write_png(picture, folder_ / fmt::format("{:06}.png", frames_));
      return;
    }
    std::size_t done = 0;
    while (done < picture.rgb.size()) {
      const ssize_t written = write(pipe_, picture.rgb.data() + done, picture.rgb.size() - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0)
        throw InputError(file_.string() +
                         ": ffmpeg stopped before the end of the film; its messages are above");
      done += static_cast<std::size_t>(written);
    }
  }

  /// [setup] Ends the film. @return a message with the number of pictures and their file or folder
  /// @throws InputError when ffmpeg failed.
  [[nodiscard]] std::string finish() {
    const std::string count = std::to_string(frames_) + " pictures";
    if (!folder_.empty())
      return fmt::format(
          "{} as PNG files in {}: a film needs ffmpeg, which is not installed (Debian package ffmpeg)", count,
          folder_.string());
    close(pipe_);
    pipe_ = -1;
    int status = 0;
    const int child = std::exchange(child_, -1);
    if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
      throw InputError(file_.string() + ": ffmpeg could not make the film; its messages are above");
    return count + " in " + file_.string();
  }

 private:
  fs::path file_;
  fs::path folder_;  // folder of the PNG files; empty: ffmpeg makes the film
  int pipe_ = -1;    // file descriptor that ffmpeg reads from; -1: none
  int child_ = -1;   // process id of ffmpeg; -1: none
  std::size_t frames_ = 0;
};

struct ViewFlags {
  std::string file;
  std::string screenshot;
  std::string video;
  std::optional<double> at, from, to;  // s, times in the recording
  double fps = 30.0;
  double slow = 1.0;
  Display::Size size;      // width 0: the default size
  double map_range = 0.0;  // largest displacement of the colour map [m]; 0: no map
  std::optional<render::Quality> quality;
  std::string ui_scale;
  bool close_up = false;
  bool drape = false;
  bool no_cache = false;
  bool break_blind = false;

  [[nodiscard]] bool window() const { return screenshot.empty() && video.empty(); }
};

constexpr std::uint64_t kLargestSide = 8192;
constexpr double kMaxFrames = 1e6;

Display::Size parse_size(const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos)
    throw InputError("--size " + text + ": must be WIDTHxHEIGHT in pixels, e.g. 1280x720");
  const std::uint64_t width = parse_whole("--size", text.substr(0, cross));
  const std::uint64_t height = parse_whole("--size", text.substr(cross + 1));
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
    throw InputError("--size " + text + ": must be 1 to 8192 pixels per side");
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// Returns the flags with defaults for those not given. Checks everything that can be checked without the
/// recording. @throws InputError
ViewFlags checked(ViewFlags flags) {
  refuse_other_content(flags.file, FileContent::kRecording, "a palpate recording");
  if (flags.window() && !display_there())
    throw InputError(
        "view " + flags.file +
        ": there is no display for a window: use --screenshot FILE.png (one moment, --at-s T) or "
        "--video FILE.mp4 (--from-s, --to-s, --fps, --slow)");
  (void)UiScale::asked(flags.ui_scale);  // checks the value before the recording is read
  if (flags.size.width == 0)
    flags.size = flags.window() ? Display::Size{1440, 900} : Display::Size{1280, 720};
  if (!flags.quality)
    flags.quality = flags.video.empty() ? render::Quality::kFull : render::Quality::kBalanced;
  if (!flags.video.empty() && (flags.size.width % 2 != 0 || flags.size.height % 2 != 0))
    throw InputError(fmt::format("--size {}x{}: a film's width and height must be even", flags.size.width,
                                 flags.size.height));
  if (!flags.screenshot.empty()) require_png_file(flags.screenshot, "--screenshot");
  if (!flags.video.empty()) require_regular_file(flags.video, "--video");
  require_no_overwrite(std::vector<NamedFile>{{"--screenshot", flags.screenshot}, {"--video", flags.video}},
                       std::vector<NamedFile>{{"the recording", flags.file}});
  return flags;
}

// Draws pictures of one recording for files.
class FilePictures final {
 public:
  FilePictures(RecordedView& seen, const ViewFlags& flags)
      : seen_(seen),
        map_range_(flags.map_range),
        camera_(seen.camera(0, flags.close_up)),
        renderer_(seen.subject(), flags.size.width, flags.size.height, *flags.quality) {
    renderer_.set_map_range(map_range_);
    renderer_.show_drape(flags.drape);
  }

  [[nodiscard]] render::Image at(double time) {
    render::Image picture = renderer_.draw(seen_.frames().at(seen_.tick_at(time)), camera_);
    render::draw_map_legend(picture, map_range_);
    return picture;
  }

 private:
  RecordedView& seen_;
  double map_range_;  // largest displacement of the colour map [m]; 0: no map
  render::Camera camera_;
  render::OffscreenRenderer renderer_;
};

void require_within(const char* flag, double time, const RecordedView& seen) {
  if (time > seen.duration_s())
    throw InputError(fmt::format("{} {}: {} ends at {} s", flag, shortest(time), seen.file().string(),
                                 shortest(seen.duration_s())));
}

void make_film(FilePictures& pictures, const RecordedView& seen, const ViewFlags& flags, Progress& bar) {
  const double from = flags.from.value_or(0.0);
  const double to = flags.to.value_or(seen.duration_s());
  require_within("--from-s", from, seen);
  require_within("--to-s", to, seen);
  if (from > to)
    throw InputError(fmt::format("--from-s {}: later than --to-s {}", shortest(from), shortest(to)));
  const double count = std::floor((to - from) * flags.slow * flags.fps) + 1.0;
  if (!(count <= kMaxFrames))
    throw InputError(fmt::format(
        "--video {}: {} pictures; must be at most a million: shorten it, or lower --fps or --slow",
        flags.video, shortest(count)));
  Film film(flags.video, flags.size.width, flags.size.height, flags.fps);
  for (int i = 0; i < static_cast<int>(count); ++i) {
    film.add(pictures.at(from + i / (flags.fps * flags.slow)));
    bar.update(i / count, "drawing " + flags.video);
  }
  const std::string made = film.finish();
  bar.clear();
  report_message(made);
}

int view_in_window(std::unique_ptr<RecordedView> seen, const ViewFlags& flags) {
  ViewerOptions options;
  options.at_s = flags.at;
  options.map_range = flags.map_range;
  options.close_up = flags.close_up;
  options.drape = flags.drape;
  options.no_cache = flags.no_cache;
  options.size = flags.size;
  options.scale = UiScale::asked(flags.ui_scale);
  const StopOnSignal signals;
  options.stop = &signals.flag();
  try {
    view_in_window(std::move(seen), options);
  } catch (const NoWindow& error) {
    throw InputError(
        fmt::format("view {}: {}; --screenshot and --video need no window", flags.file, error.what()));
  }
  return kDone;
}

int view(const ViewFlags& asked) {
  const ViewFlags flags = checked(asked);
  Progress bar("view");
  auto seen = std::make_unique<RecordedView>(
      flags.file, flags.no_cache, [&](double share) { bar.update(0.1 * share, "reading " + flags.file); },
      flags.break_blind);
  if (flags.at) require_within("--at-s", *flags.at, *seen);
  if (flags.window()) {
    bar.clear();
    return view_in_window(std::move(seen), flags);
  }
  FilePictures pictures(*seen, flags);
  if (!flags.screenshot.empty()) {
    const double time = flags.at.value_or(seen->time_of(seen->frames().deepest()));
    render::write_png(pictures.at(time), flags.screenshot);
    bar.clear();
    report_message(fmt::format("{} shows {} s{}", flags.screenshot, shortest(time),
                               flags.at ? "" : ", when the contact is deepest"));
  }
  if (!flags.video.empty()) make_film(pictures, *seen, flags, bar);
  return kDone;
}

void add_flags(CLI::App& command, ViewFlags& flags) {
  command.add_option("recording", flags.file, "The recording (.h5)")->required();
  command.add_option("--screenshot", flags.screenshot, "Write one picture to this PNG file");
  add_number(command, "--at-s", flags.at, Numbers::kNotNegative,
             "Time of the picture (default: when the contact is deepest)");
  command.add_option("--video", flags.video,
                     "Write a film to this file; without ffmpeg, PNG files in FILE-frames");
  add_number(command, "--from-s", flags.from, Numbers::kNotNegative, "Start time of the film (default: 0)");
  add_number(command, "--to-s", flags.to, Numbers::kNotNegative,
             "End time of the film (default: the end of the recording)");
  add_number(command, "--fps", flags.fps, Numbers::kPositive, "Pictures per second of the film")
      ->default_str("30");
  add_number(command, "--slow", flags.slow, Numbers::kPositive,
             "Slow motion: how many times slower than the recording")
      ->default_str("1");
  command.add_option_function<std::string>(
      "--size", [&flags](const std::string& text) { flags.size = parse_size(text); },
      "WIDTHxHEIGHT in pixels (default: 1280x720; for the window: 1440x900)");
  command.add_flag("--close-up", flags.close_up, "Fill the picture with the contact instead of the organ");
  command.add_flag("--drape", flags.drape, "Spread a surgical drape under the organ");
  add_number(command, "--map-mm", flags.map_range, Numbers::kPositive,
             "Colour the organ by its displacement, up to this many mm, with a legend", kMillimetre);
  using Qualities = std::vector<std::pair<std::string, render::Quality>>;
  add_choice(command, "--quality", flags.quality,
             Qualities{{"full", render::Quality::kFull},
                       {"balanced", render::Quality::kBalanced},
                       {"fast", render::Quality::kFast}},
             "full, balanced or fast (default: full for a picture, balanced for a film)");
  command.add_option("--ui-scale", flags.ui_scale,
                     "Size of the window's text and panels, 0.5 to 4 (default: from the display)");
  command.add_flag("--no-cache", flags.no_cache, kNoCacheHelp);
  command.add_flag("--break-blind", flags.break_blind, kBreakBlindHelp);
  command.footer(
      "Without --screenshot and --video a window opens (F1 lists its keys).\n"
      "Examples:\n  palpate view run.h5\n  palpate view run.h5 --screenshot deepest.png --close-up\n"
      "  palpate view run.h5 --video press.mp4 --from-s 1 --to-s 3 --slow 2");
}

}  // namespace

void add_view(CLI::App& program, int& exit_code) {
  auto flags = std::make_shared<ViewFlags>();
  CLI::App* command =
      program.add_subcommand("view", "Show a recording in a window, or draw a picture or a film of it");
  add_flags(*command, *flags);
  command->callback([flags, &exit_code] { exit_code = view(*flags); });
}

}  // namespace palpate::app

// Display, force law and noise through the C interface, rejected calls, and the library's exported symbols.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "palpate/builtin.h"
#include "palpate/recording.h"
#include "palpate/scene.h"
#include "palpate/spring_law.h"
#include "palpate/surface.h"

#include "bindings/c/test/c_session.h"
#include "tests/program.h"

namespace palpate::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<double> vertices_of(const Session& session) {
  std::vector<double> xyz(3 * session.info.vertices);
  require(palpate_surface_vertices(session.get(), xyz.data(), session.info.vertices));
  return xyz;
}

/// Message of a call that fails with the expected status.
std::string refusal(palpate_status wanted, palpate_status given) {
  return given == wanted ? palpate_last_error() : "status " + std::to_string(given);
}

std::string open_refusal(const palpate_options& options, palpate_status wanted = PALPATE_ERROR_INPUT) {
  palpate_simulation* simulation = nullptr;
  const palpate_status status = palpate_open(&options, &simulation);
  palpate_close(simulation);
  return simulation == nullptr ? refusal(wanted, status) : "it was opened";
}

TEST(Surface, IsTheOrgansOwnMeshAtRest) {
  Session session(unheld());
  const geometry::TriangleMesh organ = geometry::make_organ("gallbladder");
  ASSERT_EQ(session.info.vertices, organ.vertices.size());
  ASSERT_EQ(session.info.triangles, organ.triangles.size());
  const std::vector<double> xyz = vertices_of(session);
  std::vector<std::int32_t> corners(3 * session.info.triangles);
  require(palpate_surface_triangles(session.get(), corners.data(), session.info.triangles));
  for (std::size_t i = 0; i < organ.vertices.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(xyz[3 * i + static_cast<std::size_t>(axis)], organ.vertices[i](axis));
    }
  }
  for (std::size_t i = 0; i < organ.triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      ASSERT_EQ(corners[3 * i + corner], organ.triangles[i][corner]);
    }
  }
}

// Independent computation: records the same run, replays it to one tick and calls the deform module directly.
TEST(Surface, IsThatOfTheDeformModuleBitForBit) {
  constexpr std::uint64_t kTick = 2600;
  const Folder folder;
  const std::string file = folder / "run.h5";
  Session session(recorded(unheld(), file));
  session.run(0, kTick + 1);
  palpate_picture picture = fresh<palpate_picture>();
  require(palpate_surface_update(session.get(), &picture));
  EXPECT_EQ(picture.tick, kTick);
  const std::vector<double> xyz = vertices_of(session);
  ASSERT_EQ(session.close(), PALPATE_OK);

  const record::Recording recording = record::read_recording(file);
  const haptics::Snapshot snapshot = record::snapshots_at(recording, {kTick}).front();
  deform::SurfaceDeformer deformer(recording.scene.organ);
  std::vector<Vec3> wanted;
  deformer.deform(recording.scene.tissue.reach, deform::indentations_of(snapshot.hand_results()), wanted);
  double most = 0.0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Vec3 got(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    ASSERT_EQ(got, wanted[i]) << i;
    most = std::max(most, (got - recording.scene.organ.vertices[i]).norm());
  }
  EXPECT_GT(most, 2e-3) << "it is pressed";
  EXPECT_EQ(picture.tool_position[0][2], snapshot.tools[0].pose_W.position.z());
}

// A display thread beside the loop, as in a game engine: every surface belongs to one tick, and ticks never
// go backwards.
// in time.
TEST(Surface, MayBeReadWhileAnotherThreadTicks) {
  Session session(unheld());
  std::atomic<bool> done{false};
  std::uint64_t pictures = 0;
  std::atomic<std::uint64_t> last{0};
  bool torn = false;
  std::thread picture_thread([&] {
    palpate_picture picture = fresh<palpate_picture>();
    while (!done.load()) {
      require(palpate_surface_update(session.get(), &picture));
      EXPECT_GE(picture.tick, last.load());
      last.store(picture.tick);
      const std::vector<double> xyz = vertices_of(session);
      for (const double coordinate : xyz) torn = torn || !(std::abs(coordinate) < 0.2);
      ++pictures;
    }
  });
  session.run(0, session.info.scripted_ticks);
  while (last.load() + 1 < session.info.scripted_ticks) std::this_thread::yield();
  done.store(true);
  picture_thread.join();
  EXPECT_GT(pictures, 0U);
  EXPECT_FALSE(torn) << "a vertex farther out than any organ's";
}

TEST(Surface, IsDividedUntilNoEdgeIsLongerThanAskedFor) {
  palpate_options options = unheld();
  options.scene_text = "[organ]\nmesh = \"box\"\n[tool]\nmesh = \"sphere:5\"\n";
  options.surface_edge = 1.5e-3;
  const Session session(options);
  const std::vector<double> xyz = vertices_of(session);
  std::vector<std::int32_t> corners(3 * session.info.triangles);
  require(palpate_surface_triangles(session.get(), corners.data(), session.info.triangles));
  const auto vertex = [&](std::int32_t i) {
    const auto first = 3 * static_cast<std::size_t>(i);
    return Vec3(xyz[first], xyz[first + 1], xyz[first + 2]);
  };
  for (std::size_t t = 0; t < session.info.triangles; ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      ASSERT_LE((vertex(corners[3 * t + e]) - vertex(corners[3 * t + (e + 1) % 3])).norm(), 1.5e-3);
    }
  }
}

TEST(Law, IsTheLibrarysBothWays) {
  for (const char* tissue : {"gallbladder", "heart", "liver", "kidney", "heart-muscle"}) {
    for (const char* direction : {"press", "pull"}) {
      palpate_law* law = nullptr;
      require(palpate_law_open(tissue, direction, 1000.0, &law));
      const model::SpringLaw wanted(
          model::tissue_preset(tissue),
          direction == std::string("pull") ? model::Direction::kPull : model::Direction::kPress, 1e-3);
      for (int i = 0; i < 80; ++i) {
        const double depth = i * 0.37e-3;
        palpate_response response = fresh<palpate_response>();
        require(palpate_law_force_at(law, depth, &response));
        EXPECT_EQ(response.force, wanted.force_at(depth).force);
        EXPECT_EQ(response.stiffness, wanted.force_at(depth).stiffness);
        EXPECT_EQ(response.saturated != 0, wanted.force_at(depth).saturated);
        const double force = response.force;
        require(palpate_law_depth_under(law, force, &response));
        EXPECT_EQ(response.depth, wanted.deformation_under(force).depth);
        EXPECT_EQ(response.cutoff_layer, wanted.deformation_under(force).cutoff_layer);
      }
      palpate_law_close(law);
    }
  }
}

TEST(Law, IsTheSmoothOneWhenTheTissueSaysSo) {
  const Folder folder;
  const std::string file = folder / "smooth.toml";
  std::ofstream(file)
      << "[tissue]\nlaw = \"smooth\"\nk1_N_per_m = 18.0\nbeta = 1.6\nq = 0.7\nrest_length_mm = 14.0\n"
         "max_length_mm = 22.0\nmin_length_mm = 6.0\nt1_us = 1.0\n";
  palpate_law* law = nullptr;
  require(palpate_law_open(file.c_str(), "press", 1000.0, &law));
  palpate_response response = fresh<palpate_response>();
  require(palpate_law_force_at(law, 9e-3, &response));
  palpate_law_close(law);
  const model::SmoothSpringLaw wanted(scene::load_tissue(file), model::Direction::kPress, 1e-3);
  EXPECT_EQ(response.force, wanted.force_at(9e-3).force);
}

TEST(Noise, IsTheProgramsLineByLine) {
  const Folder folder;
  const Outcome outcome = run(folder, {"noise", "--gain-N-m", "5e-5", "--threshold-mm", "5", "--distance-mm",
                                       "3", "--samples", "50", "--seed", "7"});
  ASSERT_EQ(outcome.exit_code, 0);
  std::istringstream lines(outcome.out);
  for (std::uint64_t tick = 0; tick < 50; ++tick) {
    double wanted = 0.0;
    ASSERT_TRUE(lines >> wanted);
    double force = 0.0;
    require(palpate_noise_sample(5e-5, 5e-3, 7, 0, tick, 3e-3, &force));
    EXPECT_EQ(force, wanted) << tick;
  }
}

TEST(BadScene, IsReportedInTheProgramsOwnWords) {
  const Folder folder;
  const std::string file = folder / "bad.toml";
  std::ofstream(file) << "[organ]\nmesh = \"gallbladder\"\n[tool]\nmash = \"sphere:3\"\n";
  const Outcome outcome = run(folder, {"run", "--offline", "bad.toml"});
  palpate_options options = unheld();
  options.scene_file = file.c_str();
  const std::string message = open_refusal(options);
  EXPECT_THAT(message, AllOf(HasSubstr("bad.toml:4: tool.mash"), HasSubstr("mesh")));
  EXPECT_THAT(outcome.err, HasSubstr(message.substr(message.find("bad.toml"))));
}

TEST(BadScene, AsATextIsReportedWithItsLine) {
  palpate_options options = unheld();
  options.scene_text = "[organ]\nmesh = \"gallblader\"\n[tool]\nmesh = \"sphere:3\"\n";
  EXPECT_THAT(open_refusal(options), HasSubstr("scene text:2: organ.mesh = \"gallblader\""));
  options.scene_text = "[organ\n";
  EXPECT_THAT(open_refusal(options), HasSubstr("scene text:1: not valid TOML"));
}

TEST(SceneText, FindsItsFilesInTheFolderGiven) {
  const Folder folder;
  std::ofstream(folder / "soft.toml")
      << "[tissue]\nk1_N_per_m = 18.0\nbeta = 1.6\nq = 0.7\nrest_length_mm = 14.0\n"
         "max_length_mm = 22.0\nmin_length_mm = 6.0\nt1_us = 1.0\n";
  palpate_options options = unheld();
  options.scene_text =
      "[scene]\nname = \"from a text\"\n[organ]\nmesh = \"box\"\ntissue = \"soft.toml\"\n"
      "[tool]\nmesh = \"sphere:5\"\n";
  EXPECT_THAT(open_refusal(options), HasSubstr("soft.toml"));
  const std::string path = folder.path().string();
  options.scene_folder = path.c_str();
  const Session session(options);
  EXPECT_STREQ(palpate_name(session.get()), "from a text");
}

TEST(Remarks, SayThatAHeldDevicesStabilityIsNotKnown) {
  const Session session;
  ASSERT_EQ(session.info.remarks, 1U);
  EXPECT_THAT(palpate_remark(session.get(), 0), HasSubstr("stability"));
  EXPECT_EQ(palpate_remark(session.get(), 1), nullptr);
}

TEST(Progress, IsReportedWhileTheOrganIsPrepared) {
  palpate_options options = unheld();
  double last = -1.0;
  options.progress = [](double share, const char* /*what*/, void* user) {
    *static_cast<double*>(user) = share;
  };
  options.progress_user = &last;
  const Session session(options);
  EXPECT_GT(last, 0.0);
  EXPECT_LE(last, 1.0);
}

TEST(Refused, OpeningWronglyIsSaid) {
  palpate_options options = unheld();
  palpate_simulation* simulation = nullptr;
  EXPECT_THAT(refusal(PALPATE_ERROR_USE, palpate_open(nullptr, &simulation)), HasSubstr("options"));
  EXPECT_THAT(refusal(PALPATE_ERROR_USE, palpate_open(&options, nullptr)), HasSubstr("simulation"));
  options.struct_size += 8;
  EXPECT_THAT(open_refusal(options, PALPATE_ERROR_USE), HasSubstr("palpate_options.struct_size = "));
  options = unheld();
  options.scene_file = "a.toml";
  options.scene_text = "";
  EXPECT_THAT(open_refusal(options, PALPATE_ERROR_USE), HasSubstr("at most one"));
  options = unheld();
  options.task = "poke";
  EXPECT_THAT(open_refusal(options), HasSubstr("poke"));
  for (const double edge : {-1.0, 1e-6, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    options = unheld();
    options.surface_edge = edge;
    EXPECT_THAT(open_refusal(options), HasSubstr("surface_edge"));
  }
}

TEST(Refused, TickingWronglyIsSaidAndMakesNoTick) {
  Session session(unheld());
  palpate_sample* samples = session.samples.data();
  palpate_result* results = session.results.data();
  const auto tick = [](palpate_simulation* simulation, const palpate_sample* from, palpate_result* to,
                       std::size_t hands) {
    return refusal(PALPATE_ERROR_USE, palpate_tick(simulation, from, to, hands));
  };
  EXPECT_THAT(tick(nullptr, samples, results, 1), HasSubstr("null"));
  EXPECT_THAT(tick(session.get(), nullptr, results, 1), HasSubstr("null"));
  EXPECT_THAT(tick(session.get(), samples, nullptr, 1), HasSubstr("null"));
  EXPECT_THAT(tick(session.get(), samples, results, 2), HasSubstr("hands"));
  samples[0].struct_size = 8;
  EXPECT_THAT(tick(session.get(), samples, results, 1), HasSubstr("struct_size"));
  samples[0].struct_size = sizeof(palpate_sample);
  results[0].struct_size = 8;
  EXPECT_THAT(tick(session.get(), samples, results, 1), HasSubstr("struct_size"));
  results[0].struct_size = sizeof(palpate_result);
  session.run(0, 1);
  EXPECT_EQ(session.results[0].tick, 0U);
}

TEST(Refused, TheOtherFunctionsSayWhatIsMissingOrTooSmall) {
  Session session(unheld());
  palpate_info info{};
  palpate_picture picture{};
  palpate_sample sample = fresh<palpate_sample>();
  double number = 0.0;
  std::int32_t corner = 0;
  const auto use = [](palpate_status status) { return refusal(PALPATE_ERROR_USE, status); };
  EXPECT_THAT(use(palpate_get_info(nullptr, &info)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_get_info(session.get(), nullptr)), HasSubstr("info"));
  EXPECT_THAT(use(palpate_get_info(session.get(), &info)), HasSubstr("palpate_info.struct_size = 0"));
  EXPECT_THAT(use(palpate_reset_fault(nullptr, 1)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_restart(nullptr)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_scripted_sample(nullptr, 0, 0, &sample)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_scripted_sample(session.get(), 0, 0, nullptr)), HasSubstr("sample"));
  EXPECT_THAT(use(palpate_scripted_sample(session.get(), 1, 0, &sample)), HasSubstr("hand"));
  sample.struct_size = 0;
  EXPECT_THAT(use(palpate_scripted_sample(session.get(), 0, 0, &sample)), HasSubstr("struct_size"));
  EXPECT_THAT(use(palpate_surface_update(nullptr, &picture)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_surface_update(session.get(), nullptr)), HasSubstr("picture"));
  EXPECT_THAT(use(palpate_surface_update(session.get(), &picture)), HasSubstr("struct_size"));
  EXPECT_THAT(use(palpate_surface_vertices(nullptr, &number, 1)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_surface_vertices(session.get(), nullptr, 1)), HasSubstr("xyz"));
  EXPECT_THAT(use(palpate_surface_vertices(session.get(), &number, 1)), HasSubstr("capacity = 1"));
  EXPECT_THAT(use(palpate_surface_triangles(nullptr, &corner, 1)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_surface_triangles(session.get(), nullptr, 1)), HasSubstr("corners"));
  EXPECT_THAT(use(palpate_surface_triangles(session.get(), &corner, 1)), HasSubstr("capacity = 1"));
  EXPECT_STREQ(palpate_name(nullptr), "");
  EXPECT_EQ(palpate_remark(nullptr, 0), nullptr);
  EXPECT_EQ(palpate_close(nullptr), PALPATE_OK);
}

TEST(Refused, LawAndNoiseSayWhichNumberIsWrong) {
  palpate_law* law = nullptr;
  const auto input = [](palpate_status status) { return refusal(PALPATE_ERROR_INPUT, status); };
  const auto use = [](palpate_status status) { return refusal(PALPATE_ERROR_USE, status); };
  EXPECT_THAT(input(palpate_law_open("hearth", "press", 1000.0, &law)), HasSubstr("hearth"));
  EXPECT_EQ(law, nullptr);
  EXPECT_THAT(input(palpate_law_open("heart", "push", 1000.0, &law)), HasSubstr("direction = \"push\""));
  for (const double rate : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(input(palpate_law_open("heart", "press", rate, &law)), HasSubstr("rate = "));
  }
  EXPECT_THAT(use(palpate_law_open(nullptr, "press", 1000.0, &law)), HasSubstr("tissue"));
  EXPECT_THAT(use(palpate_law_open("heart", nullptr, 1000.0, &law)), HasSubstr("direction"));
  EXPECT_THAT(use(palpate_law_open("heart", "press", 1000.0, nullptr)), HasSubstr("law"));

  require(palpate_law_open("heart", "press", 1000.0, &law));
  palpate_response response = fresh<palpate_response>();
  EXPECT_THAT(use(palpate_law_force_at(nullptr, 1.0, &response)), HasSubstr("null"));
  EXPECT_THAT(use(palpate_law_depth_under(law, 1.0, nullptr)), HasSubstr("null"));
  EXPECT_THAT(input(palpate_law_force_at(law, -1e-3, &response)), HasSubstr(">= 0"));
  EXPECT_THAT(input(palpate_law_depth_under(law, std::nan(""), &response)), HasSubstr("finite"));
  response.struct_size = 1;
  EXPECT_THAT(use(palpate_law_force_at(law, 1e-3, &response)), HasSubstr("struct_size"));
  palpate_law_close(law);

  double force = 0.0;
  EXPECT_THAT(input(palpate_noise_sample(-1.0, 5e-3, 1, 0, 0, 0.0, &force)), HasSubstr("gain"));
  EXPECT_THAT(input(palpate_noise_sample(5e-5, 0.0, 1, 0, 0, 0.0, &force)), HasSubstr("threshold"));
  EXPECT_THAT(input(palpate_noise_sample(5e-5, 5e-3, 1, 0, 0, -1.0, &force)), HasSubstr("distance"));
  EXPECT_THAT(use(palpate_noise_sample(5e-5, 5e-3, 1, 0, 0, 0.0, nullptr)), HasSubstr("force"));
}

TEST(Library, SaysItsVersions) {
  EXPECT_EQ(palpate_abi_version(), static_cast<std::uint32_t>(PALPATE_ABI_VERSION));
  EXPECT_STREQ(palpate_version(), PALPATE_TEST_VERSION);
  EXPECT_THAT(palpate_fault_words(99), HasSubstr("no fault of that number"));
}

/// Standard output of a shell command.
std::string output_of(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return "cannot be run";
  std::string text;
  char block[4096];
  while (const std::size_t got = std::fread(block, 1, sizeof block, pipe)) text.append(block, got);
  return pclose(pipe) == 0 ? text : "failed: " + text;
}

TEST(Library, ShowsItsOwnFunctionsAndNothingElse) {
  std::istringstream symbols(output_of("nm -D --defined-only --format=posix '" PALPATE_LIBRARY "'"));
  std::string line;
  int functions = 0;
  while (std::getline(symbols, line)) {
    std::istringstream words(line);
    std::string name;
    std::string kind;
    words >> name >> kind;
    if (name.starts_with("PALPATE_0") && kind == "A") continue;  // the version node of the symbols
    EXPECT_TRUE(name.starts_with("palpate_") && kind == "T") << line;
    ++functions;
  }
  EXPECT_EQ(functions, 34) << "those of palpate.h";
}

TEST(Library, HasTheInterfacesVersionAsItsName) {
  EXPECT_THAT(output_of("objdump -p '" PALPATE_LIBRARY "'"),
              HasSubstr("libpalpate.so." + std::to_string(PALPATE_ABI_VERSION) + "\n"));
}

// Its dependency TBB has threads that outlive a call, and would run code that is no longer there.
TEST(Library, StaysLoadedWhenItsHostClosesIt) {
  EXPECT_THAT(output_of("readelf -d '" PALPATE_LIBRARY "'"), HasSubstr("NODELETE"));
}

TEST(Fork, AChildNeitherUsesNorClosesASimulationOfItsParent) {
  const Folder folder;
  const std::string file = folder / "run.h5";
  Session session(recorded(unheld(), file));
  session.run(0, 100);
  const pid_t child = fork();
  if (child == 0) {
    const auto refused = [](palpate_status status) {
      return status == PALPATE_ERROR_USE &&
             std::string(palpate_last_error()).find("fork()") != std::string::npos;
    };
    const bool right =
        refused(palpate_tick(session.get(), session.samples.data(), session.results.data(), 1)) &&
        refused(palpate_get_info(session.get(), &session.info)) && refused(palpate_restart(session.get())) &&
        refused(palpate_reset_fault(session.get(), 1)) && session.close() == PALPATE_OK;
    _exit(right ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  session.run(100, 200);
  EXPECT_EQ(session.close(), PALPATE_OK);
  const record::Recording recording = record::read_recording(file);
  EXPECT_TRUE(recording.facts.complete);
  EXPECT_EQ(recording.rows.size(), 200U);
}

TEST(CtypesExample, FindsTheForceOfTheProgram) {
  const Folder folder;
  const std::string found = output_of("PALPATE_CACHE=off /usr/bin/python3 -I '" PALPATE_EXAMPLES
                                      "/ctypes_press.py' '" PALPATE_LIBRARY "' 2>&1");
  ASSERT_EQ(run(folder, {"run", "--offline", "--record", "run.h5"}).exit_code, 0);
  double deepest = 0.0;
  double largest = 0.0;
  for (const haptics::TickRow& row : record::read_recording(folder / "run.h5").rows) {
    deepest = std::max(deepest, row.depth);
    largest = std::max(largest, std::sqrt(row.force[0] * row.force[0] + row.force[1] * row.force[1] +
                                          row.force[2] * row.force[2]));
  }
  double said_depth = 0.0;
  double said_force = 0.0;
  const std::size_t at = found.find("deepest ");
  ASSERT_NE(at, std::string::npos) << found;
  ASSERT_EQ(std::sscanf(found.c_str() + at, "deepest %lf m, largest force %lf N", &said_depth, &said_force),
            2);
  EXPECT_EQ(said_depth, deepest);
  EXPECT_EQ(said_force, largest);
}

// The build compiles the example with -pedantic -Werror, so the header is C99. This test runs it.
TEST(CExample, PrintsTheSameFiguresAsTheOneInPython) {
  const std::string c = output_of("PALPATE_CACHE=off '" PALPATE_C_EXAMPLE "' 2>&1");
  const std::string python = output_of("PALPATE_CACHE=off /usr/bin/python3 -I '" PALPATE_EXAMPLES
                                       "/ctypes_press.py' '" PALPATE_LIBRARY "' 2>&1");
  const auto figures = [](const std::string& text) {
    double depth = 0.0;
    double force = 0.0;
    const std::size_t at = std::min(text.find("deepest "), text.size());
    (void)std::sscanf(text.c_str() + at, "deepest %lf m, largest force %lf N", &depth, &force);
    return std::pair(depth, force);
  };
  EXPECT_GT(figures(c).first, 0.0) << c;
  EXPECT_EQ(figures(c), figures(python));
}

}  // namespace
}  // namespace palpate::tests

// `palpate devices`, and a run with a simulated vendor library (src/run/devices/test/stand_in).
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/program.h"

namespace palpate::tests {
namespace {

using nlohmann::json;

const std::string kStandIn = std::string("forcedimension:") + PALPATE_DHD_STAND_IN;

TEST(DevicesCommand, HasALineForEveryKind) {
  const Folder folder;
  const Outcome text = run(folder, {"devices"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  const Outcome outcome = run(folder, {"devices", "--json"});
  const json devices = json::parse(outcome.out)["devices"];
  std::size_t reasons = 0;
  for (const json& device : devices) {
    EXPECT_LE(device["reasons"].size(), 3U);
    reasons += device["reasons"].size();
    for (const json& reason : device["reasons"]) {
      EXPECT_NE(text.out.find("- " + reason["what"].get<std::string>() + '\n'), std::string::npos) << reason;
      EXPECT_NE(text.out.find("  $ " + reason["command"].get<std::string>() + '\n'), std::string::npos)
          << reason;
    }
  }
  EXPECT_EQ(lines(text.out), devices.size() + 2 * reasons);
  bool seen = false;
  for (const json& device : devices) {
    EXPECT_TRUE(device["available"].is_boolean());
    EXPECT_NE(device["words"], "");
    seen = seen || device["kind"] == "forcedimension";
  }
  EXPECT_TRUE(seen);
}

TEST(DevicesCommand, HasReasonsForWhatIsNotThereAndNoneForWhatIs) {
  const Folder folder;
  for (const json& device : json::parse(run(folder, {"devices", "--json"}).out)["devices"]) {
    const std::string kind = device["kind"];
    if (kind == "scripted" || kind == "replay" || kind == "emulated" || kind == "host") {
      EXPECT_EQ(device["reasons"].size(), 0U) << kind;
    } else if (!device["available"]) {
      EXPECT_GT(device["reasons"].size(), 0U) << kind;
    }
  }
  const Outcome window = run(folder, {"devices", "--json"}, {{"DISPLAY", ":0"}});
  EXPECT_EQ(json::parse(window.out)["devices"][3]["kind"], "mouse");
  EXPECT_EQ(json::parse(window.out)["devices"][3]["available"], true);
}

TEST(DevicesCommand, OpensOneAndSaysWhatItReads) {
  const Folder folder;
  const Outcome outcome = run(folder, {"devices", "--try", kStandIn, "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json look = json::parse(outcome.out);
  EXPECT_EQ(look["name"], std::string("stand-in.7 (") + PALPATE_DHD_STAND_IN + ", 3.17.1.0)");
  EXPECT_EQ(look["new_samples"], 200);
  EXPECT_EQ(look["position_mm"], json({0.0, 0.0, 0.0}));
  EXPECT_EQ(look["orientation_wxyz"], json({1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(look["fault"], "none");
  EXPECT_NE(run(folder, {"devices", "--try", kStandIn}).out.find("no fault"), std::string::npos);
}

TEST(DevicesCommand, SaysInOneLineWhyOneCannotBeOpened) {
  const Folder folder;
  for (const char* what : {"scripted", "mouse", "forcedimension:none.so"}) {
    const Outcome outcome = run(folder, {"devices", "--try", what});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(DeviceLibrary, AFifoIsRefusedWithoutWaiting) {
  const Folder folder;
  ASSERT_EQ(mkfifo((folder / "libdhd.so").c_str(), 0600), 0);
  const Outcome outcome = run(folder, {"devices", "--try", "forcedimension:" + (folder / "libdhd.so")});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("libdhd.so: is no regular file, must be the vendor's"), std::string::npos)
      << outcome.err;
}

TEST(DeviceLibrary, IsNeverLoadedBecauseASceneNamesIt) {
  const Folder folder;
  std::filesystem::copy_file(PALPATE_DHD_STAND_IN, folder / "libevil.so");
  for (const std::string& path : {std::string("libevil.so"), folder / "libevil.so"}) {
    (void)folder.write("s.toml",
                       "[organ]\nmesh = \"gallbladder\"\n[tool]\nmesh = \"sphere:3\"\n"
                       "[device]\nkind = \"forcedimension\"\npath = \"" +
                           path + "\"\n");
    const Outcome outcome = run(folder, {"run", "s.toml", "--offline", "--headless", "--duration-s", "0.1"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_EQ(lines(outcome.err), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find("s.toml:7: device.path = \"" + path + "\": must be left out"),
              std::string::npos)
        << outcome.err;
  }
}

TEST(ForceDimensionRun, GoesThroughTheWholeProgram) {
  const Folder folder;
  const Outcome outcome = run(folder, {"run", "--device", kStandIn, "--duration-s", "0.5", "--record",
                                       "run.h5", "--offline", "--headless"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

TEST(TouchRun, GoesThroughTheWholeProgramWithTheLibraryThatTheLoaderFinds) {
  const Folder folder;
  const std::map<std::string, std::string> environment = {{"LD_LIBRARY_PATH", PALPATE_HD_STAND_IN_FOLDER}};
  const Outcome look = run(folder, {"devices", "--try", "touch", "--json"}, environment);
  ASSERT_EQ(look.exit_code, 0) << look.err;
  EXPECT_EQ(json::parse(look.out)["name"], "Stand-in Touch (serial number 1234, driver 4.0), at most 3.3 N");
  const Outcome outcome = run(
      folder,
      {"run", "--device", "touch", "--duration-s", "0.5", "--record", "run.h5", "--offline", "--headless"},
      environment);
  // A machine that halts for 5 ms makes the samples stale, which is a fault of the run.
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.err.find("no new sample for 5 ms") != std::string::npos)
      << outcome.err;
  EXPECT_EQ(run(folder, {"replay", "run.h5", "--verify"}).exit_code, 0);
}

TEST(TouchRun, WarmMotorsAreReportedOnceAndColdOnesNever) {
  const Folder folder;
  const auto reports = [&](const char* temperature) {
    const Outcome outcome =
        run(folder, {"run", "--device", "touch", "--duration-s", "0.5", "--offline", "--headless"},
            {{"LD_LIBRARY_PATH", PALPATE_HD_STAND_IN_FOLDER}, {"PALPATE_STAND_IN_MOTORS", temperature}});
    // The stand-in does not report its continuous force.
    const std::string words =
        "hand 0: the device's motors are warm: pause for some minutes; its force is not reduced";
    const std::size_t first = outcome.err.find(words);
    if (first == std::string::npos) return 0;
    return outcome.err.find(words, first + 1) == std::string::npos ? 1 : 2;
  };
  EXPECT_EQ(reports("0.8"), 1);
  EXPECT_EQ(reports("0.6"), 0);
}

}  // namespace
}  // namespace palpate::tests

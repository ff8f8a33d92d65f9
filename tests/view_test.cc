// `palpate view` as users call it.
#include <fstream>

#include <gtest/gtest.h>

#include "tests/program.h"

namespace palpate::tests {
namespace {

/// A recording of 1.6 s of the built-in press, in which the tool touches the organ.
class View : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome run = Program(folder_.path(), {"run", "--offline", "--no-noise", "--duration-s", "1.6",
                                                 "--record", "press.h5"})
                            .wait();
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  Outcome view(std::vector<std::string> words, const std::map<std::string, std::string>& environment = {}) {
    words.insert(words.begin(), {"view", "press.h5"});
    return Program(folder_.path(), std::move(words), environment).wait();
  }
  Folder folder_;
};

TEST_F(View, SaysWhatIsPossibleWhenNothingIsAsked) {
  const Outcome outcome = view({});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--screenshot"), std::string::npos);
  EXPECT_NE(outcome.err.find("--video"), std::string::npos);
}

TEST_F(View, RefusesWhatCannotBeDrawnBeforeItWritesAnything) {
  const std::vector<std::vector<std::string>> bad = {
      {"--screenshot", "a.png", "--size", "100"}, {"--screenshot", "a.png", "--size", "0x100"},
      {"--screenshot", "a.png", "--at-s", "99"},  {"--screenshot", "a.png", "--quality", "best"},
      {"--video", "a.mp4", "--size", "31x20"},    {"--video", "a.mp4", "--from-s", "1", "--to-s", "0.5"},
      {"--video", "a.mp4", "--from-s", "5"},      {"--video", "a.mp4", "--fps", "0"},
      {"--video", "a.mp4", "--slow", "-1"},
  };
  for (const std::vector<std::string>& words : bad) {
    const Outcome outcome = view(words);
    EXPECT_EQ(outcome.exit_code, 2) << words.back();
    EXPECT_NE(outcome.err.find(words.back()), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"press.h5"});
}

TEST_F(View, DrawsAMomentAndWithoutFfmpegAFilmAsPictures) {
  const Outcome picture =
      view({"--screenshot", "a.png", "--at-s", "1.5", "--size", "64x48", "--map-mm", "5"});
  EXPECT_EQ(picture.exit_code, 0) << picture.err;
  EXPECT_EQ(text_of(folder_ / "a.png").substr(1, 3), "PNG");
  const Outcome film =
      view({"--video", "b.mp4", "--from-s", "1.4", "--to-s", "1.5", "--fps", "20", "--size", "64x48"},
           {{"PATH", "/nonexistent"}});
  EXPECT_EQ(film.exit_code, 0) << film.err;
  EXPECT_NE(film.err.find("ffmpeg"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "b-frames/000003.png"));
  EXPECT_FALSE(fs::exists(folder_ / "b-frames/000004.png"));
}

}  // namespace
}  // namespace palpate::tests

// Keys and masking noise of a study, without a display.
#include "study/screens/study_keys.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/error.h"

#include "study/screens/study_sound.h"
#include "study/screens/test/study_contents.h"

namespace palpate::app {
namespace {

using study::ScreenInput;
using ::testing::AllOf;
using ::testing::HasSubstr;

SDL_Event key_event(SDL_Keycode key, SDL_Scancode position = SDL_SCANCODE_UNKNOWN) {
  SDL_Event event{};
  event.type = SDL_KEYDOWN;
  event.key.keysym.sym = key;
  event.key.keysym.scancode = position;
  return event;
}

SDL_Event pad_event(SDL_GameControllerButton button) {
  SDL_Event event{};
  event.type = SDL_CONTROLLERBUTTONDOWN;
  event.cbutton.button = static_cast<Uint8>(button);
  return event;
}

std::string rejection(const study::Study& study) {
  try {
    check_keys(study);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(StudyKeys, KeysPedalsAndGamepadButtonsMeanTheAnswersOfTheStudy) {
  study::Study study = contents::study();
  study.first_keys = {"1", "F", "pedal-left", "pad:x"};
  study.second_keys = {"2", "j", "pedal-right", "pad:b"};
  const StudyKeys keys(study);
  for (const SDL_Keycode key : {SDL_Keycode{SDLK_1}, SDL_Keycode{SDLK_KP_1}, SDL_Keycode{SDLK_f},
                                SDL_Keycode{SDLK_LEFT}, SDL_Keycode{SDLK_PAGEUP}, SDL_Keycode{SDLK_F13}}) {
    EXPECT_EQ(keys.input_of(key_event(key)), ScreenInput::kFirst) << SDL_GetKeyName(key);
  }
  for (const SDL_Keycode key :
       {SDL_Keycode{SDLK_2}, SDL_Keycode{SDLK_j}, SDL_Keycode{SDLK_RIGHT}, SDL_Keycode{SDLK_F14}}) {
    EXPECT_EQ(keys.input_of(key_event(key)), ScreenInput::kSecond) << SDL_GetKeyName(key);
  }
  EXPECT_EQ(keys.input_of(pad_event(SDL_CONTROLLER_BUTTON_X)), ScreenInput::kFirst);
  EXPECT_EQ(keys.input_of(pad_event(SDL_CONTROLLER_BUTTON_B)), ScreenInput::kSecond);
  EXPECT_EQ(keys.input_of(key_event(SDLK_SPACE)), ScreenInput::kNext);
  EXPECT_EQ(keys.input_of(key_event(SDLK_AMPERSAND, SDL_SCANCODE_1)), ScreenInput::kFirst)
      << "the key 1 of a French keyboard";
  EXPECT_EQ(keys.input_of(key_event(SDLK_g)), std::nullopt);
  SDL_Event again = key_event(SDLK_1);
  again.key.repeat = 1;
  EXPECT_EQ(keys.input_of(again), std::nullopt) << "a held key answers once";
  again.type = SDL_KEYUP;
  EXPECT_EQ(keys.input_of(again), std::nullopt);
}

TEST(StudyKeys, AnUnknownKeyIsRejectedWithTheValidNames) {
  study::Study study = contents::study();
  study.second_keys = {"2", "pedal-middle"};
  EXPECT_THAT(rejection(study),
              AllOf(HasSubstr("touch-noise.toml: response.second = \"pedal-middle\""), HasSubstr("a to z"),
                    HasSubstr("pedal-left"), HasSubstr("pad:leftshoulder")));
  study = contents::study();
  study.first_keys = {"pad:q"};
  EXPECT_THAT(rejection(study), HasSubstr("response.first = \"pad:q\""));
  study = contents::study();
  study.withdraw_key = "F25";
  EXPECT_THAT(rejection(study), HasSubstr("ethics.withdraw_key = \"F25\""));
  EXPECT_EQ(rejection(contents::study()), "");
}

TEST(StudyKeys, AKeyHasOneMeaning) {
  study::Study study = contents::study();
  study.second_keys = {"left"};
  EXPECT_THAT(rejection(study), HasSubstr("is also a key of `first`")) << "the left pedal sends it";
  study = contents::study();
  study.withdraw_key = "1";
  EXPECT_THAT(rejection(study), HasSubstr("is also an answer"));
  study = contents::study();
  study.first_keys = {"F10"};
  EXPECT_THAT(rejection(study), HasSubstr("F10 (force off)"));
  study = contents::study();
  study.withdraw_key = "pad:a";
  EXPECT_THAT(rejection(study), HasSubstr("must be a key of the keyboard"));
}

TEST(StudyKeys, WithdrawingNeedsTwoSeconds) {
  HeldKey key;
  EXPECT_EQ(key.part(5.0), 0.0);
  key.press(10.0);
  key.press(11.0);  // repeated by the keyboard
  EXPECT_DOUBLE_EQ(key.part(11.0), 0.5);
  EXPECT_FALSE(key.take_completed(11.99));
  key.release();
  EXPECT_EQ(key.part(12.0), 0.0);
  EXPECT_FALSE(key.take_completed(12.5)) << "it was released too early";
  key.press(20.0);
  EXPECT_TRUE(key.take_completed(22.0));
  EXPECT_FALSE(key.take_completed(23.0)) << "once for each press";
}

TEST(StudyKeys, AnswerKeysAreNamedInASentence) {
  EXPECT_EQ(text_of_keys({"1", "f", "pedal-left"}), "1, F or left pedal");
  EXPECT_EQ(text_of_keys({"pad:x"}), "gamepad X");
  EXPECT_EQ(text_of_keys({"f12"}), "F12");
}

std::vector<double> white_noise(std::size_t samples) {
  Random random(3, 0, 0);
  std::vector<double> noise(samples);
  for (double& sample : noise) sample = random.normal();
  return noise;
}

/// Power of the lines [from, to) of the discrete Fourier transform.
double band_power(const std::vector<double>& noise, std::size_t from, std::size_t to) {
  double power = 0.0;
  for (std::size_t line = from; line < to; ++line) {
    const double turn =
        2.0 * std::numbers::pi * static_cast<double>(line) / static_cast<double>(noise.size());
    const double factor = 2.0 * std::cos(turn);
    double last = 0.0;  // Goertzel's recurrence
    double before = 0.0;
    for (const double sample : noise) {
      const double now = sample + factor * last - before;
      before = last;
      last = now;
    }
    power += last * last + before * before - factor * last * before;
  }
  return power;
}

TEST(StudySound, PinkNoiseHasTheSamePowerInEachOctave) {
  const std::vector<double> white = white_noise(1U << 14U);
  const std::vector<double> pink = pink_from_white(white);
  // White noise has the expected power of 1 in each line; relative to it the random numbers cancel.
  const auto octave = [&](std::size_t from) {
    const double lines = static_cast<double>(from);
    return lines * band_power(pink, from, 2 * from) / band_power(white, from, 2 * from);
  };
  const double reference = octave(64);
  for (const std::size_t from : {32U, 128U, 256U, 512U, 1024U}) {
    EXPECT_NEAR(10.0 * std::log10(octave(from) / reference), 0.0, 0.5) << "dB, from line " << from;
  }
}

TEST(StudySound, PinkNoiseRepeatsWithoutASeam) {
  const std::vector<double> white = white_noise(50000);
  constexpr std::size_t kShift = 12345;
  std::vector<double> turned(white.size());
  for (std::size_t i = 0; i < white.size(); ++i) turned[i] = white[(i + kShift) % white.size()];
  const std::vector<double> one = pink_from_white(white);
  const std::vector<double> other = pink_from_white(turned);
  double largest = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    largest = std::max(largest, std::abs(other[i] - one[(i + kShift) % one.size()]));
  }
  EXPECT_LT(largest, 1e-9) << "no sample knows where the period begins";
}

TEST(StudySound, MaskingNoiseHasTheLevelOfTheStudy) {
  for (const bool pink : {true, false}) {
    double sum = 0.0;
    double squares = 0.0;
    const std::vector<float> noise = masking_noise(pink, -20.0, 48000);
    for (const float sample : noise) {
      sum += static_cast<double>(sample);
      squares += static_cast<double>(sample) * static_cast<double>(sample);
    }
    EXPECT_NEAR(sum / 48000.0, 0.0, 1e-6);
    EXPECT_NEAR(std::sqrt(squares / 48000.0), 0.1, 1e-4) << "20 dB below full scale";
  }
}

TEST(StudySound, WithoutASoundDeviceTheMessageNamesTheSettingThatNeedsNone) {
  study::Study study = contents::study();
  study.sound_mask = "pink";
  const char* before = std::getenv("SDL_AUDIODRIVER");
  const std::string kept = before == nullptr ? "" : before;
  setenv("SDL_AUDIODRIVER", "there-is-none", 1);
  try {
    const MaskingSound sound(study);
    FAIL() << "there is no such sound driver";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("touch-noise.toml: sound.mask = \"pink\""),
                                    HasSubstr("[sound] mask = \"none\"")));
  }
  setenv("SDL_AUDIODRIVER", "dummy", 1);
  EXPECT_TRUE(MaskingSound(study).plays());
  kept.empty() ? unsetenv("SDL_AUDIODRIVER") : setenv("SDL_AUDIODRIVER", kept.c_str(), 1);
}

}  // namespace
}  // namespace palpate::app

#include "study/screens/study_sound.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <SDL.h>
#include <fmt/core.h>

#include "core/base/random.h"
#include "palpate/error.h"

namespace palpate::app {
namespace {

constexpr int kRate = 48000;           // Hz
constexpr int kPeriod = 30;            // s, after which the noise repeats
constexpr double kRise = 1.0;          // s, from silence to the full level
constexpr std::uint64_t kSeed = 0x50;  // the same noise in all sessions

}  // namespace

std::vector<double> pink_from_white(const std::vector<double>& white) {
  struct Pole {
    double pole, gain;
    double state = 0.0;
  };
  Pole poles[] = {{0.99886, 0.0555179}, {0.99332, 0.0750759}, {0.96900, 0.1538520},
                  {0.86650, 0.3104856}, {0.55000, 0.5329522}, {-0.7616, -0.0168980}};
  constexpr double kDirect = 0.5362;
  constexpr double kDelayed = 0.115926;
  std::vector<double> pink(white.size());
  double before = 0.0;
  for (int pass = 0; pass < 2; ++pass) {  // the second pass starts with the state at the end of a period
    for (std::size_t i = 0; i < white.size(); ++i) {
      double sum = kDirect * white[i] + kDelayed * before;
      for (Pole& one : poles) {
        one.state = one.pole * one.state + one.gain * white[i];
        sum += one.state;
      }
      before = white[i];
      pink[i] = sum;
    }
  }
  return pink;
}

std::vector<float> masking_noise(bool pink, double level_dB, std::size_t samples) {
  Random random(kSeed, 0, 0);
  std::vector<double> noise(samples);
  for (double& sample : noise) sample = random.normal();
  if (pink) noise = pink_from_white(noise);
  const double count = static_cast<double>(std::max<std::size_t>(1, samples));
  const double mean = std::accumulate(noise.begin(), noise.end(), 0.0) / count;
  double squares = 0.0;
  for (double& sample : noise) {
    sample -= mean;
    squares += sample * sample;
  }
  const double scale = squares > 0.0 ? std::pow(10.0, level_dB / 20.0) / std::sqrt(squares / count) : 0.0;
  std::vector<float> clipped(samples);
  std::transform(noise.begin(), noise.end(), clipped.begin(), [scale](double sample) {
    return static_cast<float>(std::clamp(scale * sample, -1.0, 1.0));
  });
  return clipped;
}

MaskingSound::MaskingSound(const study::Study& study)
    : samples_(masking_noise(study.sound_mask == "pink", study.sound_level_dB,
                             static_cast<std::size_t>(kRate) * kPeriod)) {
  SDL_AudioSpec wanted{};
  wanted.freq = kRate;
  wanted.format = AUDIO_F32SYS;
  wanted.channels = 1;
  wanted.samples = 2048;
  wanted.callback = &MaskingSound::fill;
  wanted.userdata = this;
  const bool ready = SDL_InitSubSystem(SDL_INIT_AUDIO) == 0;
  if (ready) device_ = SDL_OpenAudioDevice(nullptr, 0, &wanted, nullptr, 0);
  if (device_ == 0) {
    const std::string why = SDL_GetError();
    if (ready) SDL_QuitSubSystem(SDL_INIT_AUDIO);
    throw InputError(fmt::format(
        "{}: sound.mask = \"{}\": no sound device can be opened ({}); connect one, or run without "
        "masking noise by [sound] mask = \"none\"",
        study.file.string(), study.sound_mask, why));
  }
  SDL_PauseAudioDevice(device_, 0);
}

MaskingSound::~MaskingSound() {
  SDL_CloseAudioDevice(device_);
  SDL_QuitSubSystem(SDL_INIT_AUDIO);
}

bool MaskingSound::plays() const { return SDL_GetAudioDeviceStatus(device_) == SDL_AUDIO_PLAYING; }

void MaskingSound::fill(void* self, std::uint8_t* bytes, int count) {
  MaskingSound& sound = *static_cast<MaskingSound*>(self);
  auto* out = reinterpret_cast<float*>(bytes);
  const std::size_t wanted = static_cast<std::size_t>(count) / sizeof(float);
  for (std::size_t i = 0; i < wanted; ++i) {
    out[i] = static_cast<float>(sound.gain_) * sound.samples_[sound.next_];
    sound.next_ = (sound.next_ + 1) % sound.samples_.size();
    sound.gain_ = std::min(1.0, sound.gain_ + 1.0 / (kRise * kRate));
  }
}

}  // namespace palpate::app

#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "study/session/study.h"

namespace palpate::app {

/// [setup] Pink noise (power falls by 3 dB an octave) from one period of white noise. The result has the
/// period of the input, so that it can be repeated without a seam. Sum of first-order filters within 0.05 dB
/// from 9 Hz on at 44.1 kHz [Kellet 1999].
[[nodiscard]] std::vector<double> pink_from_white(const std::vector<double>& white);

/// [setup] One period of masking noise with mean zero and this root mean square [dB of full scale], clipped
/// at full scale. @param pink else white
[[nodiscard]] std::vector<float> masking_noise(bool pink, double level_dB, std::size_t samples);

/// Masking noise through SDL's sound device, from construction to destruction. All members: [setup].
class MaskingSound final {
 public:
  /// @throws InputError when no sound device can be opened; it names the setting that needs none
  explicit MaskingSound(const study::Study& study);
  ~MaskingSound();
  MaskingSound(const MaskingSound&) = delete;
  MaskingSound& operator=(const MaskingSound&) = delete;

  /// Whether the device still plays; it stops when it is unplugged.
  [[nodiscard]] bool plays() const;

 private:
  static void fill(void* self, std::uint8_t* bytes, int count);

  std::vector<float> samples_;
  std::size_t next_ = 0;
  double gain_ = 0.0;         // rises from 0 to 1
  std::uint32_t device_ = 0;  // SDL_AudioDeviceID
};

}  // namespace palpate::app

#pragma once
#include <string_view>
#include <vector>

namespace palpate::psychophysics {

/// Stimuli and responses (C correct, I incorrect) of an example of [Watson 2017, Journal of Vision 17(3):10].
struct WatsonRun {
  std::vector<int> stimuli;  // dB, or degrees in the last run
  std::string_view responses;
};

inline const WatsonRun kThreshold = {
    {-18, -22, -25, -28, -30, -22, -13, -15, -16, -18, -19, -20, -21, -22, -23, -19,
     -20, -20, -18, -18, -19, -17, -17, -18, -18, -18, -19, -19, -19, -19, -19, -19},
    "CCCCIICCCCCCCCICCICCICCCCCCCCCCC"};

inline const WatsonRun kThresholdSlope = {
    {-18, -22, -12, -13, -15, -16, -17, -18, -19, -21, -24, -25, -26, -27, -21, -22,
     -23, -20, -20, -20, -21, -19, -19, -20, -20, -20, -19, -19, -19, -19, -19, -20,
     -20, -20, -20, -20, -21, -21, -20, -20, -20, -19, -18, -18, -19, -19, -19, -18,
     -18, -17, -18, -18, -18, -17, -17, -17, -17, -17, -17, -17, -18, -18, -18, -18},
    "CICCCCCCCCCCCICCICCCICCCCICCCCCCCCCCCICCIICCCCICICCCICCCCCCCCCCC"};

inline const WatsonRun kThresholdSlopeLapse = {
    {-18, -22, -25, -28, -30, -21, -12, -14, -15, -16, -18, -19, -20, -22, -23, -18, -19, -16, -17,
     -17, -18, -18, -18, -19, -19, -17, -17, -18, -18, -18, -18, -19, -19, -20, -18, -18, -18, -18,
     -18, -19, -19, -19, -19, -20, -18, -18, -18, -18, -18, -18, -18, -18, -18, -19, -19, -19, -20,
     -18, -18, -18, -18, -19, -19, -19, -18, -18, -18, -18, -19, -19, -19, -19, -19, -19, -19, -19,
     -20, -21, -19, -19, -19, -19, -19, -19, -19, -18, -19, -19, -16, -16, -16, -16, -16, -16, 0,
     0,   -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -21, -21, -19, -19,
     -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19, -19},
    "CCCCIICCCCCCCCICICCCCCCCICCCCCCCCICCCCCCCCCICCCICCCCCCCCICCCCCCICCCCCCCCCCCCCICICCCCICCICCCCCCCICCCCCCCC"
    "CCCCCCCICCCICIICCCCICCCC"};

inline const WatsonRun kMeanSdLapse = {
    {0,  -1, 2,  -2, 2,  3,  3,  -5, 3,  3,  3,  3,  -7, -7, -7, -7, 4,  -7, 4,  4,  4, -8, -8, -8, 4,  -8,
     4,  -8, -7, 4,  -7, -7, 4,  -7, 4,  -7, -6, 3,  -4, -5, 3,  3,  -7, 2,  2,  1,  0, -7, -6, -6, -6, 2,
     -5, 2,  -6, -5, 3,  -5, -5, 3,  4,  -5, -5, 4,  -4, -4, -4, -4, 4,  3,  3,  4,  5, 5,  -5, 5,  -5, -5,
     4,  5,  5,  -5, -4, -4, -4, -4, 5,  -4, -4, -3, 4,  4,  5,  5,  -4, 5,  -4, -4, 5, 4,  5,  5,  -5, 5,
     -4, -4, -4, -4, 5,  -4, 5,  4,  -4, 4,  -4, -4, -4, 4,  -4, -4, -4, 4,  4,  -4, 4, 4,  4,  -4},
    "CIICCCCCCCICIIIICCICCIIICICIICIICICIICICCCICCCIIIIICIIIICIIICIICIIICCCIICCICIIICCIIIIICIICCICCICICCICCIC"
    "IIIICCCCICIIICIIIICCCCCI"};

}  // namespace palpate::psychophysics

#pragma once
// Seeds that are texts: a scene, and messages of clients and devices.

namespace palpate::fuzz {

inline constexpr const char* kScene = R"([scene]
name = "a"
task = "pull"
rate_Hz = 1000
seed = 1
[organ]
mesh = "organ.stl"
unit = "mm"
tissue = "heart"
pose = { position_mm = [1, 2, 3], rotation_deg = [0, 90, 0] }
[[organ.motion]]
kind = "breathing"
amplitude_mm = 5.0
[[organ.inclusion]]
preset = "nodule"
[[organ.inclusion]]
name = "a"
under = [1, 2, 3]
depth_mm = 9
radius_mm = 4
stiffness_ratio = 10
visible = false
pulse_mm = 1
pulse_period_s = 0.8
[[organ.inclusion]]
position_mm = [1, 2, 3]
radius_mm = 4
stiffness_ratio = 0.1
[organ.stiffness]
map = "map.csv"
factor_at_black = 0.5
factor_at_white = 2
[search]
lumps = 2
preset = "stone"
radius_mm = 4
stiffness_ratio = 20
depth_mm = 8
tolerance_mm = 9
mark_button = 1
[[tool]]
mesh = "sphere:3"
tip_radius_mm = 3.0
mount = { position_mm = [0, 0, 0], rotation_deg = [0, 0, 0] }
[[tool.jaw]]
mesh = "jaw.stl"
pivot_mm = [0, 0, 0]
axis = [0, 1, 0]
open_deg = 15
[[device]]
kind = "scripted"
path = "press.csv"
workspace_scale = 1.0
base = { position_mm = [0, 0, 0], rotation_deg = [0, 0, 0] }
[noise]
enabled = true
threshold_mm = 5.0
user_threshold_N = 0.02
share_of_threshold = 0.6
[safety]
max_force_N = 20.0
max_slew_N_per_ms = 5.0
max_torque_N_m = 0.2
max_slew_N_m_per_ms = 0.05
)";

inline constexpr const char* kHaplyMessage =
    R"({"session_id":7,"inverse3":[{"device_id":"049D","config":{"preset":"a"},
"state":{"cursor_position":{"x":0.0,"y":-0.12,"z":1.5e-1},"cursor_velocity":{"x":0,"y":0,"z":0},
"control_mode":"idle"},"status":{"calibrated":true,"power_supply":true,"ready":true}}],
"verse_grip":[{"device_id":"61548","state":{"button":false,"orientation":{"w":1,"x":0,"y":0,"z":0}}}],
"wireless_verse_grip":[{"device_id":"77","state":{"buttons":{"a":true,"b":false,"c":false},
"orientation":{"w":0.5,"x":-0.5,"y":0.5,"z":-0.5}}}]}
)";

inline constexpr const char* kStudy = R"([study]
name = "a"
scene = "box"
seed = 1
sessions = 9
max_minutes = 60
[ethics]
consent_file = "a.md"
[participants]
id = "random"
ask = ["hand"]
[safety]
max_force_N = 6
max_noise_N = 0.1
max_continuous_noise_s = 3
[response]
first = ["1"]
second = ["2"]
[breaks]
every_trials = 30
every_minutes = 8
[[condition]]
name = "off"
share = 0
[[condition]]
name = "on"
share = 0.6
profile = "proximity"
d0_mm = 5
[[task]]
name = "threshold"
kind = "noise-threshold"
force_band_N = [0.5, 1.5]
method = "staircase"
sigma_mN = { from = 1, to = 100, per_decade = 20 }
catch_share = 0.1
sets_share_of = "threshold"
repeat_at_end = true
[[task]]
name = "curve"
kind = "force-detection"
signal = { from_task = "weak", correct = 0.65 }
shares = [0, 0.5, 2]
[[task]]
name = "weak"
kind = "force-detection"
force_mN = { from = 5, to = 500 }
[[task]]
name = "stiff"
kind = "stiffness"
ratio = { least = 1.02, largest = 3.3, steps = 14 }
conditions = ["off", "on"]
[[task]]
name = "lump"
kind = "inclusion"
ratio = { least = 1.1, largest = 8 }
depth_mm = 6
practice = 9
[[task]]
name = "hold"
kind = "force-control"
target_N = [1, 2]
repeats = 3
[[check]]
kind = "audible"
[analysis]
primary = { task = "stiff", contrast = "on - off", measure = "ln_jnd", alternative = "less" }
inverted_u = { task = "curve", rise = [[0.5], [0]], fall = [[2], [0.5]], alpha = 0.05 }
exclude = { catch_below = 0.7 }
)";

// The log of a study whose lock has the hash "lock".
inline constexpr const char* kTrialLog =
    R"({"n":1,"previous":"lock","type":"trial","time":"2026","session":1,"block":1,"task":"a","repeat":false,)"
    R"("practice":false,"catch":false,"number":0,"code":"c1","level":-2.5,"second":true,"answer":2,)"
    R"("counted":true,"response_time_s":0.7,"spoiled":["band"],"intervals":[{"from_tick":1,"to_tick":9,)"
    R"("peak_force_N":1,"mean_force_N":0.5,"depth_m":0.01,"work_J":1e-3},{"from_tick":10,"to_tick":19,)"
    R"("peak_force_N":1,"mean_force_N":0.5,"depth_m":0.01,"work_J":1e-3}],"rms_error_N":0,"variation":0,)"
    R"("observer":""})"
    "\n";

inline constexpr const char* kLiveMessages[] = {
    R"({"palpate":"1","do":"hello","token":"abc","id":1})",
    R"({"do":"stream","rate_Hz":50,"id":"a"})",
    R"({"do":"surface","at_rest":true})",
    R"({"do":"load","scene":"a.toml","task":"pull","organ":"heart","organ_unit":"mm","tissue":"liver",
"tool":"sphere:3","tool_unit":"cm","device":"emulated","rate_Hz":500,"seed":7,"no_noise":true})",
    R"({"do":"set_tissue","tissue":{"preset":"liver","name":"a","law":"smooth","k1_N_per_m":2.5e1,"beta":2,
"q":0.7,"rest_length_mm":14,"max_length_mm":22,"min_length_mm":6,"t1_us":1,"relaxation":[{"share":0.1,
"time_s":1}],"reach":{"bar_ratio":2},"contact":{"friction":0,"tangential_N_per_m":null}}})",
    R"({"do":"set_noise","noise":{"enabled":true,"threshold_mm":5,"user_threshold_N":0.02,
"share_of_threshold":0.6}})",
    R"({"do":"load","inclusions":["nodule","cyst"]})",
    R"({"do":"set_inclusion","inclusion":{"number":1,"position_mm":[1,-2.5,3e1],"stiffness_ratio":10}})",
    R"({"do":"set_inclusion","inclusion":{"name":"nodule","stiffness_ratio":0.5}})"};

}  // namespace palpate::fuzz

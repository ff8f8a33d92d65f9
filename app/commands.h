#pragma once
#include <string>

#include "app/cli.h"

namespace palpate::app {

// Exit codes (docs/file-formats.md).
inline constexpr int kDone = 0;
inline constexpr int kBadInput = 2;
inline constexpr int kFault = 3;
inline constexpr int kGoalMissed = 4;

// Each function adds one subcommand and is in its own source file. The subcommand's callback sets
// `exit_code`. `command_line` is the command as the user typed it; reports show it.
void add_model(CLI::App& program, int& exit_code);
void add_noise(CLI::App& program, int& exit_code);
void add_inspect(CLI::App& program, int& exit_code);
void add_run(CLI::App& program, const std::string& command_line, int& exit_code);
void add_demo(CLI::App& program, const std::string& command_line, int& exit_code);
void add_replay(CLI::App& program, int& exit_code);
void add_export(CLI::App& program, int& exit_code);
void add_repair(CLI::App& program, int& exit_code);
void add_view(CLI::App& program, int& exit_code);
void add_serve(CLI::App& program, int& exit_code);
void add_devices(CLI::App& program, int& exit_code);
void add_device_test(CLI::App& devices, int& exit_code);
void add_score(CLI::App& program, const std::string& command_line, int& exit_code);
void add_list(CLI::App& program, int& exit_code);
void add_doctor(CLI::App& program, int& exit_code);

}  // namespace palpate::app

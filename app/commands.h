#pragma once
#include <string>

#include <CLI/CLI.hpp>

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
void add_ros(CLI::App& program, int& exit_code);
void add_devices(CLI::App& program, int& exit_code);
void add_fit(CLI::App& program, const std::string& command_line, int& exit_code);
void add_score(CLI::App& program, const std::string& command_line, int& exit_code);
void add_study(CLI::App& program, const std::string& command_line, int& exit_code);
void add_sweep(CLI::App& program, int& exit_code);
void add_generate(CLI::App& program, int& exit_code);
void add_validate(CLI::App& program, const std::string& command_line, int& exit_code);
void add_doctor(CLI::App& program, int& exit_code);

/// [setup] Lists `bench` among the commands, without its flags. execute_bench() runs it.
void add_bench(CLI::App& program);

/// [setup] Replaces this process by the program palpate-bench. It looks in the folder of the running program,
/// then in bench/ of the build tree. @param arguments ends with a null pointer
/// @return kBadInput, after an error message, when palpate-bench cannot be executed
int execute_bench(char** arguments);

}  // namespace palpate::app

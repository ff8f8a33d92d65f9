#pragma once
#include <string>

#include <CLI/CLI.hpp>

namespace palpate::app {

// Exit codes (docs/file-formats.md).
inline constexpr int kDone = 0;
inline constexpr int kBadInput = 2;
inline constexpr int kFault = 3;
inline constexpr int kGoalMissed = 4;

// Each adds one subcommand whose callback sets `exit_code`; one file each. `command_line`, as the user typed
// it, is what a report says about how it was made.
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
void add_fit(CLI::App& program, const std::string& command_line, int& exit_code);
void add_sweep(CLI::App& program, int& exit_code);
void add_validate(CLI::App& program, const std::string& command_line, int& exit_code);
void add_doctor(CLI::App& program, int& exit_code);

/// [setup] Lists `bench` among the commands. execute_bench() runs it, and knows its flags.
void add_bench(CLI::App& program);

/// [setup] Replaces this process by the program palpate-bench: the one in the folder of the running program,
/// or in bench/ of its build tree. @param arguments null at the end. Returns kBadInput, after an error
/// message, when there is none.
int execute_bench(char** arguments);

}  // namespace palpate::app

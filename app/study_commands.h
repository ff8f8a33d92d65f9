#pragma once
#include <string>

#include <CLI/CLI.hpp>

namespace palpate::app {

// Each function adds one subcommand of `palpate study`.

}  // namespace palpate::app

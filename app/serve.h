#pragma once
#include "app/served_runs.h"

namespace palpate::app {

/// [setup] Serves runs to a browser on this computer and opens their page there, until Ctrl-C. A token keeps
/// other users out. The first run begins when the page is open; a run ends when its page is closed. @return
/// exit code @throws InputError
int serve_page(ServedOptions runs);

}  // namespace palpate::app

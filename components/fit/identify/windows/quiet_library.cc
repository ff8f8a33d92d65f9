#include "fit/identify/quiet_library.h"

namespace palpate::identify {

// tools/make_windows_libraries builds Ceres without messages.
QuietLibrary::QuietLibrary() = default;
QuietLibrary::~QuietLibrary() = default;

}  // namespace palpate::identify

#include "run/devices/vendor_library.h"

#include "io/system/shared_library.h"

namespace palpate::devices {

void* VendorFunctions::find(const char* name) const { return find_function(handle_, name); }

}  // namespace palpate::devices

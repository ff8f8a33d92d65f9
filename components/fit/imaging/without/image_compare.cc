#include "fit/imaging/image_compare.h"

#include "io/system/files.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::imaging {

ImageSet compare_photographs(const std::filesystem::path& before, const std::filesystem::path& /*after*/,
                             const ImageSettings& /*settings*/, const validate::Law& /*law*/,
                             double /*depth*/, double /*tip_radius*/) {
  throw InputError(to_text(before) +
                   (kIsWindows ? ": palpate for Windows measures no photographs, palpate on Linux does"
                               : ": this palpate was built without photographs, build it with "
                                 "-DPALPATE_IMAGING=ON"));
}

}  // namespace palpate::imaging

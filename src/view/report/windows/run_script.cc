#include "view/report/run_script.h"

#include "view/report/gnuplot.h"

namespace palpate::report {

int run_script(const std::filesystem::path& /*folder*/, const std::string& /*program*/) {
  throw FigureError("palpate for Windows draws no figures");
}

}  // namespace palpate::report

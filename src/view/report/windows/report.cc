// Reports and pictures, in a program without OpenGL: it refuses them before a run (app/windows/pictures.cc).
#include "view/report/report.h"

#include "palpate/error.h"
#include "view/report/palpation_report.h"
#include "view/report/subject.h"
#include "view/report/surface_error.h"

namespace palpate::report {
namespace {

[[noreturn]] void refuse_pictures() {
  throw InputError("palpate for Windows draws no pictures and writes no reports");
}

}  // namespace

ReferenceProfile read_measured_profile(const std::filesystem::path& /*file*/) { refuse_pictures(); }

std::filesystem::path write_report(const std::vector<Experiment>& /*experiments*/,
                                   const std::filesystem::path& /*folder*/,
                                   const std::function<void(double, const std::string&)>& /*progress*/,
                                   const ReportOptions& /*options*/) {
  refuse_pictures();
}

std::filesystem::path write_palpation_report(const scene::Scene& /*scene*/,
                                             const palpation::Scorer& /*scorer*/,
                                             const std::filesystem::path& /*folder*/,
                                             const std::string& /*command*/) {
  refuse_pictures();
}

std::filesystem::path write_insertion_report(const record::Recording& /*recording*/,
                                             const palpation::AnyScore& /*score*/,
                                             const std::filesystem::path& /*folder*/,
                                             const std::string& /*command*/) {
  refuse_pictures();
}

render::Image draw_held(const geometry::TriangleMesh& /*organ*/, const geometry::Support& /*support*/,
                        int /*height*/) {
  refuse_pictures();
}

render::Image draw_felt_stiffness(const scene::Scene& /*scene*/, const palpation::Scorer& /*scorer*/,
                                  int /*height*/) {
  refuse_pictures();
}

render::Image draw_error(const geometry::TriangleMesh& /*organ*/, const SurfaceError& /*error*/,
                         double /*range*/, int /*height*/) {
  refuse_pictures();
}

}  // namespace palpate::report

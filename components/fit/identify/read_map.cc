#include <algorithm>
#include <cmath>

#include "io/system/csv_table.h"
#include "palpate/units.h"

#include "fit/identify/map_fit.h"

namespace palpate::identify {

std::vector<MapRow> read_map(const std::filesystem::path& file) {
  enum Column : std::size_t { kProbe, kX, kY, kZ, kNx, kNy, kNz, kDepth, kForce };
  CsvTable table(file,
                 {{"probe"},
                  {"x_mm"},
                  {"y_mm"},
                  {"z_mm"},
                  {"nx", false},
                  {"ny", false},
                  {"nz", false},
                  {"depth_mm"},
                  {"force_N"}},
                 1e9);
  std::vector<MapRow> rows;
  while (table.next_row()) {
    const double probe = table.number(kProbe);
    if (probe != std::floor(probe) || !(std::abs(probe) < 1e9)) {
      table.fail(kProbe, "must be a whole number, the same in all rows of a probe");
    }
    rows.push_back({static_cast<int>(probe),
                    Vec3(table.number(kX), table.number(kY), table.number(kZ)) * kMillimetre,
                    Vec3(table.number(kNx), table.number(kNy), table.number(kNz)),
                    table.number(kDepth) * kMillimetre, table.number(kForce)});
    if (rows.back().depth < -1e-3) table.fail(kDepth, "must be the depth below the surface, not negative");
    rows.back().depth = std::max(0.0, rows.back().depth);
  }
  return rows;
}

}  // namespace palpate::identify

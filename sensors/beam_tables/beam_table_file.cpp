#include "sensors/beam_tables/beam_table_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <simvis/location.h>
#include "sensors/beam_tables/beam_csv.h"
#include "sensors/beam_tables/matrix_table.h"
#include "sensors/beam_tables/ouster_metadata.h"
#include "sensors/beam_tables/velodyne_calibration.h"

namespace simvis {
namespace {

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& letter : extension) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return extension;
}

}  // namespace

bool needs_columns(const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".yaml" || extension == ".yml";
}

BeamTable read_beam_table(const std::filesystem::path& file, const TableColumns& columns,
                          std::optional<double> beams_per_second) {
  const std::string extension = extension_of(file);
  BeamTable table;
  if (extension == ".csv") {
    table = read_beam_csv(file);
  } else if (extension == ".mat3x4f") {
    table = read_matrix_table(file);
  } else if (extension == ".json") {
    table = read_ouster_metadata(file);
  } else if (needs_columns(file)) {
    table = read_velodyne_calibration(file, columns);
  } else {
    fail_at({.file = file.string()}, "a beam table with the extension " + in_quotes(extension) +
                                         ", expected .csv, .mat3x4f, .json, .yaml or .yml");
  }
  if (beams_per_second) {
    table.time_ns.resize(table.size());
    // The table stands ring by ring; the beams of one column fire together unless there is only one ring.
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double fired = static_cast<double>(i % table.beams) * table.rings;
      table.time_ns[i] = std::llround(fired * 1e9 / *beams_per_second);
    }
  }
  return table;
}

}  // namespace simvis

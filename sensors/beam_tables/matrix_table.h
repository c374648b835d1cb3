// Beam tables in RGL's form: a file of matrices.
#pragma once

#include <filesystem>

#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// Each beam is a matrix of 3 x 4 float32, row by row, little-endian, that places it in the sensor frame: it starts at
/// the fourth column, in metres, and points along the third. The table has one ring, no times and no channels.
///
/// Errors   InputError with the number of the matrix: a size that is no multiple of 48 bytes, no beams or more than
///          kMaxTableBeams, a number that is not finite, a third column that is no unit vector, an origin that is too
///          far away.
BeamTable read_matrix_table(const std::filesystem::path& file);

}  // namespace simvis

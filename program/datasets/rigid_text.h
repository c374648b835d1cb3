// Poses as the texts of datasets have them.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "program/datasets/dataset_format.h"

namespace simvis {

/// The upper three rows of a rigid transform, row by row: twelve numbers with spaces between, as the shortest decimals
/// that read back to the same doubles.
std::string twelve_numbers(const glm::dmat4& a_from_b);

/// A rigid transform in a record: its twelve numbers, row by row.
Record rigid_record(const glm::dmat4& a_from_b);
glm::dmat4 rigid_of(const Record& twelve);

/// Whether two rigid transforms agree to 1 um, and the entries of their rotations to 1e-6. Poses far from the origin
/// are rounded to about 1e-9.
bool is_same_place(const glm::dmat4& a, const glm::dmat4& b);

/// A rotation as a unit quaternion x, y, z, w, with w at least 0.
glm::dvec4 quaternion_xyzw(const glm::dmat4& a_from_b);

}  // namespace simvis

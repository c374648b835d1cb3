// The pairs of links that an SRDF file, which MoveIt reads beside a URDF, keeps from colliding.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "import/model/model_description.h"

namespace simvis {

/// <disable_collisions> of two links, and <disable_default_collisions> of one with all others, except for the pairs
/// that <enable_collisions> names. What else the file has is for planners and is ignored. Names that are not among
/// `links` are left out with a warning, because one SRDF serves variants of a robot.
/// Throws InputError with the place: the file cannot be read or is malformed, its root is not <robot>, a link is not
/// named.
std::vector<ModelPair> read_srdf(const std::filesystem::path& file, const std::vector<std::string_view>& links,
                                 std::vector<std::string>& warnings);

}  // namespace simvis

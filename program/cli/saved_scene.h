// The scene file of a running simulation, with the values as they stand.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/parameters.h>
#include <simvis/simulation_desc.h>

namespace simvis {

struct SavedScene {
  std::string xml;
  /// Values that the file cannot say in one attribute: ELEMENT.PARAM, each with the reason.
  std::vector<std::string> left;
};

/// The text of a scene file whose elements have the values of `parameters`. Attributes are rewritten in place, those
/// that are missing follow the last one of their element, and all else stays as the user has written it. `added` are
/// commands that were executed after the file; they follow its last command.
///
/// Elements of included files, of part files and of repetitions, and attributes with an expression, are left as they
/// are: their text stands for more than one value.
/// Throws InputError if the text would not give the scene that runs.
SavedScene saved_scene(std::string_view xml, const std::filesystem::path& file, const Parameters& parameters,
                       std::span<const std::string> added, const SimulationDesc& desc);

}  // namespace simvis

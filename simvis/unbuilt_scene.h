// A scene that has been read and not built, from which simulations are built.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include "simvis/simulation_impl.h"

namespace simvis {

struct UnbuiltScene {
  /// Throws InputError for a file that cannot be read, is no scene, or has a mistake in the form of its commands.
  static UnbuiltScene of_file(const std::filesystem::path& file);
  /// The same for a text. Relative file names start at `folder`, and `name` stands for the file in messages.
  static UnbuiltScene of_text(std::string_view xml, const std::filesystem::path& folder, const std::string& name);

  /// Throws as Simulation::load(), for what the commands say and for the parts that they name.
  std::unique_ptr<SimulationImpl> build(const SimulationDesc& desc) const;

  std::vector<Command> commands;
  std::string name;   ///< of the file, as it was given, or of the text
  ReadInputs inputs;  ///< what has been read so far
};

}  // namespace simvis

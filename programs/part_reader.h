// The interface between the main() of an import program and its reader.
#pragma once

#include <filesystem>

#include "sandbox/import_answer.h"
#include "sandbox/imported_scene.h"

namespace simvis {

struct ReadRequest {
  std::filesystem::path file;
  bool ignore_up_axis = false;  ///< for COLLADA only
};

/// Each import program defines this function once. Messages of the library that reads the file go to `answer`.
/// Throws a std::exception with the reason if the file cannot be read.
ImportedScene read_part(const ReadRequest& request, AnswerWriter& answer);

}  // namespace simvis

// What a program that reads part files for SimVis is made of: its main() and one reader.
#pragma once

#include <filesystem>

#include "scenegraph/import/sandbox/import_answer.h"
#include "scenegraph/import/sandbox/imported_scene.h"

namespace simvis {

struct ReadRequest {
  std::filesystem::path file;
  bool ignore_up_axis = false;  ///< of COLLADA
};

/// Defined once in each program. Messages of the library that it reads with go to `answer`.
/// Throws std::exception: why the file cannot be read.
ImportedScene read_part(const ReadRequest& request, AnswerWriter& answer);

}  // namespace simvis

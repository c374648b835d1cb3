// The interface between the main() of an import program and its reader.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "import/programs/system_calls.h"
#include "import/sandbox/import_answer.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

struct ReadRequest {
  std::filesystem::path file;
  bool ignore_up_axis = false;  ///< for COLLADA only
};

/// Folders with what the library of this program needs to read a part, such as fonts.
extern const std::span<const std::string_view> kFoldersOfReader;

extern const HelperProgram kProgramOfReader;

/// Each import program defines this function and both constants once. Messages of the library that reads the file go
/// to `answer`. Throws a std::exception with the reason if the file cannot be read.
ImportedScene read_part(const ReadRequest& request, AnswerWriter& answer);

}  // namespace simvis

// A part format for tests: each line of a ".stub" file is a command that the part carries, "broken" is an error and
// "warn" a warning.
#pragma once

#include <sstream>

#include "scenegraph/part_importer.h"
#include "tests/temporary_folder.h"

namespace simvis {

inline int stub_imports = 0;            ///< how often a file was read
inline ImportRequest last_stub_import;  ///< what the importer was told

inline PartContent import_stub(const ImportRequest& request, ContentPool&) {
  ++stub_imports;
  last_stub_import = request;
  PartContent content;
  content.root = std::make_shared<Separator>();
  content.root->name = request.file.filename();
  std::istringstream lines(read_text(request.file));
  for (std::string line; std::getline(lines, line);) {
    if (line == "broken") throw InputError(request.file.string() + ": error: it is broken");
    if (line == "warn") {
      content.warnings.push_back(request.file.string() + ": a warning");
    } else if (!line.empty()) {
      content.commands.push_back(line);
    }
  }
  return content;
}

inline const PartImporterRegistration kStubRegistration({".stub"}, import_stub);

}  // namespace simvis

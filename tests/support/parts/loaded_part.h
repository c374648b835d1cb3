// Part files, imported by the importer of their extension and flattened.
#pragma once

#include <filesystem>

#include <simvis/part_importer.h>
#include "scenegraph/flattener.h"

namespace simvis::test {

PartContent import_part(const std::filesystem::path& file, ContentPool& pool);

/// The part in glTF's own frame, flattened.
struct LoadedPart {
  PartContent content;
  DrawList list;
};

DrawList flatten(const PartContent& content);

LoadedPart load_unturned(const std::filesystem::path& file, ContentPool& pool);

}  // namespace simvis::test

#include "tests/support/parts/loaded_part.h"

namespace simvis::test {

PartContent import_part(const std::filesystem::path& file, ContentPool& pool) {
  return find_part_importer(file)({file, false, UpAxis::z}, pool);
}

DrawList flatten(const PartContent& content) {
  const auto group = std::make_shared<Group>();
  group->add(content.root);
  Flattener flattener(group);
  return flattener.update();
}

LoadedPart load_unturned(const std::filesystem::path& file, ContentPool& pool) {
  LoadedPart part;
  part.content = find_part_importer(file)({file, true, UpAxis::z}, pool);
  part.list = flatten(part.content);
  return part;
}

}  // namespace simvis::test

#include "scenegraph/postponed_shapes.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

namespace simvis {

PartContent postponed_shapes(std::function<PartContent(ContentPool& pool)> read) {
  PartContent content;
  const auto root = std::make_shared<Group>();
  content.root = root;
  content.read_shapes = [root, read = std::move(read)](ContentPool& pool, std::vector<std::string>& warnings) {
    PartContent whole = read(pool);
    whole.root->name.clear();
    std::ranges::move(whole.warnings, std::back_inserter(warnings));
    return std::vector<ShapesOfGroup>{{root, {whole.root}}};
  };
  return content;
}

}  // namespace simvis

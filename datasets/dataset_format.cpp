#include "datasets/dataset_format.h"

#include <utility>

namespace simvis {

DatasetFile text_file(std::string path, std::string text) {
  const std::size_t bytes = text.size();
  return {std::move(path), [text = std::move(text)] { return text; }, bytes};
}

}  // namespace simvis

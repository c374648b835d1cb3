#include "import/model/small_xml.h"

#include <new>

#include <simvis/error.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"

namespace simvis {

bool load_if_there(const std::filesystem::path& file, pugi::xml_document& document) {
  if (!is_input_file(file)) return false;
  Bytes bytes;
  try {
    bytes = read_whole_file(file);
  } catch (const InputError&) {
    return false;
  }
  const pugi::xml_parse_result result = document.load_buffer(bytes.data(), bytes.size());
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  return static_cast<bool>(result);
}

}  // namespace simvis

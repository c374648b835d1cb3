#include "import/model/small_xml.h"

#include <cerrno>
#include <new>

#include "engine/base/read_error.h"

namespace simvis {

bool load_if_there(const std::filesystem::path& file, pugi::xml_document& document) {
  if (!is_input_file(file)) return false;
  errno = 0;
  const pugi::xml_parse_result result = document.load_file(file.c_str());
  const int error = errno;
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  if (result.status == pugi::status_io_error || result.status == pugi::status_file_not_found) {
    if (!is_fault_of_file(error)) throw_read_error(file, "cannot be read", error == 0 ? EIO : error);
  }
  return static_cast<bool>(result);
}

}  // namespace simvis

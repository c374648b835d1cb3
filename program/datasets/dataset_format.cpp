#include "program/datasets/dataset_format.h"

#include <stdexcept>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

std::string DatasetFormat::read_kept(const std::string& path, std::uint64_t bytes) const {
  SIMVIS_ASSERT(read_kept_);
  return read_kept_(path, bytes);
}

InputError foreign_record(const std::string& where) {
  return InputError(where + ": error: a record is not as simvis-run wrote it, expected another --out");
}

std::vector<DatasetFile> whole_files(const DatasetFormat& format, std::span<const Record> records,
                                     const std::string& where) {
  try {
    return format.whole(records);
  } catch (const Record::exception&) {
    throw foreign_record(where);
  } catch (const std::out_of_range&) {
    throw foreign_record(where);
  }
}

DatasetFile text_file(std::string path, std::string text) {
  const std::size_t bytes = text.size();
  return {std::move(path), [text = std::move(text)] { return text; }, bytes};
}

}  // namespace simvis

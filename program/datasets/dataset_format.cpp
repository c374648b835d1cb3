#include "program/datasets/dataset_format.h"

#include <stdexcept>
#include <utility>

#include <simvis/location.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

using MakeFormat = std::unique_ptr<DatasetFormat> (*)(double depth_unit_m);

/// It exists before the first registration of any file, and does not change once main() runs.
std::map<std::string_view, MakeFormat>& registered_formats() {
  static std::map<std::string_view, MakeFormat> all;
  return all;
}

}  // namespace

DatasetFormatRegistration::DatasetFormatRegistration(std::string_view name, MakeFormat make) {
  const bool is_new = registered_formats().try_emplace(name, make).second;
  SIMVIS_ASSERT(is_new);
}

std::string dataset_names(std::string_view separator) {
  std::string names;
  for (const auto& [name, make] : registered_formats()) {
    names += (names.empty() ? "" : std::string(separator)) + std::string(name);
  }
  return names;
}

std::unique_ptr<DatasetFormat> make_dataset_format(std::string_view name, double depth_unit_m) {
  const auto found = registered_formats().find(name);
  if (found != registered_formats().end()) return found->second(depth_unit_m);
  std::vector<std::string_view> known;
  for (const auto& [each, make] : registered_formats()) known.push_back(each);
  throw InputError("--dataset: there is no format " + in_quotes(name) + suggestion(name, known) +
                   " (expected one of: " + dataset_names(", ") + ")");
}

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

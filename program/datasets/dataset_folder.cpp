#include "program/datasets/dataset_folder.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/temporary_file.h"
#include "engine/base/thread_pool.h"
#include "program/datasets/contact_sheet.h"
#include "program/output/atomic_file.h"
#include "program/output/output_writer.h"

namespace simvis {
namespace {

constexpr const char* kOwnFolder = ".simvis";
const std::string kKept = "kept/";

std::string read_bytes(const std::filesystem::path& file) {
  std::error_code unknown;
  std::ifstream stream;
  // To open a FIFO would wait for its writer.
  if (std::filesystem::is_regular_file(file, unknown)) stream.open(file, std::ios::binary);
  if (!stream.is_open()) throw InputError(file.string() + ": error: cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

[[noreturn]] void refuse_record(const std::filesystem::path& file) {
  throw InputError(file.string() + ": error: is no file that simvis-run wrote, expected another --out");
}

Record parse(const std::filesystem::path& file) {
  constexpr int kMaxDepth = 32;  // deeper nesting would exhaust the stack
  try {
    return Record::parse(read_bytes(file), [&](int depth, Record::parse_event_t, const Record&) {
      if (depth > kMaxDepth) refuse_record(file);
      return true;
    });
  } catch (const Record::exception&) {
    refuse_record(file);
  }
}

/// The lines of randomized.csv in a record.
std::string drawn_lines_of(const Record& record, const std::filesystem::path& file) {
  try {
    return record.value("drawn", std::string());
  } catch (const Record::exception&) {
    throw foreign_record(file.string());
  }
}

std::string read_sheet(const std::filesystem::path& file) {
  std::string rows = read_bytes(file);
  if (!is_sheet(rows)) refuse_record(file);
  return rows;
}

std::string marker_of(const DatasetDesc& desc) {
  Record marker{{"format", desc.format}, {"frames", desc.frames}, {"depth_unit_m", desc.depth_unit_m}};
  for (const auto& [key, value] : desc.depends) marker[key] = value;
  return marker.dump(1) + "\n";
}

void write_into(const std::filesystem::path& file, std::string_view bytes) {
  make_folder(file.parent_path());
  write_file(file, bytes);
}

std::string record_name(std::uint64_t frame) { return "frames/" + frame_name(frame) + ".json"; }

}  // namespace

DatasetFolder::DatasetFolder(DatasetDesc desc, std::span<const DatasetSensor> sensors)
    : desc_(std::move(desc)),
      format_(make_dataset_format(desc_.format, desc_.depth_unit_m)),
      has_(desc_.frames),
      queue_(shared_thread_pool(desc_.threads)) {
  format_->begin(sensors);
  format_->read_kept_by([this](const std::string& path, std::uint64_t bytes) {
    const std::filesystem::path file = own(kKept + path);
    std::string kept = read_bytes(file);
    if (kept.size() != bytes) throw foreign_record(file.string());
    return kept;
  });
  make_folder(desc_.folder);
  lock_.emplace(desc_.folder, is_shard());
  claim(marker_of(desc_));
  remove_unheld_locks(desc_.folder / kOwnFolder);
  shard_lock_.emplace(own("dataset" + desc_.shard + ".json"));
  remove_leftovers_below();
  for (std::uint64_t frame = 0; frame < desc_.frames; ++frame)
    has_[frame] = std::filesystem::exists(own(record_name(frame)));
}

bool DatasetFolder::has_all() const {
  return std::ranges::all_of(has_, [](bool each) { return each; });
}

// Shards of one dataset come in any order: the first of them writes the marker.
void DatasetFolder::claim(const std::string& marker) const {
  const std::filesystem::path file = own("dataset.json");
  if (!std::filesystem::exists(file)) {
    for (const auto& entry : std::filesystem::directory_iterator(desc_.folder)) {
      if (entry.path().filename() == kOwnFolder) continue;
      throw InputError("--dataset: " + desc_.folder.string() + " holds other files, such as \"" +
                       entry.path().filename().string() + "\", expected an empty or a new folder as --out");
    }
    write_into(file, marker);
    return;
  }
  const Record there = parse(file), own_marker = Record::parse(marker);
  for (const auto& [key, value] : own_marker.items()) {
    if (there.contains(key) && there.at(key) == value) continue;
    throw InputError("--dataset: " + desc_.folder.string() + " holds another dataset: its \"" + key + "\" is " +
                     (there.contains(key) ? there.at(key).dump() : "missing") + ", and this one has " + value.dump() +
                     ", expected another --out");
  }
  if (desc_.resume || is_shard()) return;
  throw InputError("--dataset: " + desc_.folder.string() +
                   " holds this dataset already, expected --resume to go on with it, or another --out");
}

// Removes the temporary files of killed processes in all folders of the dataset.
void DatasetFolder::remove_leftovers_below() const {
  std::set<std::filesystem::path> folders{desc_.folder};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(desc_.folder)) {
    if (entry.is_directory()) folders.insert(entry.path());
  }
  for (const std::filesystem::path& folder : folders) remove_leftovers(folder, is_shard());
}

void DatasetFolder::put(DatasetFile file) {
  queue_.add(std::move(file.encode), file.held_bytes,
             [path = desc_.folder / file.path](std::string_view bytes) { write_into(path, bytes); });
}

// The record comes last in the queue, which writes in order.
void DatasetFolder::add(const DatasetFrame& frame, const std::string& drawn, const Warn& warn) {
  const std::uint64_t number = frame.time.index;
  if (has(number)) return;
  FramePiece piece = format_->frame(frame);
  for (const std::string& warning : piece.warnings) warn(warning);
  for (DatasetFile& file : piece.files) put(std::move(file));
  const std::string folder = std::string(kOwnFolder) + "/";
  for (DatasetFile& file : piece.kept) {
    file.path.insert(0, folder + kKept);
    put(std::move(file));
  }
  if (is_on_sheet(number, desc_.frames)) {
    put(text_file(folder + "sheet/" + frame_name(number) + ".rgb", sheet_rows(frame)));
  }
  piece.record["drawn"] = drawn;
  put(text_file(folder + record_name(number), piece.record.dump() + "\n"));
  has_[number] = true;
}

bool DatasetFolder::finish() {
  queue_.finish();
  for (std::uint64_t frame = 0; frame < desc_.frames; ++frame)
    has_[frame] = std::filesystem::exists(own(record_name(frame)));
  if (!has_all()) return false;
  write_whole();
  return true;
}

void DatasetFolder::write_whole() {
  std::vector<Record> records;
  std::string drawn, sheet;
  for (std::uint64_t frame = 0; frame < desc_.frames; ++frame) {
    records.push_back(parse(own(record_name(frame))));
    drawn += drawn_lines_of(records.back(), own(record_name(frame)));
    if (is_on_sheet(frame, desc_.frames)) sheet += read_sheet(own("sheet/" + frame_name(frame) + ".rgb"));
  }
  for (DatasetFile& file : whole_files(*format_, records, own("frames").string())) put(std::move(file));
  if (!drawn.empty()) put(text_file("randomized.csv", "frame,element,parameter,value\n" + drawn));
  if (!sheet.empty()) put({"contact_sheet.png", [sheet = std::move(sheet)] { return sheet_png(sheet); }});
  queue_.finish();
}

}  // namespace simvis

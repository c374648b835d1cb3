// The folder of a dataset: which frames it has, files that appear whole, and the files of the whole when no frame is
// missing.
//
//   FOLDER/.simvis/dataset.json          what the dataset is made of; the folder is this dataset's from then on
//   FOLDER/.simvis/frames/000000.json    the record of a frame: written after the frame's files
//   FOLDER/.simvis/kept/...              what formats keep of a frame for the files of the whole
//   FOLDER/.simvis/sheet/000000.rgb      its rows of the contact sheet
//   FOLDER/contact_sheet.png randomized.csv, and the files of the format
//
// Safety   A frame whose record is missing is made again. Every file appears under its name when it is complete. So a
//          process may be killed at any time, and several processes may make frames in one folder: the one that finds
//          all records writes the files of the whole, and two that do write the same bytes.
// Errors   MachineError as AtomicFile; InputError for a folder of something else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/result_lock.h"
#include "program/datasets/dataset_format.h"
#include "program/output/encoding_queue.h"

namespace simvis {

struct DatasetDesc {
  std::filesystem::path folder;
  std::string format;  ///< its name
  double depth_unit_m = 0.001;
  std::uint64_t frames = 1;  ///< of the whole dataset
  /// The settings that the dataset's bytes depend on, by name. All processes and runs that make one dataset have the
  /// same; others are refused.
  std::map<std::string, std::string> depends{};
  std::string shard{};   ///< Shard::suffix(): other shards may make frames at the same time; empty: the whole
  bool resume = false;   ///< goes on with the dataset in the folder, if there is one
  unsigned threads = 0;  ///< as SimulationDesc::threads
};

class DatasetFolder {
 public:
  /// Throws InputError for an unknown format, and for a folder that holds other files, another dataset, or without
  /// `resume` any dataset; MachineError if another process makes the same dataset or the same shard of it. `sensors` as
  /// DatasetFormat::begin().
  DatasetFolder(DatasetDesc desc, std::span<const DatasetSensor> sensors);

  bool has(std::uint64_t frame) const { return frame < has_.size() && has_[frame]; }
  bool has_all() const;

  using Warn = std::function<void(const std::string& warning)>;
  /// Adds a frame, if it is missing. `drawn` are its lines of randomized.csv. First `warn` gets FramePiece::warnings:
  /// if it throws, the frame is still missing, so that a later run meets the same warnings.
  void add(const DatasetFrame& frame, const std::string& drawn, const Warn& warn);
  /// Waits until all files are written. If no frame is missing, writes the files of the whole and returns true.
  bool finish();

 private:
  bool is_shard() const { return !desc_.shard.empty(); }
  std::filesystem::path own(const std::string& name) const { return desc_.folder / ".simvis" / name; }
  void claim(const std::string& marker) const;
  void remove_leftovers_below() const;
  void put(DatasetFile file);
  void write_whole();

  DatasetDesc desc_;
  std::unique_ptr<DatasetFormat> format_;
  std::optional<FolderLock> lock_;
  std::optional<ResultLock> shard_lock_;
  std::vector<bool> has_;
  EncodingQueue queue_;
};

}  // namespace simvis

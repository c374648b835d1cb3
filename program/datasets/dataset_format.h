// The interface of a format of datasets: which files one frame gives, and which files all frames together give. To add
// one, add a file with a class and one static DatasetFormatRegistration; no other file changes.
//
// Pieces   A frame gives files of its own and a record, a piece of JSON. When all frames have their records, the
//          files of the whole dataset follow from these, in the order of the frames. So frames may be made by several
//          processes and in several runs, and the files are the same.
// Input    Measurements, with what a scene says of its items and objects. A format has no other knowledge of a scene.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/error.h>
#include <simvis/frame_time.h>
#include <simvis/measurement.h>
#include <simvis/object_tree.h>
#include <simvis/scan.h>

namespace simvis {

/// A sensor, and what it measured; before the first frame the arrays have no numbers.
struct DatasetSensor {
  std::string name;
  glm::dmat4 world_from_sensor{1.0};  ///< rigid
  Measurement measurement{};
  std::map<std::uint32_t, std::string> points{};  ///< of a table of keypoints: names by the numbers in it
};

/// One frame. Valid during the call that gets it.
struct DatasetFrame {
  FrameTime time;
  std::span<const DatasetSensor> sensors;  ///< that measured in it, by their names
  std::span<const SceneItem> items;        ///< of the scene
  std::span<const SceneObject> objects;    ///< of the scene
  const DrawList& list;                    ///< its item i is items[i]
};

/// A file of a dataset.
struct DatasetFile {
  std::string path;                     ///< from the folder of the dataset
  std::function<std::string()> encode;  ///< its bytes; called once, in any thread
  std::size_t held_bytes = 0;           ///< of what `encode` holds
};

using Record = nlohmann::ordered_json;

/// The part of a dataset that one frame makes: its files, and the record from which files of the whole are written.
struct FramePiece {
  std::vector<DatasetFile> files{};
  Record record{};
  /// What readers of the format cannot use of the frame. The same cause has the same text in all frames.
  std::vector<std::string> warnings{};
  /// Bytes that are too many for the record. whole() reads them by read_kept(); they are no files of the dataset.
  std::vector<DatasetFile> kept{};
};

/// Threads  one at a time.
class DatasetFormat {
 public:
  DatasetFormat() = default;
  virtual ~DatasetFormat() = default;
  DatasetFormat(const DatasetFormat&) = delete;
  DatasetFormat& operator=(const DatasetFormat&) = delete;

  /// Called before the first frame with all sensors that are on, by their names. Throws InputError naming a sensor that
  /// the format cannot hold, or an output that it needs.
  virtual void begin(std::span<const DatasetSensor> sensors) = 0;
  /// The piece of one frame, which depends on nothing but this frame and begin(). Throws InputError for an object that
  /// the format cannot describe.
  virtual FramePiece frame(const DatasetFrame& frame) const = 0;
  /// The files of the whole, from the records of all frames in order. Throws InputError if they contradict each other.
  virtual std::vector<DatasetFile> whole(std::span<const Record> records) const = 0;

  /// Reads what a frame has kept, by FramePiece::kept's path and the number of its bytes. Throws InputError if there is
  /// no such file, and foreign_record() if it has another size.
  using ReadKept = std::function<std::string(const std::string& path, std::uint64_t bytes)>;
  /// Where the files of whole() find it: they may call `read` in any thread, as long as this object lives.
  void read_kept_by(ReadKept read) { read_kept_ = std::move(read); }

 protected:
  /// As ReadKept.
  std::string read_kept(const std::string& path, std::uint64_t bytes) const;

 private:
  ReadKept read_kept_;
};

/// A static object of this type adds a format.
struct DatasetFormatRegistration {
  /// `name` must live as long as the program, and be new (asserted). `make` gets the length of one code of depth, for
  /// formats that leave it open.
  DatasetFormatRegistration(std::string_view name, std::unique_ptr<DatasetFormat> (*make)(double depth_unit_m));
};

/// The names of all formats in alphabetical order: "bop", the separator, "coco", ...
std::string dataset_names(std::string_view separator);

/// The format of this name. Throws InputError for a name that does not exist.
std::unique_ptr<DatasetFormat> make_dataset_format(std::string_view name, double depth_unit_m);

/// Returns the error for a record that lacks fields SimVis writes: somebody has edited it. `where` is its file or
/// folder.
InputError foreign_record(const std::string& where);

/// DatasetFormat::whole() of records that were read from files, which may be anything that is JSON. There is at least
/// one. Throws foreign_record() too.
std::vector<DatasetFile> whole_files(const DatasetFormat& format, std::span<const Record> records,
                                     const std::string& where);

/// A file whose bytes are there already.
DatasetFile text_file(std::string path, std::string text);

}  // namespace simvis

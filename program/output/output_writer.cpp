#include "program/output/output_writer.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/thread_pool.h"
#include "program/output/apng_file.h"
#include "program/output/atomic_file.h"
#include "program/output/camera_info.h"
#include "program/output/csv_file.h"
#include "program/output/depth_png_file.h"
#include "program/output/exif.h"
#include "program/output/exr_file.h"
#include "program/output/npy_file.h"
#include "program/output/pose_files.h"
#include "scenegraph/pictures/png_file.h"
#include "sensors/measured_table.h"

namespace simvis {

namespace {

/// A part that is inserted twice gives its sensors names such as LEFT_ARM/CAM. These make nested folders, but they must
/// not lead out of the folder of the run.
void check_name(const std::string& sensor) {
  bool good = true;
  for (std::size_t start = 0; start <= sensor.size();) {
    const std::size_t end = std::min(sensor.find('/', start), sensor.size());
    good = good && end > start && sensor[start] != '.';
    start = end + 1;
  }
  if (good) return;
  throw InputError("sensor \"" + sensor +
                   "\" has a name that cannot name its files, expected names between \"/\" that are not empty " +
                   "and do not begin with \".\"");
}

std::size_t bytes_of(const Image& image) { return image.pixels.size() * sizeof(float); }

// The owner of a table of the scene: no sensor has a name with a dot.
std::string owner_of(const SceneTable& table) { return table.stem + std::string(".csv"); }

/// The ending of the files of a format: ".png".
std::string extension_of(const FormatSpec& format) { return std::string(format.file.substr(format.file.rfind('.'))); }

}  // namespace

std::string frame_name(std::uint64_t frame) {
  std::string digits = std::to_string(frame);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  return digits;
}

class OutputWriter::SensorFiles {
 public:
  SensorFiles(const std::string& sensor, Run& run) : sensor_(sensor), run_(run) {
    if (run_.desc.resume_at && std::filesystem::exists(pose_csv(pose_stem()))) {
      poses_.emplace(pose_stem(), *run_.desc.resume_at);
      frames_ = frames_of(pose_csv(pose_stem())).size();
    }
  }

  void begin(const FrameTime& time, const glm::dmat4& world_from_sensor) {
    time_ = time;
    world_from_sensor_ = world_from_sensor;
    ++frames_;
    frame_files_.clear();
    for (const std::filesystem::path& file : {pose_csv(pose_stem()), pose_tum(pose_stem())}) {
      run_.claim(file, sensor_, false);
    }
    run_.queue.add([] { return std::string(); }, 0,
                   [this, time, world_from_sensor](std::string_view) {
                     if (!poses_) {
                       for (const auto& file : {pose_csv(pose_stem()), pose_tum(pose_stem())}) run_.check_new(file);
                       run_.before_write();
                       make_folder(pose_stem().parent_path());
                       poses_.emplace(pose_stem());
                     }
                     poses_->append(time, world_from_sensor);
                   });
  }

  std::uint64_t frames() const { return frames_; }

  void finish() {
    if (table_) table_->finish();
    for (auto& [stem, film] : films_) film.finish();
    if (poses_) poses_->finish();
  }

  void write(const Measurement& measurement) {
    for (const MeasuredArray& each : measurement.arrays) {
      if (each.kind != OutputKind::image) continue;
      const auto of_view = [&](ImageContent content) {
        const auto found = std::ranges::find_if(measurement.arrays, [&](const MeasuredArray& other) {
          return other.content == content && other.view == each.view;
        });
        return found == measurement.arrays.end() ? std::nullopt : to_image(*found);
      };
      const ImageOrigin origin = origin_of(each, measurement);
      if (each.content == ImageContent::color) {
        write_color(each.view, *to_image(each), measurement.calibration(each.view));
        write_view(each.view, to_image(each), of_view(ImageContent::depth), origin);
      } else if (each.content != ImageContent::depth) {
        write_plane(each, origin);
      } else if (!of_view(ImageContent::color)) {
        write_view(each.view, std::nullopt, to_image(each), origin);
      }
    }
    if (measurement.calibrations != nullptr) {
      for (const Calibration& each : *measurement.calibrations) write_calibration(each);
    }
    MeasuredTable table = measured_table(measurement);
    if (!table.columns.empty()) write_rows(std::move(table), measurement.calibration(""));
  }

 private:
  ImageOrigin origin_of(const MeasuredArray& image, const Measurement& measurement) const {
    ImageOrigin origin{.time = time_, .world_from_sensor = world_from_sensor_};
    if (const CameraCalibration* const camera = measurement.calibration(image.view)) origin.pinhole = camera->pinhole;
    return origin;
  }

  // EXR of colour and depth of one view of a camera, and its depth.
  void write_view(const std::string& view, const std::optional<Image>& color, const std::optional<Image>& depth,
                  const ImageOrigin& origin) {
    write_exr(view, color, depth, origin);
    if (depth) write_depth(view.empty() ? "depth" : view + "_depth", *depth);
  }

  // `camera` may be null.
  void write_color(const std::string& view, const Image& color, const CameraCalibration* camera) {
    const std::optional<CameraCalibration> own = camera == nullptr ? std::nullopt : std::optional(*camera);
    for (const FormatSpec& format : format_table()) {
      if (format.kind != "color" || !run_.desc.formats.color.contains(std::string(format.name))) continue;
      if (format.name == "apng") write_film(view, color);
      if (format.encode_color == nullptr) continue;
      write_frame(view, extension_of(format), bytes_of(color), [color, own, encode = format.encode_color] {
        return own ? with_focal_length(encode(color), *own) : encode(color);
      });
    }
  }

  // One file has both.
  void write_exr(const std::string& view, std::optional<Image> color, std::optional<Image> depth,
                 const ImageOrigin& origin) {
    const OutputFormats& formats = run_.desc.formats;
    if (!formats.depth.contains("exr")) depth.reset();
    if (!formats.color.contains("exr") && !(depth && formats.color_beside_depth)) color.reset();
    if (!color && !depth) return;
    const std::size_t bytes = (color ? bytes_of(*color) : 0) + (depth ? bytes_of(*depth) : 0);
    write_frame(view, ".exr", bytes, [color = std::move(color), depth = std::move(depth), origin] {
      return encode_exr(color ? &*color : nullptr, depth ? &*depth : nullptr, origin);
    });
  }

  void write_depth(const std::string& stem, const Image& depth) {
    const OutputFormats& formats = run_.desc.formats;
    for (const FormatSpec& format : format_table()) {
      if (format.encode_depth == nullptr || !formats.depth.contains(std::string(format.name))) continue;
      write_frame(
          stem, extension_of(format), bytes_of(depth),
          [depth, encode = format.encode_depth, unit_m = formats.depth_unit_m] { return encode(depth, unit_m); });
    }
  }

  // Any other image. It is no depth: without EXR and npy among the formats of depth it is written as EXR, counts as
  // PNG.
  void write_plane(const MeasuredArray& plane, const ImageOrigin& origin) {
    const std::set<std::string>& formats = run_.desc.formats.depth;
    const std::size_t bytes = plane.bytes();
    const bool has_exr_type = fits_exr(plane), npy = formats.contains("npy") || !has_exr_type;
    if (npy) write_frame(plane.name, ".npy", bytes, [plane] { return encode_npy(plane); });
    if (!has_exr_type || (npy && !formats.contains("exr"))) return;
    if (plane.content == ImageContent::counts) {
      return write_frame(plane.name, ".png", bytes, [plane] { return encode_counts_png(plane); });
    }
    write_frame(plane.name, ".exr", bytes, [plane, origin] { return encode_exr(plane, origin); });
  }

  void write_calibration(const Calibration& calibration) {
    const std::filesystem::path path = run_.desc.folder / (name(calibration.view) + ".yaml");
    if (!run_.claim(path, sensor_, true)) return;
    run_.queue.add([text = camera_info_yaml(name(calibration.view), calibration.camera)] { return text; }, 0,
                   [this, path](std::string_view text) {
                     if (run_.desc.suffix.empty()) run_.check_new(path);  // other shards write the same text
                     run_.before_write();
                     make_folder(path.parent_path());
                     write_file(path, text);
                   });
  }

  void write_rows(MeasuredTable table, const CameraCalibration* camera) {
    auto frame = std::make_shared<TableFrame>();
    frame->time = time_;
    frame->world_from_sensor = world_from_sensor_;
    frame->columns = std::move(table.columns);
    frame->values = std::move(table.values);
    const std::set<std::string>& formats = run_.desc.formats.scan;
    if (camera != nullptr) frame->image_size_px = {camera->width_px, camera->height_px};
    bool written = false;
    for (const FormatSpec& format : format_table()) {
      if (format.encode_table == nullptr || !formats.contains(std::string(format.name))) continue;
      if (format.fits != nullptr && !format.fits(*frame)) continue;
      write_frame("", extension_of(format), frame->values.size() * sizeof(double),
                  [frame, encode = format.encode_table] { return encode(*frame); });
      written = true;
    }
    if (!written || formats.contains("csv")) write_csv(frame);
  }

  std::string name(const std::string& stem) const { return stem.empty() ? sensor_ : sensor_ + "_" + stem; }
  std::filesystem::path pose_stem() const { return run_.desc.folder / (sensor_ + "_poses" + run_.desc.suffix); }

  void write_film(const std::string& view, const Image& color) {
    const std::filesystem::path path = run_.desc.folder / (name(view) + ".apng");
    run_.claim(path, sensor_, true);
    run_.queue.add([color] { return encode_png(color); }, bytes_of(color),
                   [this, path, view, time_ns = time_.time_ns](std::string_view png) {
                     if (!films_.contains(view)) {
                       run_.check_new(path);
                       run_.before_write();
                       make_folder(path.parent_path());
                     }
                     films_.try_emplace(view, path).first->second.add(time_ns, png);
                   });
  }

  // A sensor whose rows have individual times gives them in a column named "time_s".
  void write_csv(const std::shared_ptr<const TableFrame>& frame) {
    const std::filesystem::path path = run_.desc.folder / (sensor_ + run_.desc.suffix + ".csv");
    run_.claim(path, sensor_, true);
    if (csv_columns_.empty()) {
      std::vector<TableColumn> all = {{"frame", "%lld", true}, {"time_s", "%.9f"}};
      std::ranges::copy_if(frame->columns, std::back_inserter(all),
                           [](const TableColumn& each) { return each.name != "time_s"; });
      csv_columns_ = csv_columns(all);
      csv_heading_ = csv_heading(all);
    }
    run_.queue.add([this, frame] { return lines(*frame); }, frame->values.size() * sizeof(double),
                   [this, path](std::string_view bytes) {
                     if (!table_) open_table(path);
                     table_->append(bytes);
                   });
  }

  void open_table(const std::filesystem::path& path) {
    run_.check_new(path);
    run_.before_write();
    make_folder(path.parent_path());
    if (run_.desc.resume_at && std::filesystem::exists(path)) {
      table_.emplace(path, table_start(path, *run_.desc.resume_at).bytes);
    } else {
      table_.emplace(path, csv_heading_);
    }
  }

  /// Runs on other threads, so it reads only the columns.
  std::string lines(const TableFrame& frame) const {
    const std::optional<std::size_t> own_time = frame.find("time_s");
    const std::size_t width = frame.columns.size();
    const double front[] = {static_cast<double>(frame.time.index), static_cast<double>(frame.time.time_ns) / 1e9};
    if (!own_time) return format_rows(csv_columns_, front, frame.values);
    std::string all;
    for (std::size_t row = 0; row < frame.values.size(); row += width) {
      std::vector<double> rest(&frame.values[row], &frame.values[row] + width);
      const double own_front[] = {front[0], rest[*own_time]};
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(*own_time));
      all += format_rows(csv_columns_, own_front, rest);
    }
    return all;
  }

  /// Writes one file of this frame.
  template <typename Encode>
  void write_frame(const std::string& stem, const std::string& extension, std::size_t held_bytes, Encode&& encode) {
    const std::filesystem::path folder = run_.desc.folder / name(stem);
    if (!frame_files_.insert(folder / ("*" + extension)).second) {
      throw InputError("--format: two formats write " + (folder / ("*" + extension)).string() + " of sensor " +
                       in_quotes(sensor_) + ", as color=rgb8 and scan=npy do; expected one of them");
    }
    run_.claim(folder / ("*" + extension), sensor_, true);
    make_folder(folder);
    run_.queue.add(EncodingQueue::Encode(std::forward<Encode>(encode)), held_bytes,
                   [this, path = folder / (frame_name(time_.index) + extension)](std::string_view bytes) {
                     run_.check_new(path);
                     run_.before_write();
                     write_file(path, bytes);
                   });
  }

  std::string sensor_;
  Run& run_;
  FrameTime time_;
  glm::dmat4 world_from_sensor_{1.0};
  std::uint64_t frames_ = 0;
  std::vector<CsvColumn> csv_columns_;
  std::string csv_heading_;
  std::map<std::string, ApngFile> films_;        // by view
  std::set<std::filesystem::path> frame_files_;  // of the present frame, as run.json names them
  std::optional<GrowingFile> table_;
  std::optional<PoseFiles> poses_;
};

/// Registers a file before it is written. Returns true if it is new.
bool OutputWriter::Run::claim(const std::filesystem::path& file, const std::string& name, bool is_result) {
  const auto [entry, fresh] = owner.try_emplace(file.string(), name);
  if (entry->second != name) {
    throw InputError("sensors \"" + entry->second + "\" and \"" + name + "\" would both write " + entry->first +
                     ", expected another name for one of them");
  }
  if (!fresh) return false;
  files[name].push_back(file.lexically_relative(desc.folder).string());
  if (is_result) results.push_back(entry->first);
  new_file = true;
  queue.hold();  // for the names that this frame still adds
  return true;
}

void OutputWriter::Run::before_write() {
  if (!new_file) return;
  if (desc.on_new_file) desc.on_new_file(files);
  new_file = false;  // behind the call, which may throw: no file is written that is not listed
}

void OutputWriter::Run::check_new(const std::filesystem::path& file) const {
  if (desc.resume_at || !std::filesystem::exists(file)) return;
  throw InputError(
      file.string() +
      ": error: the file exists and is not in the list of an earlier run of SimVis, so it is not replaced; "
      "expected another --out, or that it is removed");
}

OutputWriter::OutputWriter(OutputDesc desc)
    : run_{.desc = std::move(desc), .queue = EncodingQueue(shared_thread_pool(desc.threads))} {
  if (run_.desc.formats.color.contains("apng") && (run_.desc.resume_at || !run_.desc.suffix.empty())) {
    throw InputError("--format: color=apng is a film of all frames of a run, expected neither --resume nor --shard");
  }
  make_folder(run_.desc.folder);
  for (const std::vector<std::string>* names : {&run_.desc.sensors, &run_.desc.parts}) {
    for (const std::string& name : *names) {
      check_name(name);
      if (files_of_.contains(name))
        throw InputError("\"" + name + "\" would write its poses twice: a sensor and a part have this name");
      files_of_[name] = std::make_unique<SensorFiles>(name, run_);
    }
  }
}

OutputWriter::~OutputWriter() = default;

OutputWriter::SensorFiles& OutputWriter::find(std::string_view name) const {
  const auto found = files_of_.find(name);
  SIMVIS_ASSERT(found != files_of_.end());
  return *found->second;
}

void OutputWriter::write(std::string_view sensor, const FrameTime& time, const glm::dmat4& world_from_sensor,
                         const Measurement& measurement) {
  SensorFiles& files = find(sensor);
  files.begin(time, world_from_sensor);
  files.write(measurement);
}

void OutputWriter::part_pose(std::string_view part, const FrameTime& time, const glm::dmat4& world_from_part) {
  find(part).begin(time, world_from_part);
}

void OutputWriter::scene_table(const SceneTable& table, const FrameTime& time, std::vector<std::string> lines) {
  const std::filesystem::path file = run_.desc.folder / (table.stem + run_.desc.suffix + ".csv");
  run_.claim(file, owner_of(table), true);
  run_.queue.add([] { return std::string(); }, 0,
                 [this, &table, file, frame = time.index, lines = std::move(lines)](std::string_view) {
                   const auto opened = scene_tables_.find(table.stem);
                   (opened != scene_tables_.end() ? opened->second : open_table(table, file)).append(frame, lines);
                 });
}

SceneTableFile& OutputWriter::open_table(const SceneTable& table, const std::filesystem::path& file) {
  run_.check_new(file);
  run_.before_write();
  if (run_.desc.resume_at && std::filesystem::exists(file)) {
    return scene_tables_.try_emplace(table.stem, table, file, *run_.desc.resume_at).first->second;
  }
  return scene_tables_.try_emplace(table.stem, table, file).first->second;
}

void OutputWriter::drawn(std::string lines) {
  const std::string name = "randomized" + run_.desc.suffix + ".csv";
  const std::filesystem::path file = run_.desc.folder / name;
  run_.claim(file, "randomized.csv", true);
  run_.queue.add([lines = std::move(lines)] { return lines; }, 0,
                 [this, file](std::string_view bytes) { (drawn_ ? *drawn_ : open_drawn(file)).append(bytes); });
}

GrowingFile& OutputWriter::open_drawn(const std::filesystem::path& file) {
  run_.check_new(file);
  run_.before_write();
  if (run_.desc.resume_at && std::filesystem::exists(file)) {
    return drawn_.emplace(file, table_start(file, *run_.desc.resume_at).bytes);
  }
  return drawn_.emplace(file, "frame,element,parameter,value\n");
}

void OutputWriter::finish() {
  run_.queue.finish();
  for (const auto& [name, files] : files_of_) files->finish();
  for (auto& [stem, file] : scene_tables_) file.finish();
  if (drawn_) drawn_->finish();
}

std::uint64_t OutputWriter::frames(std::string_view sensor) const { return find(sensor).frames(); }

}  // namespace simvis

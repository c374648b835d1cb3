#include "simvis/output/output_writer.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/thread_pool.h"
#include "simvis/output/atomic_file.h"
#include "simvis/output/csv_file.h"
#include "simvis/output/exr_file.h"
#include "simvis/output/png_file.h"

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

std::string frame_name(std::uint64_t frame) {
  std::string digits = std::to_string(frame);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  return digits;
}

std::size_t bytes_of(const Image& image) { return image.pixels.size() * sizeof(float); }

}  // namespace

class OutputWriter::SensorSink : public OutputSink {
 public:
  SensorSink(const std::string& sensor, Run& run) : sensor_(sensor), run_(run) {}

  void begin(const FrameTime& time) { time_ = time; }

  void picture(const std::string& stem, const Image* color, const Image* depth) override {
    const auto copy = [](const Image* image) { return image ? std::make_shared<const Image>(*image) : nullptr; };
    const std::shared_ptr<const Image> own_color = copy(color), own_depth = copy(depth);
    const std::size_t color_bytes = own_color ? bytes_of(*own_color) : 0;
    const std::size_t depth_bytes = own_depth ? bytes_of(*own_depth) : 0;
    if (own_color) write_frame(stem, ".png", color_bytes, [own_color] { return encode_png(*own_color); });
    if (!own_color && !own_depth) return;
    write_frame(stem, ".exr", color_bytes + depth_bytes,
                [own_color, own_depth] { return encode_exr(own_color.get(), own_depth.get()); });
  }

  void plane(const std::string& stem, const std::string& channel, const Image& plane) override {
    write_frame(stem, ".exr", bytes_of(plane), [channel, plane] { return encode_exr_plane(channel, plane); });
  }

  void text(const std::string& stem, const std::string& extension, std::string_view text) override {
    const std::filesystem::path path = run_.folder / (name(stem) + "." + extension);
    if (!claim(path)) return;
    make_folder(path.parent_path());
    write_file(path, text);
  }

  // A sensor whose rows have individual times gives them in a column named "time_s".
  void rows(std::span<const TableColumn> columns, std::span<const double> values) override {
    const auto own_time = static_cast<std::size_t>(
        std::ranges::find(columns, std::string_view("time_s"), &TableColumn::name) - columns.begin());
    if (!table_) {
      std::vector<TableColumn> all = {{"frame", "%lld", true}, {"time_s", "%.9f"}};
      std::ranges::copy_if(columns, std::back_inserter(all), [](const auto& each) { return each.name != "time_s"; });
      const std::filesystem::path path = run_.folder / (sensor_ + run_.suffix + ".csv");
      claim(path);
      make_folder(path.parent_path());
      table_.emplace(path, all);
    }
    run_.queue.add(EncodingQueue::Encode([this, own_time, width = columns.size(), time = time_,
                                          copy = std::vector<double>(values.begin(), values.end())] {
                     return lines(time, copy, width, own_time);
                   }),
                   values.size_bytes(), [this](std::string_view bytes) { table_->add(bytes); });
  }

  void finish() {
    if (table_) table_->commit();
  }

 private:
  std::string name(const std::string& stem) const { return stem.empty() ? sensor_ : sensor_ + "_" + stem; }

  /// Runs on other threads, so it reads only the formats of the table.
  std::string lines(const FrameTime& time, const std::vector<double>& values, std::size_t width,
                    std::size_t own_time) const {
    const double front[] = {static_cast<double>(time.index), static_cast<double>(time.time_ns) / 1e9};
    if (own_time == width) return format_rows(table_->formats(), front, values);
    std::string all;
    for (std::size_t row = 0; row < values.size(); row += width) {
      std::vector<double> rest(&values[row], &values[row] + width);
      const double own_front[] = {front[0], rest[own_time]};
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(own_time));
      all += format_rows(table_->formats(), own_front, rest);
    }
    return all;
  }

  /// Writes one file of this frame.
  template <typename Encode>
  void write_frame(const std::string& stem, const std::string& extension, std::size_t held_bytes, Encode&& encode) {
    const std::filesystem::path folder = run_.folder / name(stem);
    claim(folder / ("*" + extension));
    make_folder(folder);
    run_.queue.add(
        EncodingQueue::Encode(std::forward<Encode>(encode)), held_bytes,
        [path = folder / (frame_name(time_.index) + extension)](std::string_view bytes) { write_file(path, bytes); });
  }

  /// Registers a result before it is written. Returns true if it is new.
  bool claim(const std::filesystem::path& result) {
    const auto [entry, fresh] = run_.results.sensor.try_emplace(result.string(), sensor_);
    if (entry->second != sensor_) {
      throw InputError("sensors \"" + entry->second + "\" and \"" + sensor_ + "\" would both write " + entry->first +
                       ", expected another name for one of them");
    }
    if (fresh) run_.results.names.push_back(entry->first);
    return fresh;
  }

  std::string sensor_;
  Run& run_;
  FrameTime time_;
  std::optional<CsvFile> table_;
};

OutputWriter::OutputWriter(std::filesystem::path folder, std::span<const std::string> sensors, std::string suffix,
                           unsigned threads)
    : run_{.folder = std::move(folder),
           .suffix = std::move(suffix),
           .queue = EncodingQueue(shared_thread_pool(threads))} {
  for (const std::string& sensor : sensors) {
    check_name(sensor);
    sinks_[sensor] = std::make_unique<SensorSink>(sensor, run_);
  }
  make_folder(run_.folder);
  AtomicFile probe(run_.folder / "run.json");  // reports an unwritable folder before the first frame
}

OutputWriter::~OutputWriter() = default;

OutputSink& OutputWriter::sink(std::string_view sensor, const FrameTime& time) {
  const auto found = sinks_.find(sensor);
  SIMVIS_ASSERT(found != sinks_.end());
  found->second->begin(time);
  return *found->second;
}

void OutputWriter::finish() {
  run_.queue.finish();
  for (const auto& [name, sink] : sinks_) sink->finish();
}

}  // namespace simvis

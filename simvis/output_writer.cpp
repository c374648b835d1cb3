#include "simvis/output_writer.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "engine/assert.h"
#include "engine/error.h"
#include "simvis/atomic_file.h"
#include "simvis/csv_file.h"
#include "simvis/exr_file.h"
#include "simvis/png_file.h"

namespace simvis {

namespace {

/// Parts that stand twice in a scene give their sensors names like LEFT_ARM/CAM: folders in folders, but never a way
/// out of the run's folder.
void check_name(const std::string& sensor) {
  bool good = true;
  for (std::size_t start = 0; start <= sensor.size();) {
    const std::size_t end = std::min(sensor.find('/', start), sensor.size());
    good = good && end > start && sensor[start] != '.';
    start = end + 1;
  }
  if (good) return;
  throw InputError("sensor \"" + sensor + "\" cannot name its files, expected names between \"/\" that are not empty " +
                   "and do not begin with \".\"");
}

std::string frame_name(std::uint64_t frame) {
  std::string digits = std::to_string(frame);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  return digits;
}

}  // namespace

class OutputWriter::SensorSink : public OutputSink {
 public:
  SensorSink(const std::filesystem::path& folder, const std::string& sensor, Results& results)
      : folder_(folder), sensor_(sensor), results_(results) {}

  void begin(const FrameTime& time) { time_ = time; }

  void picture(const std::string& stem, const Image* color, const Image* depth) override {
    if (color != nullptr) write_frame(stem, ".png", encode_png(*color));
    if (color != nullptr || depth != nullptr) write_frame(stem, ".exr", encode_exr(color, depth));
  }

  void plane(const std::string& stem, const std::string& channel, const Image& plane) override {
    write_frame(stem, ".exr", encode_exr_plane(channel, plane));
  }

  void text(const std::string& stem, const std::string& extension, std::string_view text) override {
    const std::filesystem::path path = folder_ / (name(stem) + "." + extension);
    if (!claim(path)) return;
    make_folder(path.parent_path());
    write_file(path, text);
  }

  // A sensor whose rows have times of their own gives them in a column of that name.
  void rows(std::span<const TableColumn> columns, std::span<const double> values) override {
    const auto own_time = static_cast<std::size_t>(
        std::ranges::find(columns, std::string_view("time_s"), &TableColumn::name) - columns.begin());
    if (!table_) {
      std::vector<TableColumn> all = {{"frame", "%lld", true}, {"time_s", "%.9f"}};
      std::ranges::copy_if(columns, std::back_inserter(all), [](const auto& each) { return each.name != "time_s"; });
      const std::filesystem::path path = folder_ / (sensor_ + ".csv");
      claim(path);
      make_folder(path.parent_path());
      table_.emplace(path, all);
    }
    const double front[] = {static_cast<double>(time_.index), static_cast<double>(time_.time_ns) / 1e9};
    if (own_time == columns.size()) return table_->add_rows(front, values);
    for (std::size_t row = 0; row < values.size(); row += columns.size()) {
      std::vector<double> rest(&values[row], &values[row] + columns.size());
      const double own_front[] = {front[0], rest[own_time]};
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(own_time));
      table_->add_rows(own_front, rest);
    }
  }

  void finish() {
    if (table_) table_->commit();
  }

 private:
  std::string name(const std::string& stem) const { return stem.empty() ? sensor_ : sensor_ + "_" + stem; }

  /// A file of this frame.
  void write_frame(const std::string& stem, const std::string& extension, std::string_view bytes) {
    const std::filesystem::path folder = folder_ / name(stem);
    claim(folder / ("*" + extension));
    make_folder(folder);
    write_file(folder / (frame_name(time_.index) + extension), bytes);
  }

  /// Notes a result before it is written; true when it is new.
  bool claim(const std::filesystem::path& result) {
    const auto [entry, fresh] = results_.sensor.try_emplace(result.string(), sensor_);
    if (entry->second != sensor_) {
      throw InputError("sensors \"" + entry->second + "\" and \"" + sensor_ + "\" would both write " + entry->first +
                       ": one of them needs another name");
    }
    if (fresh) results_.names.push_back(entry->first);
    return fresh;
  }

  std::filesystem::path folder_;
  std::string sensor_;
  Results& results_;
  FrameTime time_;
  std::optional<CsvFile> table_;
};

OutputWriter::OutputWriter(std::filesystem::path folder, std::span<const std::string> sensors)
    : folder_(std::move(folder)) {
  for (const std::string& sensor : sensors) {
    check_name(sensor);
    sinks_[sensor] = std::make_unique<SensorSink>(folder_, sensor, results_);
  }
  make_folder(folder_);
  AtomicFile probe(folder_ / "run.json");  // better now than after the first frame
}

OutputWriter::~OutputWriter() = default;

OutputSink& OutputWriter::sink(std::string_view sensor, const FrameTime& time) {
  const auto found = sinks_.find(sensor);
  SIMVIS_ASSERT(found != sinks_.end());
  found->second->begin(time);
  return *found->second;
}

void OutputWriter::finish() {
  for (const auto& [name, sink] : sinks_) sink->finish();
}

}  // namespace simvis

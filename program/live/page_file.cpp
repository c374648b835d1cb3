#include "program/live/page_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "program/live/glb_file.h"
#include "program/live/page_assets.h"
#include "program/live/view_encoder.h"
#include "scenegraph/pictures/deflate.h"

namespace simvis::live {
namespace {

// index.html has these lines; what is between the first two is for a page that a server gives.
constexpr std::string_view kBeginServed = "<!-- served -->", kEndServed = "<!-- /served -->", kData = "<!-- data -->";

std::string base64_of(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string compressed(std::string_view bytes) {
  return Deflater().zlib_of({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// Each module by its name, as an address that holds the module itself.
std::string import_map() {
  nlohmann::ordered_json imports;
  for (const PageAsset& asset : page_assets()) {
    if (!asset.name.ends_with(".js")) continue;
    const std::string name = asset.name == "three.module.js" ? "three" : "simvis/" + std::string(asset.name);
    imports[name] = "data:text/javascript;base64," + base64_of(asset.bytes);
  }
  return nlohmann::ordered_json{{"imports", std::move(imports)}}.dump();
}

/// The messages one after the other: u32 1 for binary, u32 length, bytes, zeros to a multiple of 8.
std::string joined(const std::vector<ViewMessage>& messages) {
  std::string all;
  for (const ViewMessage& message : messages) {
    append_binary(all, std::uint32_t{message.binary});
    append_binary(all, static_cast<std::uint32_t>(message.bytes.size()));
    all += message.bytes;
    all.resize((all.size() + 7) / 8 * 8);
  }
  return all;
}

std::vector<std::uint32_t> measured_in(const ViewFrame& frame) {
  std::vector<std::uint32_t> sensors;
  for (const ViewScan& scan : frame.scans) sensors.push_back(scan.sensor);
  for (const ViewImage& image : frame.images) sensors.push_back(image.sensor);
  for (const ViewTable& table : frame.tables) sensors.push_back(table.sensor);
  std::ranges::sort(sensors);
  sensors.erase(std::unique(sensors.begin(), sensors.end()), sensors.end());
  return sensors;
}

}  // namespace

PageFile::PageFile(std::filesystem::path file) : lock_(file), file_(std::move(file)) {
  const std::string_view page = page_asset("index.html");
  const std::size_t begin = page.find(kBeginServed), end = page.find(kEndServed), data = page.find(kData);
  SIMVIS_ASSERT(begin < end && end < data && data < page.size());
  file_.write(page.substr(0, begin));
  file_.write("<style>\n");
  file_.write(page_asset("style.css"));
  file_.write("</style>\n<script type=\"importmap\">");
  file_.write(import_map());
  file_.write("</script>\n<script type=\"text/plain\" id=\"licence-of-three\">");
  file_.write(page_asset("three_license.txt"));
  file_.write("</script>\n");
  file_.write(page.substr(end + kEndServed.size(), data - end - kEndServed.size()));
}

void PageFile::add_block(const std::string& id, std::string_view bytes) {
  file_.write("<script type=\"text/plain\" id=\"" + id + "\">" + base64_of(compressed(bytes)) + "</script>\n");
}

void PageFile::add(const ViewFrame& frame) {
  const bool is_key = entries_.empty() || frame.scene->structure != key_.scene->structure;
  const std::uint64_t number = entries_.size();
  const std::string glb = "glb-" + std::to_string(frame.scene->structure);
  if (is_key) {
    add_block(glb, glb_bytes(frame.scene->list, frame.scene->items));
    key_number_ = number;
  }
  const ViewTime time{.playing = false, .recorded = true};
  add_block("frame-" + std::to_string(number), joined(view_messages(is_key ? nullptr : &key_, frame, time, glb)));
  entries_.push_back({key_number_, frame.time_ns, measured_in(frame), frame.warnings.size()});
  series_.add(frame);
  if (!is_key) return;
  key_ = frame;
  key_.scans.clear();
  key_.images.clear();
}

void PageFile::finish() {
  add_block("series", series_.message());
  nlohmann::ordered_json recording = {{"frames", nlohmann::ordered_json::array()}};
  for (const Entry& entry : entries_) {
    recording["frames"].push_back({{"key", entry.key},
                                   {"time_s", static_cast<double>(entry.time_ns) / 1e9},
                                   {"sensors", entry.sensors},
                                   {"warnings", entry.warnings}});
  }
  file_.write("<script type=\"application/json\" id=\"recording\">" + recording.dump() + "</script>\n");
  const std::string_view page = page_asset("index.html");
  file_.write(page.substr(page.find(kData) + kData.size()));
  file_.commit();
}

}  // namespace simvis::live

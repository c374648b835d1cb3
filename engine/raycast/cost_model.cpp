#include <simvis/cost_model.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <locale>
#include <sstream>
#include <string>

#include <simvis/device.h>
#include <simvis/ray_caster.h>
#include "engine/base/cache_file.h"
#include "engine/base/decimal.h"
#include "engine/base/thread_pool.h"
#include "engine/vulkan/device_impl.h"

namespace simvis {

namespace {

// Version of the meaning of CostTerm. A new number makes SimVis ignore the costs that were measured before.
constexpr int kMeaning = 3;

constexpr std::string_view kNames[kCostTerms] = {"pass",      "view",   "item_drawn", "examined",     "draw",
                                                 "triangle",  "masked", "pixel",      "beam",         "cast",
                                                 "item_cast", "ray",    "item_test",  "triangle_test"};
constexpr double kMin_ns = 1e-3, kMax_ns = 1e9;

double rounded(double cost_ns) {
  const std::string text = decimal(std::clamp(cost_ns, kMin_ns, kMax_ns), 1, std::chars_format::scientific);
  double read = 0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  return read;
}

// The text of the whole file. A reader accepts a file only if its numbers, written again, give the same text.
std::string text_of(std::string_view key, const CostModel& cost) {
  std::string text = std::string(key) + "\n";
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    text += std::string(kNames[i]) + " " + decimal(cost.of[i], 1, std::chars_format::scientific) + " ns\n";
  }
  char checksum[32];
  std::snprintf(checksum, sizeof checksum, "checksum %016llx\n", static_cast<unsigned long long>(cache_checksum(text)));
  return text + checksum;
}

}  // namespace

std::string_view to_string(CostTerm term) { return kNames[static_cast<std::size_t>(term)]; }

double predict(const CostModel& counts, const CostModel& cost) {
  double sum_ns = 0;
  for (std::size_t i = 0; i < kCostTerms; ++i) sum_ns += counts.of[i] * cost.of[i];
  return sum_ns;
}

std::filesystem::path cost_model_file(Device& device, const std::filesystem::path& folder, std::string_view version) {
  if (folder.empty()) return {};
  const VkPhysicalDeviceProperties& properties = device.impl().physical.properties;
  std::string name = "costs-" + std::to_string(kMeaning) + "-";
  char hex[32];
  for (const std::uint8_t byte : properties.pipelineCacheUUID) {
    std::snprintf(hex, sizeof hex, "%02x", byte);
    name += hex;
  }
  std::snprintf(hex, sizeof hex, "-%04x-%04x-%08x-", properties.vendorID, properties.deviceID,
                properties.driverVersion);
  name += hex + std::to_string(device.impl().threads->size()) + "-" + std::string(version);
  return folder / (name + ".txt");
}

std::optional<CostModel> load_cost_model(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::string key, name, unit;
  std::getline(words, key);
  CostModel cost;
  for (double& each : cost.of) {
    if (!(words >> name >> each >> unit) || !(each >= kMin_ns && each <= kMax_ns)) return {};
  }
  if (key != file.stem().string() || text != text_of(key, cost)) return {};
  return cost;
}

CostModel save_cost_model(const std::filesystem::path& file, const CostModel& cost) {
  CostModel written;
  std::ranges::transform(cost.of, written.of.begin(), rounded);
  if (!file.empty()) write_cache_file(file, text_of(file.stem().string(), written));
  return written;
}

}  // namespace simvis

#include "bench/accuracy/variants.h"

#include <sstream>

namespace simvis::bench {

namespace {

constexpr const char* kTolerances[] = {"1e-3", "1e-4", "1e-5", "1e-6"};

// Limits along the ray that no beam of these scenes reaches: only the hit surfaces and their ranges count.
constexpr const char* kLimits = "range_min=\"0\" range_max=\"10000\"";

}  // namespace

std::vector<AccuracyScanner> accuracy_scanners() {
  return {{.name = "planar",
           .attributes = "samples=\"361\" min_angle=\"-90\" max_angle=\"90\"",
           .resolutions_px = {256, 512, 1024, 2048, 4096, 8192}},
          {.name = "lidar",
           .attributes = "samples=\"1024\" min_angle=\"-180\" max_angle=\"180\" vertical_samples=\"64\" "
                         "vertical_min_angle=\"-15\" vertical_max_angle=\"15\"",
           .resolutions_px = {256, 512, 1024, 2048},
           .lidar = true}};
}

std::vector<Variant> variants_of(const AccuracyScanner& scanner) {
  std::vector<Variant> variants;
  const auto add = [&](const char* method, const char* max_error_rel, int resolution_px) {
    const std::string sensor = scanner.name + "_" + std::to_string(variants.size());
    variants.push_back({sensor, method, max_error_rel, resolution_px});
  };
  for (const int resolution_px : scanner.resolutions_px) add("nearest", "", resolution_px);
  for (const int resolution_px : scanner.resolutions_px) add("planar", "", resolution_px);
  for (const char* tolerance : kTolerances) {
    for (const int resolution_px : scanner.resolutions_px) add("hybrid", tolerance, resolution_px);
  }
  add("raycast", "", 0);
  return variants;
}

std::string mount_xml(const AccuracyScanner& scanner, const std::vector<Variant>& variants) {
  std::ostringstream xml;
  xml << "<element type=\"pose\" name=\"" << kMount << "\" insert_at=\"ROOT\"/>\n";
  for (const Variant& variant : variants) {
    xml << "<sensor type=\"laser_scanner\" name=\"" << variant.sensor << "\" insert_at=\"ROOT\" " << scanner.attributes
        << ' ' << kLimits << " method=\"" << variant.method << '"';
    if (!variant.max_error_rel.empty()) xml << " max_error_rel=\"" << variant.max_error_rel << '"';
    if (variant.resolution_px > 0) xml << " resolution=\"" << variant.resolution_px << '"';
    xml << "/>\n";
  }
  return xml.str();
}

}  // namespace simvis::bench

#include "program/report/run_inputs.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <thread>

#include <simvis/sensor.h>
#include "engine/base/recorded_variables.h"
#include "engine/base/sha256.h"

namespace simvis {

namespace {

std::string name_from_here(const std::filesystem::path& file) {
  if (!file.is_absolute()) return file.lexically_normal().string();
  const std::filesystem::path relative = file.lexically_relative(std::filesystem::current_path());
  return relative.empty() || *relative.begin() == ".." ? file.string() : relative.string();
}

}  // namespace

FileHashes hashes_of(std::span<const std::filesystem::path> files) {
  FileHashes hashes;
  for (const std::filesystem::path& file : files) hashes[name_from_here(file)] = sha256_of(file);
  return hashes;
}

std::vector<std::string> set_environment(const RecordedVariables& environment) {
  const std::span<const char* const> harmless = recorded_variables();
  std::vector<std::string> ignored;
  for (const auto& [name, value] : environment) {
    if (std::ranges::find(harmless, std::string_view(name)) == harmless.end()) {
      ignored.push_back(name);
    } else if (value) {
      ::setenv(name.c_str(), value->c_str(), 1);
    } else {
      ::unsetenv(name.c_str());
    }
  }
  return ignored;
}

NamedTexts given_attributes(const Command& sensor) {
  NamedTexts given;
  for (const CommandAttribute& each : sensor.attributes) given.emplace_back(each.name, each.value);
  return given;
}

NamedTexts default_attributes(const Command& sensor) {
  NamedTexts defaults;
  const SensorType* const type = find_sensor_type(sensor.require("type").value);
  if (type == nullptr) return defaults;
  for (const AttributeSpec& spec : all_attributes(*type)) {
    if (spec.default_value.empty() || sensor.find(spec.name) != nullptr) continue;
    defaults.emplace_back(spec.name, spec.default_value);
  }
  return defaults;
}

HostInfo host_info() {
  HostInfo host;
  utsname system{};
  if (::uname(&system) == 0) {
    host.name = system.nodename;
    host.system = std::string(system.sysname) + " " + system.release + " " + system.machine;
  }
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; host.processor.empty() && std::getline(processors, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) host.processor = line.substr(colon + 2);
  }
  host.threads = std::thread::hardware_concurrency();
  return host;
}

}  // namespace simvis

// Every call of Vulkan that a small scene makes fails once with each result that the registry allows for it: the
// simulation throws MachineError that names call and result, or measures the same as without the fault; no object is
// left behind, and the next simulation in the process works. The suite tries a sample:
//
//   SIMVIS_TEST_FAULTS=1000000 build/release/bin/simvis_tests -sf='*vulkan_faults_test*'     tries all
//   SIMVIS_TEST_SEED=7                                                                       another sample
#include <doctest/doctest.h>

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/error.h>
#include <simvis/simulation.h>
#include "engine/vulkan/vulkan_check.h"
#include "tests/support/faulty_devices.h"
#include "tests/support/long_count.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// A textured wall behind a pane of glass, lit by a lamp with shadows, and what the scene gets while it runs.
std::string walled_gltf(bool glass) {
  test::GltfBuilder builder;
  const std::vector<float> corners = {0, -2, -2, 0, 2, -2, 0, 2, 2, 0, -2, 2};
  test::json& primitive =
      builder.primitive({{"POSITION", builder.accessor<float>("VEC3", corners)},
                         {"TEXCOORD_0", builder.accessor<float>("VEC2", {0, 0, 1, 0, 1, 1, 0, 1})}});
  primitive["indices"] = builder.accessor<std::uint16_t>("SCALAR", {0, 1, 2, 0, 2, 3});
  primitive["material"] = 0;
  std::vector<test::ByteString> rows;
  for (std::uint8_t y = 0; y < 8; ++y) rows.emplace_back(32, static_cast<std::uint8_t>(y * 30 + 20));
  const test::ByteString picture = test::png(8, 8, 8, 6, rows);
  builder.append("images", {{"bufferView", builder.view(picture.data(), picture.size())}, {"mimeType", "image/png"}});
  builder.append("textures", {{"source", 0}});
  builder.append("materials", {{"doubleSided", true},
                               {"alphaMode", glass ? "BLEND" : "OPAQUE"},
                               {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return builder.text();
}

constexpr const char* kFaultScene = R"(<scene>
<part file="wall.gltf" name="WALL" insert_at="ROOT"/>
<element type="light" name="LAMP" insert_at="ROOT" kind="directional" shadows="yes" shadow_resolution="32"/>
<sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="-4 0 0 0 0 0" width="24" height="16" msaa="4" outputs="color depth"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" pose_offset="-4 0 0 0 0 0" method="hybrid" samples="31"/>
</scene>)";
constexpr const char* kExecuted = R"(
<part file="glass.gltf" name="PANE" insert_at="ROOT" pose_offset="-1 0 0 0 0 20"/>
<sensor type="camera" name="LENS" insert_at="ROOT" pose_offset="-4 0 0 0 0 0" width="24" height="16" outputs="color" distortion="brown_conrady"
        k1="-0.1"/>)";

class FaultCampaign {
 public:
  FaultCampaign() {
    write_text(folder_ / "wall.gltf", walled_gltf(false));
    write_text(folder_ / "glass.gltf", walled_gltf(true));
    write_text(file(), kFaultScene);
  }
  std::filesystem::path file() const { return folder_ / "scene.xml"; }
  std::filesystem::path cache() const { return folder_ / "cache"; }

  /// All that the scene measures: it is loaded, steps, is executed upon, and steps again.
  std::vector<float> measured() const {
    SimulationDesc desc;
    desc.device.cache_dir = cache().string();
    desc.device.instrumented = true;
    Simulation simulation = Simulation::load(file(), desc);
    std::vector<float> all;
    const auto add = [&](std::span<const float> values) { all.insert(all.end(), values.begin(), values.end()); };
    simulation.step();
    add(simulation.color("CAM").pixels);
    simulation.execute(kExecuted, folder_.path());
    simulation.step_async();
    simulation.finish();
    for (const char* camera : {"CAM", "LENS"}) add(simulation.color(camera).pixels);
    add(simulation.depth("CAM").pixels);
    add(simulation.scan("SCAN").range_m);
    return all;
  }

 private:
  TemporaryFolder folder_;
};

struct TriedFault {
  std::string function, result;
  std::uint64_t call;
  bool lasts;

  std::string text() const { return function + ":" + std::to_string(call) + (lasts ? "+:" : ":") + result; }
};

/// Mesa's layer VK_LAYER_MESA_device_select takes memory for as many devices or extensions as a failed call has not
/// written. The address sanitizer ends the process if the number is large.
bool ends_sanitized_process(const FaultyCommand& command) {
  return sanitized() &&
         (command.name == "vkEnumeratePhysicalDevices" || command.name == "vkEnumerateDeviceExtensionProperties");
}

/// Every call that the scene makes with every result.
std::vector<TriedFault> all_faults(const FaultyDevices& devices) {
  std::vector<TriedFault> all;
  const std::vector<FaultyCommand> commands = faulty_commands();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (ends_sanitized_process(commands[i])) continue;
    std::istringstream results(commands[i].results);
    for (std::string result; std::getline(results, result, ',');) {
      result.erase(0, result.find_first_not_of(' '));
      for (std::uint64_t call = 1; call <= devices.calls(i); ++call) {
        for (const bool lasts : {false, true}) all.push_back({commands[i].name, result, call, lasts});
      }
    }
  }
  return all;
}

/// `count` of them, each at most once, or all.
std::vector<TriedFault> sample_of(std::vector<TriedFault> all, std::size_t count) {
  test::Random random(static_cast<std::uint64_t>(count_of("SIMVIS_TEST_SEED", 1)));
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) {
    std::swap(all[i], all[i + random.below(all.size() - i)]);
  }
  if (count < all.size()) all.resize(count);
  return all;
}

VkResult result_of(const std::string& name) {
#define SIMVIS_RESULT(result) \
  if (name == #result) return result;
#include "tests/fault_layer/results.inc"
#undef SIMVIS_RESULT
  return VK_SUCCESS;
}

/// Whether the message names what failed.
bool names_fault(const std::string& message, const TriedFault& fault) {
  const std::string expected = result_message(result_of(fault.result), fault.function.c_str());
  if (message.find(expected) != std::string::npos) return true;
  // A scene may want what the device then does not have.
  if (fault.result == "VK_ERROR_FORMAT_NOT_SUPPORTED") {
    return message.starts_with("InputError: ") &&
           message.find("this device cannot take 4 samples") != std::string::npos;
  }
  // The loader asks for extensions in vkCreateDevice, which then fails.
  if (fault.function == "vkEnumerateDeviceExtensionProperties") return message.starts_with("vkCreateDevice: VK_");
  // Drivers return these two where they have no device.
  if (fault.result == "VK_ERROR_INITIALIZATION_FAILED" && fault.function == "vkEnumeratePhysicalDevices") {
    return message.starts_with("vkEnumeratePhysicalDevices: no device");
  }
  return fault.result == "VK_ERROR_INCOMPATIBLE_DRIVER" && message.starts_with("vkCreateInstance: " + fault.result);
}

/// The message of the MachineError, or "InputError: " and its message; empty: none was thrown. Any other exception
/// fails the test.
std::string fault_message(const FaultCampaign& campaign, std::vector<float>& measured) {
  try {
    measured = campaign.measured();
    return {};
  } catch (const MachineError& error) {
    return error.what();
  } catch (const InputError& error) {
    return std::string("InputError: ") + error.what();
  } catch (const std::exception& error) {
    FAIL_CHECK(error.what());
    return error.what();
  }
}

bool all_devices_end(const FaultyDevices& devices) {
  // Devices that were given up with work that had not ended are closed when a later one is opened.
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (devices.open() > 0 && std::chrono::steady_clock::now() < patience) {
    const Device opened{DeviceDesc{}};
  }
  return devices.open() == 0;
}

TEST_CASE("a call of Vulkan that fails ends in an exception that names it, and leaves nothing behind") {
  const FaultCampaign campaign;
  const FaultyDevices devices;
  campaign.measured();  // fills the cache
  devices.forget();
  const std::vector<float> expected = campaign.measured();
  REQUIRE(devices.left() == 0);
  const std::vector<TriedFault> all = all_faults(devices);
  REQUIRE(all.size() > 1000);

  std::size_t thrown = 0, unnoticed = 0, not_reached = 0;
  for (const TriedFault& fault :
       sample_of(all, static_cast<std::size_t>(count_of("SIMVIS_TEST_FAULTS", sanitized() ? 10 : 25)))) {
    CAPTURE(fault.text());
    devices.forget();
    const bool waits_without_end = fault.lasts && fault.result == "VK_TIMEOUT";
    devices.fault(fault.text(), waits_without_end ? "0.05" : "600");
    std::vector<float> measured;
    const std::string message = fault_message(campaign, measured);
    devices.none();
    CHECK(all_devices_end(devices));
    CHECK(devices.left() == 0);
    CHECK(devices.unknown() == 0);
    if (devices.failed() == 0) {
      ++not_reached;
    } else if (message.empty()) {
      ++unnoticed;
      CHECK(measured == expected);
    } else {
      ++thrown;
      CAPTURE(message);
      CHECK(names_fault(message, fault));
    }
    CHECK(campaign.measured() == expected);
  }
  std::printf(
      "calls of Vulkan that failed: %zu ended in an exception, %zu changed nothing, %zu were not reached; of %zu\n",
      thrown, unnoticed, not_reached, all.size());
  CHECK(thrown > 0);
}

// The driver says nothing about the format then: the scene's msaa is not at fault.
TEST_CASE("a driver that is out of memory while it is asked for its formats is a fault of the machine") {
  const FaultCampaign campaign;
  const FaultyDevices devices;
  std::vector<float> measured;
  devices.fault("vkGetPhysicalDeviceImageFormatProperties:2+:VK_ERROR_OUT_OF_HOST_MEMORY", "600");
  const std::string message = fault_message(campaign, measured);
  devices.none();
  CHECK(message.starts_with("vkGetPhysicalDeviceImageFormatProperties: VK_ERROR_OUT_OF_HOST_MEMORY"));
  CHECK(all_devices_end(devices));
}

/// What the scene measures on a device with these settings, or the message of the exception.
std::string message_with(const FaultCampaign& campaign, const FaultyDevices& devices, const Strings& settings,
                         std::vector<float>& measured) {
  devices.forget();
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    devices.set(setting.substr(0, equals).c_str(), setting.substr(equals + 1));
  }
  const std::string message = fault_message(campaign, measured);
  devices.none();
  CHECK(all_devices_end(devices));
  CHECK(devices.left() == 0);
  CHECK(devices.unknown() == 0);
  return message;
}

TEST_CASE("other memory types and slow calls change no byte") {
  const FaultCampaign campaign;
  const FaultyDevices devices;
  const std::vector<float> expected = campaign.measured();
  for (const Strings& settings :
       {// as a discrete GPU, in two orders; with a small part of the device's memory that the host can map
        Strings{"SIMVIS_FAULT_HEAPS=512M,512M", "SIMVIS_FAULT_MEMORY_TYPES=L@0,VC@1,VCK@1"},
        {"SIMVIS_FAULT_HEAPS=512M,512M", "SIMVIS_FAULT_MEMORY_TYPES=VCK@1,VC@1,L@0"},
        {"SIMVIS_FAULT_HEAPS=512M,512M,16M", "SIMVIS_FAULT_MEMORY_TYPES=L@0,LVC@2,VCK@1"},
        {"SIMVIS_FAULT=vkQueueSubmit:1+:20ms,vkCreateImage:2:20ms"}}) {
    CAPTURE(settings.front());
    CAPTURE(settings.back());
    std::vector<float> measured;
    CHECK(message_with(campaign, devices, settings, measured) == "");
    CHECK(measured == expected);
  }
}

TEST_CASE("small heaps and limits end in exceptions that name them") {
  const FaultCampaign campaign;
  const FaultyDevices devices;
  std::vector<float> measured;
  const auto message = [&](const Strings& settings) { return message_with(campaign, devices, settings, measured); };
  const std::string short_heap = message({"SIMVIS_FAULT_HEAPS=1M"});
  CHECK(short_heap.starts_with("vkAllocateMemory: VK_ERROR_OUT_OF_DEVICE_MEMORY"));
  CHECK(short_heap.find("of heap 0 with 1048576 bytes") != std::string::npos);
  const std::string few = message({"SIMVIS_FAULT_LIMITS=maxMemoryAllocationCount=2"});
  CHECK(few.starts_with("vkAllocateMemory: VK_ERROR_TOO_MANY_OBJECTS"));
  CHECK(few.find("of the 2 that the device allows") != std::string::npos);
  // The scene's camera is 24 pixels wide.
  const std::string small = message({"SIMVIS_FAULT_LIMITS=maxImageDimension2D=16,maxFramebufferWidth=16"});
  CHECK(small.starts_with("InputError: "));
  CHECK(small.find("16") != std::string::npos);
  // No type can be mapped.
  const std::string unmapped = message({"SIMVIS_FAULT_HEAPS=512M", "SIMVIS_FAULT_MEMORY_TYPES=L@0"});
  CHECK(unmapped.find("no memory type of ") != std::string::npos);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();

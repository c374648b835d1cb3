#include <simvis/device.h>

#include <doctest/doctest.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <thread>

#include <simvis/error.h>
#include "engine/base/cache_file.h"
#include "engine/render/pipelines.h"
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/found_device.h"
#include "engine/vulkan/sharing/open_devices.h"
#include "engine/vulkan/vulkan_check.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/validation.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
namespace fs = std::filesystem;

namespace {

DeviceInfo info(const std::string& name, const std::string& type, const std::string& unusable = "") {
  return {.name = name, .type = type, .driver = "", .api_version = "", .unusable = unusable};
}

// A new, empty folder in the build tree.
fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(tested_build()) / "device_test" / name;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// Sets an environment variable during its lifetime.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = getenv(name)) old_ = old;
    setenv(name, value.c_str(), 1);
  }
  ~ScopedVariable() { old_.empty() ? unsetenv(name_) : setenv(name_, old_.c_str(), 1); }

 private:
  const char* name_;
  std::string old_;
};

// Creates a device and draws with it, so that there are pipelines to keep.
void draw_once(const fs::path& cache) {
  Device device({.select = "", .validation = false, .cache_dir = cache.string()});
  Renderer renderer(device);
  test::RendererScene scene;
  scene.add(test::rectangle(-1, -1, 1, 1), {}, test::at(0, 0, 2));
  const auto results = renderer.render(scene.list, test::plan_of(8, 8, 4, false, true));
  CHECK(results[0].depth[4 * 8 + 4] > 0);
}

// The file that describes lavapipe to the loader; empty: there is none.
fs::path cpu_driver() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/usr/share/vulkan/icd.d", error)) {
    if (entry.path().filename().string().starts_with("lvp_icd.")) return entry.path();
  }
  return {};
}

fs::path only_file(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  REQUIRE(files.size() == 1);
  return files[0];
}

}  // namespace

TEST_CASE("the best usable device is taken") {
  const std::vector<DeviceInfo> devices = {info("llvmpipe", "CPU"),
                                           info("Small", "integrated GPU"),
                                           info("Broken", "discrete GPU", "it has no graphics queue"),
                                           info("Big One", "discrete GPU"),
                                           info("Big Two", "discrete GPU"),
                                           info("Guest", "virtual GPU")};
  CHECK(choose_device(devices, "") == 3);
  CHECK(choose_device({devices[0], devices[5]}, "") == 1);
  CHECK(choose_device({devices[5], devices[1]}, "") == 1);
}

TEST_CASE("a device is selected by index or by part of its name") {
  const std::vector<DeviceInfo> devices = {info("llvmpipe (LLVM 15)", "CPU"), info("GeForce 4090", "discrete GPU"),
                                           info("geforce 1", "integrated GPU")};
  CHECK(choose_device(devices, "0") == 0);
  CHECK(choose_device(devices, "LLVMpipe") == 0);
  CHECK(choose_device(devices, "4090") == 1);
  CHECK(choose_device(devices, "geforce") == 1);
  CHECK_THROWS_WITH_AS(choose_device(devices, "radeon"), doctest::Contains("\"radeon\""), InputError);
  CHECK_THROWS_WITH_AS(choose_device(devices, "7"), doctest::Contains("1 (GeForce 4090)"), InputError);
}

TEST_CASE("if no device fits, the error has the reason for each") {
  const std::vector<DeviceInfo> devices = {info("Old", "discrete GPU", "it offers Vulkan 1.0.3"),
                                           info("Odd", "other", "it has no graphics queue")};
  CHECK_THROWS_WITH_AS(choose_device(devices, ""), doctest::Contains("Old: it offers Vulkan 1.0.3"), MachineError);
  CHECK_THROWS_WITH_AS(choose_device(devices, ""), doctest::Contains("Odd: it has no graphics queue"), MachineError);
  CHECK_THROWS_WITH_AS(choose_device(devices, "1"), doctest::Contains("Odd"), MachineError);
}

TEST_CASE("the devices of this machine are listed") {
  const std::vector<DeviceInfo> devices = list_devices();
  REQUIRE(!devices.empty());
  for (const DeviceInfo& device : devices) {
    CHECK(!device.name.empty());
    CHECK(!device.type.empty());
    CHECK(!device.driver.empty());
    CHECK(device.api_version.find("1.") == 0);
  }
  const Device chosen({.select = "0", .validation = false, .cache_dir = fresh_folder("list").string()});
  CHECK(chosen.info().name == devices[0].name);
  CHECK(chosen.is_cpu() == (devices[0].type == "CPU"));
  CHECK_THROWS_AS(Device({.select = "no such device", .validation = false, .cache_dir = ""}), InputError);
}

TEST_CASE("without a driver the message says what to install") {
  const ScopedVariable old_name("VK_ICD_FILENAMES", "/nonexistent/driver.json");
  const ScopedVariable new_name("VK_DRIVER_FILES", "/nonexistent/driver.json");
  CHECK_THROWS_WITH_AS(list_devices(), doctest::Contains("mesa-vulkan-drivers"), MachineError);
  CHECK_THROWS_WITH_AS(Device(), doctest::Contains("mesa-vulkan-drivers"), MachineError);
}

TEST_CASE("a driver that SimVis brings along is found after those of the system, and alone where it is asked for") {
  const fs::path bundled = cpu_driver();
  if (bundled.empty()) return test::skip("no driver for CPUs is installed as lvp_icd.*.json");
  const std::vector<DeviceInfo> system = list_devices();
  const std::vector<DeviceInfo> devices = infos(find_devices(false, bundled));
  REQUIRE(devices.size() == system.size() + 1);
  CHECK(devices[0].name == system[0].name);
  CHECK(devices.back().type == "CPU");
  CHECK(devices.back().driver.ends_with(", bundled"));
  CHECK(find_device(false, "bundled", bundled).physical.info.driver == devices.back().driver);
  CHECK(!find_device(false, "", bundled).physical.info.driver.ends_with(", bundled"));
  {
    const ScopedVariable none("VK_DRIVER_FILES", "/nonexistent/driver.json");
    CHECK(infos(find_devices(false, bundled)).size() == 1);
    CHECK(find_device(false, "", bundled).physical.info.driver == devices.back().driver);
    CHECK(std::string(getenv("VK_DRIVER_FILES")) == "/nonexistent/driver.json");
  }
  CHECK(getenv("VK_DRIVER_FILES") == nullptr);
  CHECK_THROWS_WITH_AS(find_device(false, "bundled", {}), doctest::Contains("without a driver of its own"), InputError);
}

TEST_CASE("a Vulkan error carries the call and the result") {
  CHECK_NOTHROW(vk_check(VK_SUCCESS, "vkSomething"));
  CHECK_THROWS_WITH_AS(vk_check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit"),
                       doctest::Contains("vkQueueSubmit: VK_ERROR_DEVICE_LOST"), MachineError);
}

TEST_CASE("messages of the validation layer are counted") {
  Device device({.select = "", .validation = true, .cache_dir = fresh_folder("validation").string()});
  CHECK(device.validation_messages() == 0);
  test::expect_validation_message();
  const Buffer bad(device.impl(), {.name = "bad", .size = 4, .usage = 0, .memory = MemoryKind::staging});
  CHECK(device.validation_messages() > 0);
}

TEST_CASE("devices of the same choice share one logical device, which is closed with the last of them") {
  const fs::path folder = fresh_folder("shared");
  const DeviceDesc desc{.select = "", .validation = false, .cache_dir = folder.string()};
  DeviceDesc counted = desc;
  counted.instrumented = true;
  std::weak_ptr<SharedDevice> shared;
  {
    Device first(desc);
    shared = first.impl().shared;
    {
      Device second(desc), other(counted);
      CHECK(second.impl().shared == first.impl().shared);
      CHECK(other.impl().shared != first.impl().shared);
      const auto pipelines = shared_pipelines(first.impl());
      CHECK(shared_pipelines(second.impl()) == pipelines);
      CHECK(shared_pipelines(other.impl()) != pipelines);
      CHECK(pipelines->get({}) == pipelines->get({}));
      CHECK(pipelines->made() == 1);
      const Buffer buffer(second.impl(), {.name = "of the second",
                                          .size = 4,
                                          .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                          .memory = MemoryKind::staging});
      CHECK(second.memory_bytes() > 0);
      CHECK(first.memory_bytes() == 0);
    }
    CHECK(!shared.expired());
  }
  CHECK(shared.expired());
}

TEST_CASE("a device that is opened in the background is held until its opening ends, and its user gets the error") {
  if (!bundled_driver().empty()) return test::skip("with a bundled driver, no device is opened in the background");
  const DeviceChoice choice{.select = "", .cache_folder = fresh_folder("opened")};
  std::optional<DeviceOpening> opening(choice);
  const std::shared_ptr<SharedDevice> device = shared_device(choice);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (device.use_count() < 2 && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
  CHECK(device.use_count() == 2);
  opening.reset();
  CHECK(device.use_count() == 1);
  const DeviceOpening none({.select = "no such device", .cache_folder = ""});
}

TEST_CASE("objects are destroyed when the submission that may use them has finished") {
  Device device({.select = "", .validation = false, .cache_dir = fresh_folder("retire").string()});
  DeviceImpl& impl = device.impl();
  const auto make = [&] {
    return Buffer(
        impl,
        {.name = "short-lived", .size = 4, .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT, .memory = MemoryKind::staging});
  };
  make();
  CHECK(impl.live_objects() == 0);
  impl.recording = true;
  make();
  impl.destroy_retired();
  CHECK(impl.live_objects() == 2);  // the buffer and its memory
  impl.recording = false;
  impl.finished = ++impl.submitted;
  impl.destroy_retired();
  CHECK(impl.live_objects() == 0);
}

TEST_CASE("the pipeline cache is kept, and a damaged or foreign one is replaced") {
  const fs::path folder = fresh_folder("cache");
  draw_once(folder);
  const fs::path file = only_file(folder);
  const std::string good = read(file);
  REQUIRE(good.size() > 56);

  // Unchanged data is not written again.
  const auto long_ago = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, long_ago);
  draw_once(folder);
  CHECK(fs::last_write_time(file) == long_ago);

  const auto remade = [&](const std::string& bytes) {
    write(file, bytes);
    draw_once(folder);
    return only_file(folder) == file && read(file) == good;
  };
  CHECK(remade(""));
  for (const std::size_t size : {std::size_t{1}, std::size_t{55}, std::size_t{56}, good.size() - 1}) {
    CAPTURE(size);
    CHECK(remade(good.substr(0, size)));
  }
  for (std::size_t byte = 0; byte < good.size(); byte += 1 + good.size() / 12) {
    CAPTURE(byte);
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 0x10);
    CHECK(remade(bad));
  }
  CHECK(remade(good + "x"));
}

TEST_CASE("a cache folder that cannot be written is no error") {
  const fs::path folder = fresh_folder("unwritable");
  write(folder / "file", "");
  draw_once(folder / "file" / "below");
  CHECK(fs::is_regular_file(folder / "file"));
}

TEST_CASE("the cache folder follows the environment") {
  CHECK(cache_folder("/a/b") == "/a/b");
  {
    const ScopedVariable xdg("XDG_CACHE_HOME", "/xdg");
    CHECK(cache_folder("") == "/xdg/simvis");
  }
  const ScopedVariable xdg("XDG_CACHE_HOME", "");
  const ScopedVariable home("HOME", "/home/user");
  CHECK(cache_folder("") == "/home/user/.cache/simvis");
}

TEST_SUITE_END();

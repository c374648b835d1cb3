#include "engine/vulkan/instance.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>

#include <simvis/error.h>
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kInstallDriver =
    "no Vulkan driver was found. Install one: on Debian the package mesa-vulkan-drivers (it renders on the CPU where "
    "there is no GPU), or the driver of the GPU's maker";

// Returns why this process cannot take `memory_bytes` of memory or open another file, such as "less than 256 MiB of
// memory are left: Cannot allocate memory"; empty if it can do both.
std::string lacking_resource(std::size_t memory_bytes) {
  void* const memory = ::mmap(nullptr, memory_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    return "less than " + std::to_string(memory_bytes >> 20) + " MiB of memory are left: " + std::strerror(errno);
  }
  ::munmap(memory, memory_bytes);
  const int file = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::string("no file can be opened: ") + std::strerror(errno);
  ::close(file);
  return {};
}

// The libraries of lavapipe, mainly LLVM, take 170 MiB of address space, and their first allocations some more.
constexpr std::size_t kDriverBytes = std::size_t{256} << 20;

// A driver that has too little memory while it is loaded can leave the lock of the dynamic linker taken, for which the
// end of the process waits.
void require_room_for_driver() {
  const std::string lack = lacking_resource(kDriverBytes);
  if (!lack.empty()) throw MachineError("no Vulkan driver can be loaded: " + lack);
}

// The loader leaves out a driver that it cannot load, also for lack of memory or of open files, and then finds none.
[[noreturn]] void throw_no_driver(const std::string& call) {
  const std::string lack = lacking_resource(kDriverBytes);
  throw MachineError(call + ": " + (lack.empty() ? kInstallDriver : "no Vulkan driver could be loaded, and " + lack));
}

VKAPI_ATTR VkBool32 VKAPI_CALL print_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                             VkDebugUtilsMessageTypeFlagsEXT,
                                             const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  ++*static_cast<std::atomic<std::uint64_t>*>(user);
  const bool error = severity == VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  std::fprintf(stderr, "Vulkan validation %s: %s\n", error ? "error" : "warning", data->pMessage);
  return VK_FALSE;
}

bool layer_present() {
  std::uint32_t count = 0;
  vk_check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  vk_check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(),
                     [](const VkLayerProperties& layer) { return !std::strcmp(layer.layerName, kValidationLayer); });
}

template <typename Function>
Function instance_function(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

// While it lives, the loader loads this driver and no other. The loader of Debian 12 takes one from the environment
// alone: it does not offer VK_LUNARG_direct_driver_loading.
class OnlyDriver {
 public:
  explicit OnlyDriver(const std::filesystem::path& driver) {
    if (const char* const before = ::getenv(kVariable)) before_ = before;
    ::setenv(kVariable, driver.c_str(), 1);
  }
  ~OnlyDriver() { before_ ? ::setenv(kVariable, before_->c_str(), 1) : ::unsetenv(kVariable); }
  OnlyDriver(const OnlyDriver&) = delete;
  OnlyDriver& operator=(const OnlyDriver&) = delete;

 private:
  static constexpr const char* kVariable = "VK_DRIVER_FILES";
  std::optional<std::string> before_;
};

}  // namespace

Instance::Instance(bool validation, const std::filesystem::path& driver) {
  if (validation && !layer_present()) {
    throw MachineError(std::string("the Vulkan validation layer was asked for, but ") + kValidationLayer +
                       " is not installed (on Debian: the package vulkan-validationlayers)");
  }
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pNext = nullptr,
                                      .pApplicationName = "SimVis",
                                      .applicationVersion = 0,
                                      .pEngineName = "SimVis",
                                      .engineVersion = 0,
                                      .apiVersion = VK_API_VERSION_1_2};
  const VkDebugUtilsMessengerCreateInfoEXT messenger{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .pNext = nullptr,
      .flags = 0,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = print_message,
      .pUserData = &messages_};
  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = &messenger,
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = &synchronization,
                                         .disabledValidationFeatureCount = 0,
                                         .pDisabledValidationFeatures = nullptr};
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validation ? &features : nullptr,
                                  .flags = 0,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validation ? 1u : 0u,
                                  .ppEnabledLayerNames = &kValidationLayer,
                                  .enabledExtensionCount = validation ? 2u : 0u,
                                  .ppEnabledExtensionNames = extensions};
  const std::unique_lock lock(loader_lists());
  std::optional<OnlyDriver> only;
  if (!driver.empty()) only.emplace(driver);
  require_room_for_driver();
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw_no_driver("vkCreateInstance: VK_ERROR_INCOMPATIBLE_DRIVER");
  vk_check(result, "vkCreateInstance");
  if (!validation) return;
  const auto create =
      instance_function<PFN_vkCreateDebugUtilsMessengerEXT>(instance_, "vkCreateDebugUtilsMessengerEXT");
  const VkResult created = create(instance_, &messenger, nullptr, &messenger_);
  if (created != VK_SUCCESS) vkDestroyInstance(instance_, nullptr);
  vk_check(created, "vkCreateDebugUtilsMessengerEXT");
}

Instance::~Instance() {
  const std::unique_lock lock(loader_lists());
  if (messenger_ != VK_NULL_HANDLE) {
    instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
        instance_, messenger_, nullptr);
  }
  vkDestroyInstance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
  std::uint32_t count = 0;
  const VkResult result = vkEnumeratePhysicalDevices(instance_, &count, nullptr);
  // Installed drivers that find no device of their own return either of these results.
  if (result == VK_ERROR_INITIALIZATION_FAILED || (result == VK_SUCCESS && count == 0)) {
    throw_no_driver("vkEnumeratePhysicalDevices: no device");
  }
  vk_check(result, "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  vk_check(vkEnumeratePhysicalDevices(instance_, &count, devices.data()), "vkEnumeratePhysicalDevices");
  return devices;
}

std::shared_mutex& loader_lists() {
  static std::shared_mutex mutex;
  return mutex;
}

}  // namespace simvis

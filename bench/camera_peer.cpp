// What SimVis adds to the device's work: a camera of 640 x 480, colour and depth, in scenes/marvin with the robot
// driving, beside a bare Vulkan loop that does nothing but the same.
//
//   camera_peer [SCENE.xml [CAMERA [FRAMES]]]
//
// The bare loop knows no scene, plan or list: it submits the command buffer that SimVis has recorded for the frame
// before, as it stands (the same triangles after the same culling, draws, shaders, targets, copies), waits for it, and
// copies as many bytes as are read back into memory of its own. So it is the least that any program can take that lets
// this device do this work; a loop that culls nothing takes longer. The commands are had by standing between SimVis and
// the Vulkan loader: this program has functions of the loader's names, which pass everything on.
//
// Prints CSV: for each the median of frames in turns, and the ratio to the bare loop.
#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "bench/timing.h"
#include "simvis/simulation.h"
#include "simvis/trajectory.h"

namespace {

/// The last submission of the process, and the device that it was for.
struct Submitted {
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::vector<VkCommandBuffer> commands;
} submitted;

template <typename Function>
Function* of_loader(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) throw std::runtime_error(std::string("the Vulkan loader has no ") + name);
  return reinterpret_cast<Function*>(found);
}

}  // namespace

extern "C" {

/// What was recorded may be submitted again.
VKAPI_ATTR VkResult VKAPI_CALL vkBeginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info) {
  static const auto pass_on = of_loader<decltype(vkBeginCommandBuffer)>("vkBeginCommandBuffer");
  VkCommandBufferBeginInfo again = *info;
  again.flags &= ~static_cast<VkCommandBufferUsageFlags>(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT);
  return pass_on(commands, &again);
}

VKAPI_ATTR VkResult VKAPI_CALL vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence) {
  static const auto pass_on = of_loader<decltype(vkQueueSubmit)>("vkQueueSubmit");
  submitted.queue = queue;
  submitted.commands.clear();
  for (uint32_t i = 0; i < count; ++i) {
    const VkCommandBuffer* const first = infos[i].pCommandBuffers;
    submitted.commands.insert(submitted.commands.end(), first, first + infos[i].commandBufferCount);
  }
  return pass_on(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL vkCreateFence(VkDevice device, const VkFenceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkFence* fence) {
  static const auto pass_on = of_loader<decltype(vkCreateFence)>("vkCreateFence");
  submitted.device = device;
  return pass_on(device, info, allocator, fence);
}

}  // extern "C"

namespace {

using namespace simvis;
using bench::Took;

/// Submits again what was last submitted.
class BareLoop {
 public:
  BareLoop() {
    const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
    check(vkCreateFence(submitted.device, &info, nullptr, &fence_));
  }
  ~BareLoop() { vkDestroyFence(submitted.device, fence_, nullptr); }
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;

  void frame(std::size_t bytes_read_back) {
    if (bytes_read_back > from_.size()) {
      from_.resize(bytes_read_back);
      to_.resize(bytes_read_back);
    }
    const std::vector<VkCommandBuffer> commands = submitted.commands;
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = static_cast<uint32_t>(commands.size());
    info.pCommandBuffers = commands.data();
    check(vkQueueSubmit(submitted.queue, 1, &info, fence_));
    check(vkWaitForFences(submitted.device, 1, &fence_, VK_TRUE, UINT64_MAX));
    check(vkResetFences(submitted.device, 1, &fence_));
    std::memcpy(to_.data(), from_.data(), bytes_read_back);
  }

 private:
  static void check(VkResult result) {
    if (result != VK_SUCCESS) throw std::runtime_error("Vulkan result " + std::to_string(result));
  }

  VkFence fence_ = VK_NULL_HANDLE;
  std::vector<char> from_, to_;
};

void print(const char* loop, const Took& took, const Took& bare, const FrameCounters& counters) {
  std::printf("%s,%.4f,%.4f,%.3f,%llu,%llu,%llu\n", loop, took.wall_ms, took.caller_ms, took.wall_ms / bare.wall_ms,
              static_cast<unsigned long long>(counters.draws), static_cast<unsigned long long>(counters.triangles),
              static_cast<unsigned long long>(counters.bytes_read_back));
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const char* const camera = argc > 2 ? argv[2] : "ROBOT_CAM";
  const int frames = argc > 3 ? std::max(1, std::atoi(argv[3])) : 200;
  constexpr int kWarmUp = 10;

  Simulation simulation = Simulation::load(scene);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == camera);
  const Trajectory drive(scene.parent_path() / "drive.csv", simulation.parameters());
  simulation.step();
  BareLoop bare;
  std::vector<Took> simvis_took, bare_took;
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    drive.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
    const Took whole = bench::time_work([&] { simulation.step(); });
    const Took alone = bench::time_work([&] { bare.frame(simulation.counters().bytes_read_back); });
    if (frame < kWarmUp) continue;
    simvis_took.push_back(whole);
    bare_took.push_back(alone);
  }
  std::printf("loop,median_ms,caller_cpu_ms,ratio_to_bare,draws,triangles,bytes_read_back\n");
  print("simvis", bench::median(simvis_took), bench::median(bare_took), simulation.counters());
  print("bare", bench::median(bare_took), bench::median(bare_took), simulation.counters());
  return 0;
}
